//! Watertight ray–triangle intersection (Woop, Benthin and Wald 2013).

use glam::{DVec3, Vec3};

use crate::hierarchy::{Found, Primitive};
use crate::traced_ray::TracedRay;

#[derive(Clone, Copy)]
pub(crate) struct Triangle(pub(crate) [Vec3; 3]);

impl Triangle {
    /// Whether it is finite and spans an area; anything else can neither be hit nor be given to the builder.
    pub(crate) fn is_proper(&self) -> bool {
        let [a, b, c] = self.0.map(Vec3::as_dvec3);
        let normal: DVec3 = (b - a).cross(c - a);
        normal.is_finite() && normal != DVec3::ZERO
    }
}

impl Primitive for Triangle {
    fn bounds(&self) -> (Vec3, Vec3) {
        let [a, b, c] = self.0;
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// The edge functions are taken in `f64`, where products of two `f32` are exact and the sign of their difference
    /// too: triangles that share an edge agree on which side of it a ray passes, and none is missed by both.
    fn hit(&self, ray: &TracedRay, t_max: f32) -> Option<Found> {
        let [a, b, c] = self.0.map(|corner| ray.shear(corner).as_dvec3());
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        let t = ((u * a.z + v * b.z + w * c.z) / sum) as f32;
        // Seen edge-on `sum` is 0 and `t` not a number: the comparison fails.
        (t > ray.t_min && t < t_max).then(|| Found { t, barycentrics: [(v / sum) as f32, (w / sum) as f32] })
    }
}
