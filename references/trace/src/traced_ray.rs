//! A ray with what boxes and triangles ask of it worked out once.

use glam::Vec3;

/// Widens the far end of a box's interval so that rounding never culls a box that the ray touches
/// (three roundings on either side: Ize 2013, "Robust BVH ray traversal").
const FAR_WIDENING: f32 = 1.0 + 8.0 * (f32::EPSILON / 2.0);

/// A ray prepared for many tests.
pub(crate) struct TracedRay {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) t_min: f32,
    inverse: [f32; 3],
    /// 1 where the direction is negative: the box corner that the ray meets first.
    negative: [usize; 3],
    /// Axes permuted so that the last is the direction's largest and winding is kept.
    axes: [usize; 3],
    shear: Vec3,
}

impl TracedRay {
    pub(crate) fn new(origin: Vec3, direction: Vec3, t_min: f32) -> Self {
        let d = direction.to_array();
        let z = direction.abs().max_position();
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        TracedRay {
            origin,
            direction,
            t_min,
            inverse: d.map(|v| 1.0 / v),
            negative: d.map(|v| usize::from(v.is_sign_negative())),
            axes: [x, y, z],
            shear: Vec3::new(d[x] / d[z], d[y] / d[z], 1.0 / d[z]),
        }
    }

    /// Distance at which the ray enters a box given by its two corners, if it does so before `t_max`.
    ///
    /// A ray within a face gives `0·∞ = NaN`; the comparisons below then keep the interval, so it counts as inside.
    pub(crate) fn enter(&self, corners: &[[f32; 3]; 2], t_max: f32) -> Option<f32> {
        let (mut near, mut far) = (self.t_min, t_max);
        for axis in 0..3 {
            let first = (corners[self.negative[axis]][axis] - self.origin[axis]) * self.inverse[axis];
            let last = (corners[1 - self.negative[axis]][axis] - self.origin[axis]) * self.inverse[axis] * FAR_WIDENING;
            near = if first > near { first } else { near };
            far = if last < far { last } else { far };
        }
        (near <= far).then_some(near)
    }

    /// A point in the space where the ray starts at the origin and runs along +z with unit speed
    /// (Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection").
    pub(crate) fn shear(&self, point: Vec3) -> Vec3 {
        let p = point - self.origin;
        let [x, y, z] = self.axes;
        Vec3::new(p[x] - self.shear.x * p[z], p[y] - self.shear.y * p[z], self.shear.z * p[z])
    }
}
