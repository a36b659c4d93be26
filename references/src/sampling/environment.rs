//! Latitude–longitude environment maps: radiance, and directions in proportion to it.

use std::f32::consts::TAU;
use std::f64::consts::PI;

use glam::Vec3;
use halflight_scenes::{Environment, Rgb};

use super::luminance;

/// Directions with density in proportion to the luminance of their texel.
///
/// A row is drawn by its share of the power, a texel of the row by its luminance, then a point uniform in solid angle within the
/// texel; each step inverts a cumulative sum, which keeps low-discrepancy points well spread.
#[derive(Clone, Debug)]
pub(crate) struct EnvironmentSampler {
    map: Environment,
    /// Height `cos θ` of the rows' upper edges, from 1 to −1.
    edges: Vec<f32>,
    /// Cumulative power of rows, from 0 to 1.
    rows: Vec<f32>,
    /// Cumulative luminance within each row, from 0 to 1: `width + 1` entries a row.
    columns: Vec<f32>,
    /// `∫ luminance dω`.
    power: f64,
    /// `∫ (r + g + b)/3 dω`.
    mean_power: f64,
}

impl EnvironmentSampler {
    pub(crate) fn new(map: &Environment) -> Self {
        let (width, height) = (map.width, map.height);
        let edges: Vec<f64> = (0..=height).map(|row| (PI * row as f64 / height as f64).cos()).collect();
        let texel_angle = |row: usize| 2.0 * PI / width as f64 * (edges[row] - edges[row + 1]);
        let mut columns = Vec::with_capacity(height * (width + 1));
        let (mut row_power, mut mean_power) = (Vec::with_capacity(height), 0.0);
        for (row, texels) in map.texels.chunks_exact(width).enumerate() {
            row_power.push(texel_angle(row) * cumulative(texels.iter().map(|t| luminance(*t)), &mut columns));
            mean_power += texel_angle(row) * texels.iter().map(|t| f64::from(t.element_sum()) / 3.0).sum::<f64>();
        }
        let mut rows = Vec::with_capacity(height + 1);
        let power = cumulative(row_power.into_iter(), &mut rows);
        let edges = edges.into_iter().map(|z| z as f32).collect();
        EnvironmentSampler { map: map.clone(), edges, rows, columns, power, mean_power }
    }

    /// `∫ luminance dω`.
    pub(crate) fn power(&self) -> f64 {
        self.power
    }

    /// `∫ (r + g + b)/3 dω`.
    pub(crate) fn mean_power(&self) -> f64 {
        self.mean_power
    }

    /// Radiance and density a steradian.
    pub(crate) fn look(&self, direction: Vec3) -> (Rgb, f32) {
        let radiance = self.map.texels[self.map.texel(direction)];
        (radiance, if self.power > 0.0 { (luminance(radiance) / self.power) as f32 } else { 0.0 })
    }

    /// A direction; meaningless in a black map.
    pub(crate) fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        let width = self.map.width;
        let (row, down) = invert(&self.rows, v);
        let (column, across) = invert(&self.columns[row * (width + 1)..][..=width], u);
        let z = self.edges[row] + down * (self.edges[row + 1] - self.edges[row]);
        let azimuth = TAU * (column as f32 + across) / width as f32 + self.map.rotation;
        let (sin, cos) = azimuth.sin_cos();
        let radius = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        Vec3::new(radius * cos, radius * sin, z)
    }
}

/// Appends the cumulative sum from 0 to 1 (all 0 if there is nothing) and returns the total.
fn cumulative(values: impl ExactSizeIterator<Item = f64> + Clone, into: &mut Vec<f32>) -> f64 {
    let total: f64 = values.clone().sum();
    let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
    let mut sum = 0.0;
    into.push(0.0);
    into.extend(values.map(|value| {
        sum += value;
        (sum * scale) as f32
    }));
    if let (true, Some(last)) = (total > 0.0, into.last_mut()) {
        *last = 1.0;
    }
    total
}

