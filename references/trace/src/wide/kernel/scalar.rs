//! Lane by lane, for any machine; what the other kernels are tested against.

use super::super::{BUNDLE, Child, LANES, Node};
use super::{BoxRay, FAR, Kernel};
use crate::traced_ray::TracedRay;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar;

impl Kernel for Scalar {
    #[inline(always)]
    fn enter(self, node: &Node, ray: &BoxRay, t_max: f32) -> (u32, [f32; LANES]) {
        let (mut nears, mut fars) = ([ray.t_min; LANES], [t_max; LANES]);
        for axis in 0..3 {
            let negative = usize::from(ray.first[axis] & FAR != 0);
            let first = &node.planes[axis][negative];
            let last = &node.planes[axis][1 - negative];
            for lane in 0..LANES {
                let near = first[lane] * ray.inverse[axis] - ray.offsets[0][axis];
                let far = last[lane] * ray.inverse[axis] - ray.offsets[1][axis];
                // What is not a number cuts nothing off.
                nears[lane] = if near > nears[lane] { near } else { nears[lane] };
                fars[lane] = if far < fars[lane] { far } else { fars[lane] };
            }
        }
        (mask(|lane| nears[lane] <= fars[lane]), nears)
    }

    #[inline(always)]
    fn straddling(self, corners: &[[[f32; LANES]; 3]; 3], ray: &TracedRay) -> u32 {
        let [x, y, z] = ray.axes.map(|axis| axis as usize);
        mask(|lane| {
            let [a, b, c] = [0, 1, 2].map(|corner: usize| {
                let corner = &corners[corner];
                let z = corner[z][lane] - ray.start[2];
                let x = corner[x][lane] - ray.start[0];
                let y = corner[y][lane] - ray.start[1];
                [x - ray.slopes[0] * z, y - ray.slopes[1] * z]
            });
            let edges = [[c, b], [a, c], [b, a]].map(|[p, q]| p[0] * q[1] - p[1] * q[0]);
            !(edges.iter().any(|e| *e < 0.0) && edges.iter().any(|e| *e > 0.0))
        })
    }

    #[inline(always)]
    fn fetch<T>(self, _: &T) {}

    #[inline(always)]
    fn transpose(self, masks: &[u8; BUNDLE]) -> [u64; LANES] {
        std::array::from_fn(|lane| (0..BUNDLE).fold(0, |rays, ray| rays | u64::from(masks[ray] >> lane & 1) << ray))
    }

    #[inline(always)]
    fn push(self, children: &[Child; LANES], mask: u32, room: &mut [Child; LANES]) {
        let mut next = 0;
        for (lane, child) in children.iter().enumerate() {
            if mask >> lane & 1 == 1 {
                room[next] = *child;
                next += 1;
            }
        }
    }
}

#[inline(always)]
fn mask(holds: impl Fn(usize) -> bool) -> u32 {
    (0..LANES).fold(0, |mask, lane| mask | u32::from(holds(lane)) << lane)
}
