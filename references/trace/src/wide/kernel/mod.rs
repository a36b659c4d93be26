//! What is done to eight lanes at once, in the widest instructions that the machine has.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod scalar;

use glam::Vec3;

use super::{Child, Found, Hierarchy, Id, LANES, Node, Packet, Stack};
use crate::traced_ray::TracedRay;

/// A set of instructions. A value of it is proof that the machine has them.
pub(crate) trait Kernel: Copy {
    /// Mask of the boxes that the segment enters before `t_max`, none missed for rounding, and where it does.
    /// Lanes without a child may be among them.
    fn enter(self, node: &Node, ray: &BoxRay, t_max: f32) -> (u32, [f32; LANES]);

    /// Mask of the triangles (corners by corner, axis and lane) that the ray's line may pass through: those whose
    /// edge functions do not certainly have different signs.
    ///
    /// Products are rounded on their own, never fused: rounding is monotonic, so a sign may come out 0 but not wrong.
    fn straddling(self, corners: &[[[f32; LANES]; 3]; 3], ray: &TracedRay) -> u32;

    /// Writes the children in `mask` to the front of `room`, in their order; what follows them there is void.
    fn push(self, children: &[Child; LANES], mask: u32, room: &mut [Child; LANES]);
}

/// A ray as the boxes of one tree see it.
pub(crate) struct BoxRay {
    origin: Vec3,
    inverse: Vec3,
    slack: Vec3,
    /// Where the direction is negative, the ray meets the box's highest corner first.
    negative: [bool; 3],
    t_min: f32,
}

impl BoxRay {
    #[inline(always)]
    pub(super) fn new(ray: &TracedRay, bounds: &[Vec3; 2]) -> Self {
        BoxRay {
            origin: ray.origin,
            inverse: ray.inverse,
            slack: ray.slack(bounds),
            negative: ray.inverse.to_array().map(f32::is_sign_negative),
            t_min: ray.t_min,
        }
    }
}

/// The kernels of this machine, one of which is chosen when a hierarchy is built.
#[derive(Clone, Copy, Debug)]
pub(super) enum Level {
    Scalar(scalar::Scalar),
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(avx512::Avx512),
}

impl Level {
    /// The fastest that this machine can run.
    pub(super) fn of_this_machine() -> Self {
        Self::all().pop().expect("the scalar kernel runs everywhere")
    }

    /// Every kernel that this machine can run, the fastest last.
    pub(super) fn all() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        let wider = [avx2::Avx2::detect().map(Level::Avx2), avx512::Avx512::detect().map(Level::Avx512)];
        #[cfg(not(target_arch = "x86_64"))]
        let wider = [None];
        [Some(Level::Scalar(scalar::Scalar))].into_iter().chain(wider).flatten().collect()
    }

    pub(super) fn any<P: Packet>(
        self,
        tree: &Hierarchy<P>,
        ray: &TracedRay,
        t_max: f32,
        stack: &mut Stack<P::Scratch>,
    ) -> bool {
        match self {
            Level::Scalar(kernel) => super::traverse::any(kernel, tree, ray, t_max, stack),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(kernel) => kernel.any(tree, ray, t_max, stack),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(kernel) => kernel.any(tree, ray, t_max, stack),
        }
    }

    pub(super) fn closest<P: Packet>(
        self,
        tree: &Hierarchy<P>,
        ray: &TracedRay,
        t_max: f32,
        stack: &mut Stack<P::Scratch>,
    ) -> Option<(Found<P::Detail>, Id)> {
        match self {
            Level::Scalar(kernel) => super::traverse::closest(kernel, tree, ray, t_max, stack),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(kernel) => kernel.closest(tree, ray, t_max, stack),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(kernel) => kernel.closest(tree, ray, t_max, stack),
        }
    }
}
