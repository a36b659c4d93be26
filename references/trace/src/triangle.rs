//! Watertight ray–triangle intersection (Woop, Benthin and Wald 2013).

use glam::{DVec3, Vec3};

use crate::traced_ray::TracedRay;
use crate::wide::{Found, Kernel, LANES, Packet, is_within_reach};

#[derive(Clone, Copy)]
pub(crate) struct Triangle(pub(crate) [Vec3; 3]);

impl Triangle {
    /// Whether it is finite, within reach and spans an area; anything else can neither be hit nor be given to the builder.
    pub(crate) fn is_proper(&self) -> bool {
        let [a, b, c] = self.0.map(Vec3::as_dvec3);
        let normal: DVec3 = (b - a).cross(c - a);
        is_within_reach(TrianglePacket::bounds(self)) && self.0.iter().all(|p| p.is_finite()) && normal != DVec3::ZERO
    }
}

/// Up to [`LANES`] triangles. Which of them a ray may hit is told at once; the few that remain are decided one by
/// one in `f64`, so every kernel gives the same bits.
#[repr(C, align(64))]
pub(crate) struct TrianglePacket {
    /// By corner, axis and lane; lanes without a triangle repeat the first.
    pub(crate) corners: [[[f32; LANES]; 3]; 3],
}

impl Packet for TrianglePacket {
    type Primitive = Triangle;
    /// Barycentric weights of the second and third corner.
    type Detail = [f32; 2];
    type Scratch = ();

    fn bounds(triangle: &Triangle) -> [Vec3; 2] {
        let [a, b, c] = triangle.0;
        [a.min(b).min(c), a.max(b).max(c)]
    }

    fn pack(triangles: &[Triangle]) -> Self {
        let of_lane = |lane: usize| triangles.get(lane).unwrap_or(&triangles[0]);
        let corners =
            [0, 1, 2].map(|corner| [0, 1, 2].map(|axis| std::array::from_fn(|lane| of_lane(lane).0[corner][axis])));
        TrianglePacket { corners }
    }

    #[inline(always)]
    fn candidates<K: Kernel>(&self, kernel: K, ray: &TracedRay) -> u32 {
        kernel.straddling(&self.corners, ray)
    }

    /// The edge functions are taken in `f64`, where products of two `f32` are exact and the sign of their difference
    /// too: triangles that share an edge agree on which side of it a ray passes, and none is missed by both.
    #[inline(always)]
    fn hit(&self, lane: usize, ray: &TracedRay, t_max: f32, (): &mut ()) -> Option<Found<[f32; 2]>> {
        let [x, y, z] = ray.axes;
        let sheared = |corner: &[[f32; LANES]; 3]| {
            ray.shear([corner[x as usize][lane], corner[y as usize][lane], corner[z as usize][lane]])
        };
        let [a, b, c] = [sheared(&self.corners[0]), sheared(&self.corners[1]), sheared(&self.corners[2])];
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        let t = ((u * a[2] + v * b[2] + w * c[2]) / sum) as f32;
        // Seen edge-on `sum` is 0 and `t` not a number: the comparison fails.
        (t > ray.t_min && t < t_max).then(|| Found { t, detail: [(v / sum) as f32, (w / sum) as f32] })
    }
}