/// The interval of a cumulative sum that holds `u` in `(0, 1)`, never one of no width, and where in it `u` lies.
fn invert(cumulative: &[f32], u: f32) -> (usize, f32) {
    let after = cumulative.partition_point(|edge| *edge <= u).clamp(1, cumulative.len() - 1);
    let (low, high) = (cumulative[after - 1], cumulative[after]);
    (after - 1, if high > low { ((u - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::sampling::Sobol;
    use crate::sampling::chi_squared::{Family, draws};

    fn map(width: usize, height: usize, rotation: f32, texel: impl Fn(usize, usize) -> f32) -> Environment {
        let texels = (0..width * height).map(|i| Vec3::splat(texel(i % width, i / width))).collect();
        Environment { width, height, texels: Arc::new(texels), rotation }
    }

    #[test]
    fn a_bright_texel_lies_where_the_convention_says() {
        // Row 1 of 4 is θ in 45°–90°; column 2 of 8 is azimuth 90°–135°, towards +y.
        let sampler = EnvironmentSampler::new(&map(8, 4, 0.0, |x, y| f32::from(x == 2 && y == 1)));
        let sobol = Sobol::new(1);
        for i in 0..256 {
            let d = sampler.direction(sobol.point(i));
            assert!(d.is_normalized() && d.z > -1e-6 && d.z < 0.7072 && d.y > 0.0 && d.x < 1e-6 && d.y >= -d.x - 1e-6);
        }
        let up = |degrees: f32| Vec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.3).normalize();
        assert_eq!(sampler.look(up(100.0)).0, Vec3::ONE);
        assert_eq!(sampler.look(up(80.0)).0, Vec3::ZERO);
        assert_eq!(sampler.look(-up(100.0)).0, Vec3::ZERO);
        // Turned by a quarter about +z, what was at azimuth 100° is at 190°.
        let turned =
            EnvironmentSampler::new(&map(8, 4, std::f32::consts::FRAC_PI_2, |x, y| f32::from(x == 2 && y == 1)));
        assert_eq!(turned.look(up(190.0)).0, Vec3::ONE);
        assert_eq!(turned.look(up(100.0)).0, Vec3::ZERO);
        let sampled = turned.direction([0.5, 0.5]);
        assert!(sampled.x < 0.0 && sampled.y < 0.0);
    }

    /// Parts that a texel's bins divide each of its sides into.
    const PARTS: usize = 3;

    /// The share of each part of each texel: what `look` says of it, times its solid angle.
    fn shares(sampler: &EnvironmentSampler, columns: usize, rows: usize) -> Vec<f64> {
        let edge = |row: usize| (PI * row as f64 / rows as f64).cos();
        let share = |i: usize| {
            let (row, column) = (i / columns, i % columns);
            let (theta, phi) = (
                PI * (row as f64 + 0.5) / rows as f64,
                2.0 * PI * (column as f64 + 0.5) / columns as f64 + f64::from(sampler.map.rotation),
            );
            let direction = glam::DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()).as_vec3();
            f64::from(sampler.look(direction).1) * 2.0 * PI / columns as f64 * (edge(row) - edge(row + 1))
        };
        (0..columns * rows).map(share).collect()
    }

    fn bin(direction: Vec3, rotation: f32, columns: usize, rows: usize) -> usize {
        let turns = (f64::from(direction.y).atan2(f64::from(direction.x)) - f64::from(rotation)) / (2.0 * PI);
        let column = ((turns - turns.floor()) * columns as f64) as usize % columns;
        let row = ((f64::from(direction.z).acos() / PI * rows as f64) as usize).min(rows - 1);
        row * columns + column
    }

    #[test]
    fn density_integrates_to_one_and_is_the_samples_own() {
        let rough =
            |x: usize, y: usize| ((x * 7 + y * 13) % 11 + 1) as f32 * if (x, y) == (5, 3) { 100.0 } else { 1.0 };
        let polar = |_: usize, y: usize| if y == 0 { 50.0 } else { 0.5 };
        let (mut honest, mut planted) = (Family::default(), Family::default());
        let maps = [
            ("rough", map(12, 6, 1.0, rough)),
            ("polar", map(5, 8, -2.0, polar)),
            ("one texel", map(1, 1, 0.3, rough)),
        ];
        for (name, map) in maps {
            let sampler = EnvironmentSampler::new(&map);
            let (columns, rows) = (PARTS * map.width, PARTS * map.height);
            let shares = shares(&sampler, columns, rows);
            let bin = |direction: Vec3| Some(bin(direction, map.rotation, columns, rows));
            honest.add(name, &shares, draws(10).map(|point| bin(sampler.direction(point))));
            // Uniform in the polar angle within a texel, as if rows were cylinders.
            let cylindrical = |point: [f32; 2]| {
                let (row, down) = invert(&sampler.rows, point[1]);
                let z = (std::f32::consts::PI * (row as f32 + down) / map.height as f32).cos();
                let level = sampler.direction(point).truncate().normalize();
                (level * (1.0 - z * z).sqrt()).extend(z)
            };
            planted.add(name, &shares, draws(10).map(|point| bin(cylindrical(point))));
        }
        honest.assert_holds();
        planted.assert_fails_everywhere();
    }

    #[test]
    fn black_texels_are_never_drawn() {
        let sampler = EnvironmentSampler::new(&map(12, 6, 0.0, |x, y| ((x + y) % 3) as f32));
        // Rounding may carry a direction across an edge.
        let astray = draws(11).filter(|point| sampler.look(sampler.direction(*point)).1 == 0.0).count();
        assert!(astray < 3, "{astray} times");
    }

    #[test]
    fn a_black_map_has_no_density() {
        let sampler = EnvironmentSampler::new(&map(4, 2, 0.0, |_, _| 0.0));
        assert_eq!((sampler.power(), sampler.look(Vec3::Z)), (0.0, (Vec3::ZERO, 0.0)));
    }
}
