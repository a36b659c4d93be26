//! Circular key lights.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use halflight_scenes::KeyLight;

use super::luminance;

/// Uniform directions within a key light's circle.
///
/// Sizes are kept as the squared chord `4 sin²(α/2)` between the centre and the rim: `1 − cos α` of a sun has lost most of its
/// digits in `f32`.
#[derive(Clone, Debug)]
pub(crate) struct KeySampler {
    pub(crate) light: KeyLight,
    tangents: (Vec3, Vec3),
    squared_chord: f32,
}

impl KeySampler {
    pub(crate) fn new(light: &KeyLight) -> Self {
        KeySampler {
            light: *light,
            tangents: light.direction.any_orthonormal_pair(),
            squared_chord: (2.0 * (0.5 * f64::from(light.angular_radius)).sin()).powi(2) as f32,
        }
    }

    /// `2π(1 − cos α) = π·chord²`.
    pub(crate) fn solid_angle(&self) -> f32 {
        PI * self.squared_chord
    }

    /// `∫ luminance dω`.
    pub(crate) fn power(&self) -> f64 {
        luminance(self.light.radiance) * f64::from(self.solid_angle())
    }

    /// `∫ (r + g + b)/3 dω`.
    pub(crate) fn mean_power(&self) -> f64 {
        f64::from(self.light.radiance.element_sum()) / 3.0 * f64::from(self.solid_angle())
    }

    pub(crate) fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        // At height 1 − h over the circle's pole, h uniform: sin² = h(2 − h).
        let h = 0.5 * u * self.squared_chord;
        let sin_polar = (h * (2.0 - h)).max(0.0).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        let (tangent, bitangent) = self.tangents;
        ((1.0 - h) * self.light.direction + sin_polar * (cos * tangent + sin * bitangent)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sobol;

    #[test]
    fn directions_fill_the_circle_uniformly() {
        for angular_radius in [0.004_65f32, 0.1, 1.0, std::f32::consts::FRAC_PI_2] {
            let direction = Vec3::new(0.6, -0.3, 0.5).normalize();
            let sampler = KeySampler::new(&KeyLight { direction, angular_radius, radiance: Vec3::ONE });
            let exact = std::f64::consts::TAU * 2.0 * (0.5 * f64::from(angular_radius)).sin().powi(2);
            assert!((f64::from(sampler.solid_angle()) / exact - 1.0).abs() < 1e-6);
            let sobol = Sobol::new(3);
            let all: Vec<Vec3> = (0..1024).map(|i| sampler.direction(sobol.point(i))).collect();
            let inside = all.iter().filter(|d| sampler.light.contains(**d)).count();
            assert!(inside >= 1022, "{inside} of 1024 inside {angular_radius}");
            // Within the circle of half the height lies half the area.
            let half = all.iter().filter(|d| d.distance_squared(direction) < 0.5 * sampler.squared_chord).count();
            assert!((510..=514).contains(&half), "{half} of 1024 in the inner half of {angular_radius}");
        }
    }
}
