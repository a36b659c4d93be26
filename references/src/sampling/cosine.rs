//! The cosine lobe about a normal.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec3;

/// Directions about a unit normal with density `max(0, n·ω)/π`.
pub(crate) struct CosineLobe {
    normal: Vec3,
    tangents: (Vec3, Vec3),
}

impl CosineLobe {
    pub(crate) fn new(normal: Vec3) -> Self {
        CosineLobe { normal, tangents: normal.any_orthonormal_pair() }
    }

    /// Uniform on the unit disc, lifted to the hemisphere (Malley's method).
    pub(crate) fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        let (sin, cos) = (TAU * v).sin_cos();
        let radius = u.sqrt();
        let (tangent, bitangent) = self.tangents;
        (radius * cos * tangent + radius * sin * bitangent + (1.0 - u).sqrt() * self.normal).normalize()
    }

    /// Density a steradian, for the cosine `n·ω`.
    pub(crate) fn density(cosine: f32) -> f32 {
        cosine.max(0.0) * FRAC_1_PI
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::sampling::chi_squared::{Family, draws, polar_bin, ring_shares};

    #[test]
    fn density_is_in_proportion_to_the_cosine() {
        let (mut honest, mut planted) = (Family::default(), Family::default());
        for normal in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(-0.3, 0.8, 0.2), Vec3::new(1e-4, 2e-5, -1.0)] {
            let normal = normal.normalize();
            let lobe = CosineLobe::new(normal);
            let axis = normal.as_dvec3();
            // Within an angle θ lies sin² θ of the lobe.
            let bin = |direction: DVec3| polar_bin(axis.cross(direction).length_squared(), direction, axis);
            let name = format!("{normal}");
            honest.add(&name, &ring_shares(), draws(9).map(|point| bin(lobe.direction(point).as_dvec3())));
            // 1/2π: uniform over the hemisphere.
            let uniform = |[u, v]: [f32; 2]| lobe.direction([u * (2.0 - u), v]);
            planted.add(&name, &ring_shares(), draws(9).map(|point| bin(uniform(point).as_dvec3())));
            assert!(draws(9).take(10_000).all(|point| lobe.direction(point).dot(normal) >= 0.0));
        }
        honest.assert_holds();
        planted.assert_fails_everywhere();
    }

    #[test]
    fn density_integrates_to_one() {
        let steps = 2000;
        let cosine = |i: i32| (f64::from(i) + 0.5) / f64::from(steps) * 2.0 - 1.0;
        let sum: f64 = (0..steps).map(|i| f64::from(CosineLobe::density(cosine(i) as f32))).sum();
        let integral = sum * 2.0 / f64::from(steps) * std::f64::consts::TAU;
        assert!((integral - 1.0).abs() < 1e-6, "{integral}");
    }
}
