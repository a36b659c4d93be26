//! What is done to eight lanes at once, in the widest instructions that the machine has.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod scalar;

use glam::{Vec3, Vec3A};

use super::{BUNDLE, Bundle, Child, Found, Hierarchy, Id, LANES, Node, Packet, Stack};
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

    /// Asks the memory for a value that is to be read soon.
    fn fetch<T>(self, value: &T);

    /// For each lane, the mask of the rays whose masks of lanes hold it.
    fn transpose(self, masks: &[u8; BUNDLE]) -> [u64; LANES];
}

/// A ray as the boxes of one tree see it: it meets a plane at `plane·inverse − offset`. The offsets give way by what
/// rounding may add up to. One cache line.
#[repr(align(64))]
#[derive(Clone, Copy, Default)]
pub(crate) struct BoxRay {
    inverse: [f32; 3],
    /// Of the planes that are met first, and of those met last.
    offsets: [[f32; 3]; 2],
    /// Where the planes met first lie in [`Node::planes`], in bytes; those met last lie at [`FAR`] from there.
    first: [u32; 3],
    t_min: f32,
}

/// What turns the place of one of a pair of planes into that of the other, by exclusive or.
const FAR: u32 = (LANES * size_of::<f32>()) as u32;

impl BoxRay {
    #[inline(always)]
    pub(super) fn new(ray: &TracedRay, bounds: &[Vec3; 2]) -> Self {
        let inverse = Vec3A::from(ray.inverse);
        let (at_origin, slack) = (Vec3A::from(ray.origin) * inverse, ray.slack(bounds));
        let (near, far) = (at_origin + slack, at_origin - slack);
        let first = |axis: u32, inverse: f32| 2 * axis * FAR + if inverse.is_sign_negative() { FAR } else { 0 };
        let first = [first(0, ray.inverse.x), first(1, ray.inverse.y), first(2, ray.inverse.z)];
        BoxRay { inverse: inverse.into(), offsets: [near.into(), far.into()], first, t_min: ray.t_min }
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

    pub(super) fn any_of<P: Packet>(
        self,
        tree: &Hierarchy<P>,
        bundle: Bundle<'_>,
        stack: &mut Stack<P::Scratch>,
    ) -> u64 {
        match self {
            Level::Scalar(kernel) => super::stream::any_of(kernel, tree, bundle, stack),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(kernel) => kernel.any_of(tree, bundle, stack),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(kernel) => kernel.any_of(tree, bundle, stack),
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
