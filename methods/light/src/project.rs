//! One light in spherical harmonics.

use std::f64::consts::PI;

use halflight_scenes::{KeyLight, Light, Rgb, Sky};
use halflight_sh::{circle_visibility, coefficients, gauss_legendre, index, rotate_zonal};

use crate::environment;

/// `∫ L(s) y_i(s) ds` of a light, `order²` coefficients a colour channel.
pub fn project(light: &Light, order: usize) -> [Vec<f64>; 3] {
    match light {
        Light::Environment(map) => environment::project(map, order),
        Light::Sky(Sky::Uniform(radiance)) => coloured(*radiance, &constant(order)),
        Light::Sky(Sky::Overcast(zenith)) => coloured(*zenith, &overcast(order)),
        Light::Key(key) => coloured(key.radiance, &circle(key, order)),
    }
}

fn coloured(radiance: Rgb, shape: &[f64]) -> [Vec<f64>; 3] {
    radiance.to_array().map(|channel| shape.iter().map(|value| f64::from(channel) * value).collect())
}

fn constant(order: usize) -> Vec<f64> {
    let mut shape = vec![0.0; coefficients(order)];
    shape[0] = (4.0 * PI).sqrt();
    shape
}

/// `(1 + 2z)/3` above the horizon: polynomial there, so few nodes integrate it exactly.
fn overcast(order: usize) -> Vec<f64> {
    let (nodes, weights) = gauss_legendre(halflight_sh::MAX_ORDER);
    let mut shape = vec![0.0; coefficients(order)];
    let mut basis = vec![0.0; coefficients(order)];
    for (node, weight) in nodes.iter().zip(&weights) {
        let z = 0.5 + 0.5 * node;
        halflight_sh::evaluate(order, [(1.0 - z * z).sqrt(), 0.0, z], &mut basis);
        for l in 0..order {
            shape[index(l, 0)] += 2.0 * PI * 0.5 * weight * (1.0 + 2.0 * z) / 3.0 * basis[index(l, 0)];
        }
    }
    shape
}

/// One inside the circle, 0 outside.
fn circle(key: &KeyLight, order: usize) -> Vec<f64> {
    let mut zonal = vec![0.0; order];
    circle_visibility(order, f64::from(key.angular_radius).cos(), &mut zonal);
    zonal.iter_mut().for_each(|band| *band = -*band);
    zonal[0] += (4.0 * PI).sqrt();
    let mut shape = vec![0.0; coefficients(order)];
    rotate_zonal(order, &zonal, key.direction.to_array().map(f64::from), &mut shape);
    shape
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;
    use halflight_scenes::Environment;
    use halflight_sh::{evaluate, rotate_z};
    use proptest::prelude::*;

    use super::*;

    const ORDER: usize = 8;

    fn map(width: usize, height: usize, rotation: f32, texel: impl Fn(usize, usize) -> f32) -> Light {
        let texels = (0..width * height).map(|i| Vec3::new(texel(i % width, i / width), 1.0, 0.0)).collect();
        Light::Environment(Environment { width, height, texels: Arc::new(texels), rotation })
    }

    /// Midpoint sums over a fine lattice, for functions with steps.
    fn brute(light: &Light, order: usize) -> Vec<f64> {
        let (rows, columns) = (1440, 2880);
        let mut sum = vec![0.0; coefficients(order)];
        let mut basis = vec![0.0; coefficients(order)];
        for row in 0..rows {
            let theta = PI * (row as f64 + 0.5) / rows as f64;
            for column in 0..columns {
                let phi = 2.0 * PI * (column as f64 + 0.5) / columns as f64;
                let s = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
                evaluate(order, s, &mut basis);
                let radiance = f64::from(light.radiance(Vec3::from_array(s.map(|x| x as f32))).x);
                let area = theta.sin() * (PI / rows as f64) * (2.0 * PI / columns as f64);
                sum.iter_mut().zip(&basis).for_each(|(sum, y)| *sum += area * radiance * y);
            }
        }
        sum
    }

    fn close(a: &[f64], b: &[f64], bound: f64) {
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            assert!((a - b).abs() <= bound, "coefficient {i}: {a} against {b}");
        }
    }

    #[test]
    fn a_uniform_sky_and_a_white_map_are_the_constant_one() {
        let sky = Light::Sky(Sky::Uniform(Vec3::ONE));
        let white = map(16, 8, 0.3, |_, _| 1.0);
        for order in 1..=ORDER {
            close(&project(&sky, order)[0], &constant(order), 1e-14);
            close(&project(&white, order)[0], &constant(order), 1e-9);
        }
    }

    #[test]
    fn every_kind_agrees_with_sums_over_its_radiance() {
        let direction = Vec3::new(0.4, -0.7, 0.5).normalize();
        let key = Light::Key(KeyLight { direction, angular_radius: 0.7, radiance: Vec3::splat(2.0) });
        let patches = map(18, 8, 0.0, |x, y| if (x * 5 + y * 3) % 7 == 0 { 3.0 } else { 0.25 });
        let overcast = Light::Sky(Sky::Overcast(Vec3::ONE));
        for (light, bound) in [(key, 4e-3), (patches, 5e-4), (overcast, 1e-4)] {
            close(&project(&light, ORDER)[0], &brute(&light, ORDER), bound);
        }
    }

    #[test]
    fn a_bright_top_row_is_a_light_from_above() {
        let [red, ..] = project(&map(8, 4, 0.0, |_, y| if y == 0 { 1.0 } else { 0.0 }), 2);
        assert!(red[index(1, 0)] > 0.1);
    }

    /// `∫ sin²θ dθ` and the like in closed form, where a step in height would hide a wrong row.
    #[test]
    fn one_texel_at_the_pole_has_the_closed_form() {
        let [red, ..] = project(&map(4, 2, 0.0, |x, y| if (x, y) == (0, 0) { 1.0 } else { 0.0 }), 2);
        let band_1 = (3.0 / (4.0 * PI)).sqrt();
        // ∫₀^{π/2} sin²θ dθ = π/4 and ∫₀^{π/2} sinθ cosθ dθ = 1/2; azimuth from 0 to π/2.
        let expected = [(0.25 / PI).sqrt() * PI / 2.0, band_1 * PI / 4.0, band_1 * 0.5 * PI / 2.0, band_1 * PI / 4.0];
        close(&red, &expected, 1e-13);
    }

    proptest! {
        #[test]
        fn turning_the_map_turns_its_coefficients(angle in -3.2f32..3.2, bright in 0usize..12) {
            let texel = |x: usize, y: usize| if x == bright && y == 2 { 5.0 } else { 0.1 };
            let turned = project(&map(12, 6, angle, texel), ORDER);
            let still = project(&map(12, 6, 0.0, texel), ORDER);
            let mut expected = vec![0.0; coefficients(ORDER)];
            rotate_z(ORDER, f64::from(angle), &still[0], &mut expected);
            close(&turned[0], &expected, 1e-9);
        }

        #[test]
        fn energy_is_kept(values in prop::collection::vec(0.0f32..10.0, 32)) {
            let [red, ..] = project(&map(8, 4, 0.1, |x, y| values[y * 8 + x]), 1);
            let edge = |row: usize| (PI * row as f64 / 4.0).cos();
            let power: f64 = (0..32)
                .map(|i| f64::from(values[i]) * (edge(i / 8) - edge(i / 8 + 1)) * 2.0 * PI / 8.0)
                .sum();
            prop_assert!((red[0] * (4.0 * PI).sqrt() - power).abs() < 1e-9 * power.max(1.0));
        }
    }
}
