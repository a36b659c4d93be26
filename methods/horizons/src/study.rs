//! How far horizons lie from exact ones, over fields of different kinds: what tables of deviations are made of.

mod fields;

use glam::DVec2;
use halflight_scenes::HeightField;
use rayon::prelude::*;

use crate::{Azimuth, Horizons, Plane, Points, Purpose, Pyramid, Reconstruction, Scale, Settings, Storage};

pub use fields::{fields, fractal, trench};

/// The levels an octave and level offsets of Fig. 10, from the softest to the closest.
pub const FIGURE_10: [(usize, f32); 4] = [(1, 1.0), (2, 2.0), (4, 4.0), (8, 8.0)];

/// The reconstructions of Fig. 9, from linear in both to B-splines in both.
pub const FIGURE_9: [Reconstruction; 4] = [
    Reconstruction { scale: Scale::Linear, plane: Plane::Bilinear },
    Reconstruction { scale: Scale::BSpline, plane: Plane::Bilinear },
    Reconstruction { scale: Scale::Linear, plane: Plane::BSpline },
    Reconstruction { scale: Scale::BSpline, plane: Plane::BSpline },
];

/// Exact horizons of a field at some of its vertices.
pub struct Truth<'f> {
    field: &'f HeightField,
    azimuths: Vec<Azimuth>,
    x: Vec<f32>,
    y: Vec<f32>,
    /// All points' elevations under the first azimuth, then under the next.
    elevations: Vec<f64>,
}

/// How horizons differ from exact ones, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Root of the mean square.
    pub rmse: f64,
    /// The mean: above 0 where horizons are too high.
    pub bias: f64,
    /// The largest.
    pub worst: f64,
    /// Root of the mean square second difference of the horizons themselves between neighbouring vertices along x and y
    /// ("second-difference energy"): the rougher, the more aliasing and edges there are in the shadows.
    pub roughness: f64,
}

impl<'f> Truth<'f> {
    /// Truth under azimuths in radians at every `stride`th vertex along x and y, by a function of a vertex and an azimuth.
    ///
    /// # Panics
    /// If `stride` is 0.
    pub fn new(
        field: &'f HeightField,
        angles: &[f32],
        stride: usize,
        exact: impl Fn([usize; 2], f64) -> f64 + Sync,
    ) -> Self {
        let along = |count: usize| (stride / 2).min(count - 1)..count;
        let rows = along(field.rows()).step_by(stride);
        let vertices: Vec<[usize; 2]> =
            rows.flat_map(|j| along(field.columns()).step_by(stride).map(move |i| [i, j])).collect();
        let under =
            |angle: &f32| vertices.par_iter().map(|vertex| exact(*vertex, f64::from(*angle))).collect::<Vec<_>>();
        let elevations = angles.iter().flat_map(under).collect();
        let azimuths = angles.iter().map(|angle| Azimuth { angle: *angle, purpose: Purpose::Key }).collect();
        let axis = |axis: usize| vertices.iter().map(|vertex| vertex[axis] as f32).collect();
        Truth { field, azimuths, x: axis(0), y: axis(1), elevations }
    }

    /// Gives horizons the field, and compares.
    pub fn errors(&self, horizons: &mut dyn Horizons) -> Errors {
        horizons.update(self.field, &self.azimuths);
        let mut found = vec![0.0; self.elevations.len()];
        horizons.elevations(Points { x: &self.x, y: &self.y }, 0..self.azimuths.len(), &mut found);
        let differences = || found.iter().zip(&self.elevations).map(|(found, exact)| f64::from(*found) - exact);
        let count = found.len() as f64;
        Errors {
            rmse: (differences().map(|difference| difference * difference).sum::<f64>() / count).sqrt(),
            bias: differences().sum::<f64>() / count,
            worst: differences().map(f64::abs).fold(0.0, f64::max),
            roughness: self.roughness(horizons),
        }
    }

    fn roughness(&self, horizons: &dyn Horizons) -> f64 {
        let [columns, rows] = [self.field.columns(), self.field.rows()];
        let x: Vec<f32> = (0..columns).map(|i| i as f32).collect();
        let (mut sum, mut count) = (0.0, 0.0);
        for azimuth in 0..self.azimuths.len() {
            let mut map = vec![0.0; columns * rows];
            map.par_chunks_exact_mut(columns).enumerate().for_each(|(j, row)| {
                horizons.elevations(Points { x: &x, y: &vec![j as f32; columns] }, azimuth..azimuth + 1, row);
            });
            let mut add = |before: usize, at: usize, after: usize| {
                let second = f64::from(map[before]) - 2.0 * f64::from(map[at]) + f64::from(map[after]);
                sum += second * second;
                count += 1.0;
            };
            for j in 1..rows.saturating_sub(1) {
                for i in 1..columns.saturating_sub(1) {
                    let at = j * columns + i;
                    add(at - 1, at, at + 1);
                    add(at - columns, at, at + columns);
                }
            }
        }
        if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
    }
}

/// Heights that a pyramid holds, as multiples of a square field's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Levels `N`.
    pub levels: usize,
    /// The decimated levels alone; `1/(1 − 2^(−2/k))` in the limit (§4).
    pub decimated: f64,
    /// Bytes held of each storage over the field's, padding included.
    pub held: [(Storage, f64); 3],
}

/// The size of a pyramid of `k` levels an octave over `side` vertices a side.
pub fn size(side: usize, levels_per_octave: usize) -> Size {
    let field = HeightField::new([side, side], glam::Vec2::ZERO, glam::Vec2::ONE, vec![0.0; side * side]);
    let make = |storage| {
        let mut pyramid = Pyramid::new(Settings { levels_per_octave, storage, ..Settings::default() });
        pyramid.update(&field, &[]);
        pyramid
    };
    let vertices = (side * side) as f64;
    let alone = make(Storage::Decimated);
    let samples = (0..alone.levels()).map(|level| alone.level_size(level).iter().product::<usize>()).sum::<usize>();
    let held = [Storage::Decimated, Storage::Octaves, Storage::Full];
    let held = held.map(|storage| (storage, make(storage).footprint() as f64 / (4.0 * vertices)));
    Size { levels: alone.levels(), decimated: samples as f64 / vertices, held }
}

/// A pyramid of some levels an octave, level offset and reconstruction.
pub fn pyramid(levels_per_octave: usize, offset: f32, reconstruction: Reconstruction) -> Pyramid {
    Pyramid::new(Settings { levels_per_octave, offset, reconstruction, ..Settings::default() })
}

/// The elevation in radians at which a pyramid sees walls that rise by `slope` in radians from the bottom of a trench, looking
/// straight at one.
pub fn trench_wall(slope: f64, side: usize, pyramid: &mut Pyramid) -> f64 {
    let field = trench(side, slope);
    let across = Azimuth { angle: std::f32::consts::FRAC_PI_2, purpose: Purpose::Key };
    pyramid.update(&field, &[across]);
    let middle = DVec2::splat((side / 2) as f64).as_vec2();
    let mut out = [0.0];
    pyramid.elevations(Points { x: &[middle.x], y: &[middle.y] }, 0..1, &mut out);
    f64::from(out[0])
}
