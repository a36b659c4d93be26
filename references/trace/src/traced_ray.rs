//! A ray with what boxes and triangles ask of it worked out once.

use glam::{Vec3, Vec3A};

/// Bounds, relative to coordinates and their distances from the ray's start, what rounding may add up to between a
/// box's planes and the sheared corners of a triangle inside: four roundings for the shear, six for the planes, and
/// some to spare (Woop, Benthin and Wald 2013, section 4).
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
    pub(crate) axes: [Axis; 3],
    /// The origin along these axes.
    pub(crate) start: [f32; 3],
    /// Slopes against the last axis, and its reciprocal direction.
    pub(crate) slopes: [f32; 3],
}

/// An index that needs no bounds check.
#[derive(Clone, Copy)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

impl TracedRay {
    /// In place of a ray that hits nothing, where there must be one.
    pub(crate) const NONE: TracedRay = TracedRay {
        origin: Vec3::ZERO,
        direction: Vec3::Z,
        t_min: f32::INFINITY,
        inverse: Vec3::ONE,
        axes: [Axis::X, Axis::Y, Axis::Z],
        start: [0.0; 3],
        slopes: [0.0; 3],
    };

    /// Nothing for a ray that is not finite or has no direction.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3, direction: Vec3, t_min: f32) -> Option<Self> {
        // The three coordinates in one register.
        let d = Vec3A::from(direction);
        let size = d.abs();
        let least = size.max_element() * LEAST_SLOPE;
        if !(Vec3A::from(origin).is_finite() && d.is_finite() && least > 0.0) {
            return None;
        }
        let inverse = size.max(Vec3A::splat(least)).copysign(d).recip();
        let axes = permuted(direction);
        let [x, y, z] = axes.map(|axis| axis as usize);
        let (d, start, steepest) = (direction.to_array(), origin.to_array(), inverse.to_array()[z]);
        let slopes = [d[x] * steepest, d[y] * steepest, steepest];
        let (start, inverse) = ([start[x], start[y], start[z]], inverse.into());
        Some(TracedRay { origin, direction, t_min, inverse, axes, start, slopes })
    }

    /// By how much plane distances must give way so that no box within `bounds` is missed whose triangles are hit:
    /// the shear moves corners along its first two axes by what the third carries into them.
    #[inline(always)]
    pub(crate) fn slack(&self, bounds: &[Vec3; 2]) -> Vec3A {
        let (origin, inverse) = (Vec3A::from(self.origin), Vec3A::from(self.inverse));
        let reach = (Vec3A::from(bounds[0]) - origin).abs().max((Vec3A::from(bounds[1]) - origin).abs());
        let carried = Vec3A::splat(reach.to_array()[self.axes[2] as usize]);
        (origin.abs() + reach + carried) * inverse.abs() * ROUNDING
    }

    /// A point, given along the permuted axes, in the space where the ray starts at the origin and runs along +z with
    /// unit speed (Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection").
    #[inline(always)]
    pub(crate) fn shear(&self, point: [f32; 3]) -> [f64; 3] {
        let [x, y, z] = [point[0] - self.start[0], point[1] - self.start[1], point[2] - self.start[2]];
        let sheared = [x - self.slopes[0] * z, y - self.slopes[1] * z, self.slopes[2] * z];
        [f64::from(sheared[0]), f64::from(sheared[1]), f64::from(sheared[2])]
    }
}

/// By table: the choice is as good as random, and a wrongly guessed branch costs more than it all.
#[inline(always)]
fn permuted(direction: Vec3) -> [Axis; 3] {
    use Axis::{X, Y, Z};
    const AXES: [[[Axis; 3]; 2]; 3] = [[[Y, Z, X], [Z, Y, X]], [[Z, X, Y], [X, Z, Y]], [[X, Y, Z], [Y, X, Z]]];
    let size = direction.abs();
    let z = if size.y > size.x { Y } else { X };
    let z = if size.z > size.x.max(size.y) { Z } else { z };
    AXES[z as usize][usize::from(direction.to_array()[z as usize] < 0.0)]
}
