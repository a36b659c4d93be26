//! Circles of directions.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

/// Uniform directions within an angle `α` in `(0, π/2]` of an axis.
///
/// The size is kept as the squared chord `2(1 − cos α) = 4 sin²(α/2)` between the centre and the rim: `1 − cos α` of a sun has
/// lost most of its digits in `f32`.
#[derive(Clone, Debug)]
pub(crate) struct Cone {
    axis: Vec3,
    tangents: (Vec3, Vec3),
    squared_chord: f32,
}

impl Cone {
    /// About a unit axis.
    pub(crate) fn new(axis: Vec3, squared_chord: f64) -> Self {
        Cone { axis, tangents: axis.any_orthonormal_pair(), squared_chord: squared_chord as f32 }
    }

    /// `2π(1 − cos α) = π·chord²`.
    pub(crate) fn solid_angle(&self) -> f32 {
        PI * self.squared_chord
    }

    /// The direction of a point of the unit square.
    pub(crate) fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        // At height 1 − h over the circle's pole, h uniform: sin² = h(2 − h).
        let h = 0.5 * u * self.squared_chord;
        let sin_polar = (h * (2.0 - h)).max(0.0).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        let (tangent, bitangent) = self.tangents;
        ((1.0 - h) * self.axis + sin_polar * (cos * tangent + sin * bitangent)).normalize()
    }
}
