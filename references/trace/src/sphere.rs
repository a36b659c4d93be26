//! Exact spheres.

use glam::Vec3;

use crate::hierarchy::{Found, Primitive};
use crate::traced_ray::TracedRay;

/// A sphere in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

impl Sphere {
    pub(crate) fn is_proper(&self) -> bool {
        let (low, high) = self.bounds();
        self.radius > 0.0 && low.is_finite() && high.is_finite()
    }
}

impl Primitive for Sphere {
    fn bounds(&self) -> (Vec3, Vec3) {
        (self.center - self.radius, self.center + self.radius)
    }

    /// In `f64`, with the discriminant from the distance between centre and ray and the roots from `q`, so that
    /// neither a far nor a huge sphere cancels (Haines et al. 2019, "Precision improvements for ray/sphere
    /// intersection"). A ray that only touches the sphere misses it.
    fn hit(&self, ray: &TracedRay, t_max: f32) -> Option<Found> {
        let direction = ray.direction.as_dvec3();
        let radius = f64::from(self.radius);
        let from_center = ray.origin.as_dvec3() - self.center.as_dvec3();
        let a = direction.length_squared();
        let b = -from_center.dot(direction);
        let squared_gap = (from_center + direction * (b / a)).length_squared();
        let discriminant = radius * radius - squared_gap;
        if discriminant <= 0.0 {
            return None;
        }
        let q = b + (a * discriminant).sqrt().copysign(b);
        let c = from_center.length_squared() - radius * radius;
        let roots = [(c / q) as f32, (q / a) as f32];
        let (near, far) = if roots[0] < roots[1] { (roots[0], roots[1]) } else { (roots[1], roots[0]) };
        let inside = |t: &f32| *t > ray.t_min && *t < t_max;
        [near, far].into_iter().find(inside).map(|t| Found { t, barycentrics: [0.0; 2] })
    }
}
