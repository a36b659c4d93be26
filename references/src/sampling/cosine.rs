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
