//! Where models are, and a camera that has all of them in view.

use glam::{DVec3, Vec3};

use super::digits;
use crate::{Object, Shape};

/// Most times at which moving models are looked at.
const MOST_TIMES: usize = 16;
/// Towards the eye: from the front, some way round to the right and above.
const THREE_QUARTER: DVec3 = DVec3::new(0.5, -1.0, 0.55);
/// Of the picture's half sides that models may fill.
const FILLED: f64 = 0.8;
/// Vertical field of view in degrees.
pub(super) const FOV: f32 = 35.0;

/// A box along the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Bounds {
    /// What objects fill over a number of frames; those that only receive count where there are no others.
    pub(super) fn of(objects: &[&Object], frames: usize, fps: f32) -> Bounds {
        let casters: Vec<&Object> = objects.iter().filter(|object| object.casts).copied().collect();
        let counted = if casters.is_empty() { objects } else { &casters };
        let mut bounds = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        counted.iter().for_each(|object| bounds.add_moving(object, frames, fps));
        bounds
    }

    fn add_moving(&mut self, object: &Object, frames: usize, fps: f32) {
        let step = if object.rests() { frames } else { frames.div_ceil(MOST_TIMES) };
        for frame in (0..frames).step_by(step.max(1)) {
            let time = frame as f32 / fps;
            self.add_shape(&object.shape_at(time).0.posed(object.pose_at(time)));
        }
    }

    fn add_shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Mesh(mesh) => self.add_points(&mesh.positions),
            Shape::Heights(field) => self.add_points(&field.mesh().positions),
            Shape::Spheres(spheres) => spheres.iter().for_each(|sphere| {
                let radius = Vec3::splat(sphere.radius);
                self.add_points(&[sphere.center - radius, sphere.center + radius]);
            }),
        }
    }

    fn add_points(&mut self, points: &[Vec3]) {
        let low = points.iter().fold(Vec3::INFINITY, |low, point| low.min(*point));
        let high = points.iter().fold(Vec3::NEG_INFINITY, |high, point| high.max(*point));
        (self.low, self.high) = (self.low.min(low.as_dvec3()), self.high.max(high.as_dvec3()));
    }

    pub(super) fn sides(&self) -> DVec3 {
        self.high - self.low
    }

    pub(super) fn center(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// Length of the diagonal, above 0.
    pub(super) fn size(&self) -> f64 {
        self.sides().length().max(1e-9)
    }

    fn corners(&self) -> [DVec3; 8] {
        let pick = |i: usize, axis: usize| if i >> axis & 1 == 1 { self.high[axis] } else { self.low[axis] };
        std::array::from_fn(|i| DVec3::new(pick(i, 0), pick(i, 1), pick(i, 2)))
    }
}

/// Eye and target of a camera that sees a box whole in a picture of an aspect (width by height).
pub(super) fn framed(bounds: &Bounds, aspect: f64) -> ([f32; 3], [f32; 3]) {
    let back = THREE_QUARTER.normalize();
    let right = DVec3::Z.cross(back).normalize();
    let up = back.cross(right);
    let center = bounds.center();
    let half = FILLED * (0.5 * f64::from(FOV).to_radians()).tan();
    let distance = |corner: DVec3| {
        let from = corner - center;
        from.dot(back) + (from.dot(up).abs() / half).max(from.dot(right).abs() / (half * aspect))
    };
    let distance = bounds.corners().into_iter().map(distance).fold(bounds.size(), f64::max);
    (digits::within(center + back * distance, bounds.size()), digits::within(center, bounds.size()))
}
