//! A ray with what boxes and triangles ask of it worked out once.

use glam::Vec3;

/// Bounds, relative to a coordinate's distance from the ray's start, what rounding may add up to between a box's
/// planes and the sheared corners of a triangle inside: four roundings for the shear, six for the planes, and some
/// to spare (Woop, Benthin and Wald 2013, section 4).
const ROUNDING: f32 = 16.0 * (f32::EPSILON / 2.0);

/// Direction components below this fraction of the largest count as that fraction, far below [`ROUNDING`]: no
/// plane distance is then `0·∞`, and a ray parallel to a plane keeps to its side.
const LEAST_SLOPE: f32 = 1.0 / (1u64 << 40) as f32;

/// A ray prepared for many tests.
#[derive(Clone, Copy)]
pub(crate) struct TracedRay {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) t_min: f32,
    /// Reciprocal direction, finite.
    pub(crate) inverse: Vec3,
    /// Axes permuted so that the last is the direction's largest and winding is kept.
    pub(crate) axes: [usize; 3],
    /// Slopes against the last axis.
    pub(crate) slopes: [f32; 2],
}

impl TracedRay {
    /// Nothing for a ray that is not finite or has no direction.
    pub(crate) fn new(origin: Vec3, direction: Vec3, t_min: f32) -> Option<Self> {
        let z = direction.abs().max_position();
        let d = direction.to_array();
        if !(origin.is_finite() && direction.is_finite() && d[z] != 0.0) {
            return None;
        }
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let least = Vec3::splat(d[z].abs() * LEAST_SLOPE);
        let inverse = direction.abs().max(least).copysign(direction).recip();
        let slopes = [d[x] * inverse[z], d[y] * inverse[z]];
        Some(TracedRay { origin, direction, t_min, inverse, axes: [x, y, z], slopes })
    }

    /// By how much plane distances must give way so that no box within `bounds` is missed whose triangles are hit:
    /// the shear moves corners along its first two axes by what the third carries into them.
    pub(crate) fn slack(&self, bounds: &[Vec3; 2]) -> Vec3 {
        let reach = (bounds[0] - self.origin).abs().max((bounds[1] - self.origin).abs());
        (reach + reach[self.axes[2]]) * ROUNDING * self.inverse.abs()
    }

    /// A point in the space where the ray starts at the origin and runs along +z with unit speed
    /// (Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection").
    pub(crate) fn shear(&self, point: Vec3) -> Vec3 {
        let p = point - self.origin;
        let [x, y, z] = self.axes;
        Vec3::new(p[x] - self.slopes[0] * p[z], p[y] - self.slopes[1] * p[z], p[z] * self.inverse[z])
    }
}
