//! Circular key lights.

use glam::Vec3;
use halflight_scenes::KeyLight;

use super::cone::Cone;
use super::luminance;

/// Uniform directions within a key light's circle.
#[derive(Clone, Debug)]
pub(crate) struct KeySampler {
    pub(crate) light: KeyLight,
    cone: Cone,
}

impl KeySampler {
    pub(crate) fn new(light: &KeyLight) -> Self {
        let squared_chord = (2.0 * (0.5 * f64::from(light.angular_radius)).sin()).powi(2);
        KeySampler { light: *light, cone: Cone::new(light.direction, squared_chord) }
    }

    pub(crate) fn solid_angle(&self) -> f32 {
        self.cone.solid_angle()
    }

    /// `∫ luminance dω`.
    pub(crate) fn power(&self) -> f64 {
        luminance(self.light.radiance) * f64::from(self.solid_angle())
    }

    /// `∫ (r + g + b)/3 dω`.
    pub(crate) fn mean_power(&self) -> f64 {
        f64::from(self.light.radiance.element_sum()) / 3.0 * f64::from(self.solid_angle())
    }

    pub(crate) fn direction(&self, point: [f32; 2]) -> Vec3 {
        self.cone.direction(point)
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::sampling::Sobol;
    use crate::sampling::chi_squared::{Family, draws, ring_and_sector, ring_shares};

    const SIZES: [f32; 4] = [0.004_65, 0.1, 1.0, FRAC_PI_2];

    fn sampler(angular_radius: f32) -> KeySampler {
        let direction = Vec3::new(0.6, -0.3, 0.5).normalize();
        KeySampler::new(&KeyLight { direction, angular_radius, radiance: Vec3::ONE })
    }

    #[test]
    fn directions_are_inside_and_well_spread() {
        for angular_radius in SIZES {
            let sampler = sampler(angular_radius);
            let exact = std::f64::consts::TAU * 2.0 * (0.5 * f64::from(angular_radius)).sin().powi(2);
            assert!((f64::from(sampler.solid_angle()) / exact - 1.0).abs() < 1e-6);
            let sobol = Sobol::new(3);
            let all: Vec<Vec3> = (0..1024).map(|i| sampler.direction(sobol.point(i))).collect();
            let inside = all.iter().filter(|d| sampler.light.contains(**d)).count();
            assert!(inside >= 1022, "{inside} of 1024 inside {angular_radius}");
            // Within the circle of half the height lies half the area.
            let half = 2.0 * (0.5 * angular_radius).sin().powi(2);
            let inner = all.iter().filter(|d| d.distance_squared(sampler.light.direction) < half).count();
            assert!((510..=514).contains(&inner), "{inner} of 1024 in the inner half of {angular_radius}");
        }
    }

    #[test]
    fn density_is_that_of_the_solid_angle() {
        let (mut honest, mut planted) = (Family::default(), Family::default());
        for angular_radius in SIZES {
            let sampler = sampler(angular_radius);
            let height = f64::from(sampler.solid_angle()) / std::f64::consts::TAU;
            let bin = |d: Vec3| ring_and_sector(d, sampler.light.direction.as_dvec3(), height);
            let name = format!("radius {angular_radius}");
            honest.add(&name, &ring_shares(), draws(1).map(|point| bin(sampler.direction(point))));
            planted.add(&name, &ring_shares(), draws(2).map(|[u, v]| bin(sampler.direction([u.powf(1.04), v]))));
        }
        honest.assert_holds();
        planted.assert_fails_everywhere();
    }
}
