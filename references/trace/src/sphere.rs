//! Exact spheres.

use glam::Vec3;

use crate::traced_ray::TracedRay;
use crate::wide::{ALL_LANES, Found, Kernel, LANES, Packet, is_within_reach};

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
        self.radius > 0.0 && is_within_reach(SpherePacket::bounds(self))
    }
}

/// Up to [`LANES`] spheres, each a candidate for every ray that reaches them.
pub(crate) struct SpherePacket([Sphere; LANES]);

impl Packet for SpherePacket {
    type Primitive = Sphere;
    type Detail = ();
    type Scratch = ();

    fn bounds(sphere: &Sphere) -> [Vec3; 2] {
        [sphere.center - sphere.radius, sphere.center + sphere.radius]
    }

    fn pack(spheres: &[Sphere]) -> Self {
        SpherePacket(std::array::from_fn(|lane| *spheres.get(lane).unwrap_or(&spheres[0])))
    }

    #[inline(always)]
    fn candidates<K: Kernel>(&self, _: K, _: &TracedRay) -> u32 {
        ALL_LANES
    }

    /// In `f64`, with the discriminant from the distance between centre and ray and the roots from `q`, so that
    /// neither a far nor a huge sphere cancels (Haines et al. 2019, "Precision improvements for ray/sphere
    /// intersection"). A ray that only touches the sphere misses it.
    fn hit(&self, lane: usize, ray: &TracedRay, t_max: f32, (): &mut ()) -> Option<Found<()>> {
        let Sphere { center, radius } = self.0[lane];
        let direction = ray.direction.as_dvec3();
        let radius = f64::from(radius);
        let from_center = ray.origin.as_dvec3() - center.as_dvec3();
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
        [near, far].into_iter().find(inside).map(|t| Found { t, detail: () })
    }
}
