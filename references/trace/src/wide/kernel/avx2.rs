//! Eight lanes of AVX2 with fused multiply–add.

use std::arch::x86_64::*;

use super::super::{
    ALL_LANES, BUNDLE, Bundle, Child, Found, Hierarchy, Id, LANES, Node, Packet, Stack, stream, traverse,
};
use super::{BoxRay, FAR, Kernel};
use crate::traced_ray::TracedRay;

/// Proof that AVX2, FMA and the instructions that count bits are there: made by [`Avx2::detect`] only.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

impl Avx2 {
    pub(super) fn detect() -> Option<Self> {
        let wide = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        let bits =
            is_x86_feature_detected!("bmi1") && is_x86_feature_detected!("lzcnt") && is_x86_feature_detected!("popcnt");
        (wide && bits).then_some(Avx2(()))
    }

    pub(super) fn any<P: Packet>(
        self,
        tree: &Hierarchy<P>,
        ray: &TracedRay,
        t_max: f32,
        stack: &mut Stack<P::Scratch>,
    ) -> bool {
        #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
        fn compiled<P: Packet>(
            kernel: Avx2,
            tree: &Hierarchy<P>,
            ray: &TracedRay,
            t: f32,
            stack: &mut Stack<P::Scratch>,
        ) -> bool {
            traverse::any(kernel, tree, ray, t, stack)
        }
        // SAFETY: `self` proves the features.
        unsafe { compiled(self, tree, ray, t_max, stack) }
    }

    pub(super) fn any_of<P: Packet>(
        self,
        tree: &Hierarchy<P>,
        bundle: Bundle<'_>,
        stack: &mut Stack<P::Scratch>,
    ) -> u64 {
        #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
        fn compiled<P: Packet>(
            kernel: Avx2,
            tree: &Hierarchy<P>,
            bundle: Bundle<'_>,
            stack: &mut Stack<P::Scratch>,
        ) -> u64 {
            stream::any_of(kernel, tree, bundle, stack)
        }
        // SAFETY: `self` proves the features.
        unsafe { compiled(self, tree, bundle, stack) }
    }

    pub(super) fn closest<P: Packet>(
        self,
        tree: &Hierarchy<P>,
        ray: &TracedRay,
        t_max: f32,
        stack: &mut Stack<P::Scratch>,
    ) -> Option<(Found<P::Detail>, Id)> {
        #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
        fn compiled<P: Packet>(
            kernel: Avx2,
            tree: &Hierarchy<P>,
            ray: &TracedRay,
            t_max: f32,
            stack: &mut Stack<P::Scratch>,
        ) -> Option<(Found<P::Detail>, Id)> {
            traverse::closest(kernel, tree, ray, t_max, stack)
        }
        // SAFETY: `self` proves the features.
        unsafe { compiled(self, tree, ray, t_max, stack) }
    }
}

impl Kernel for Avx2 {
    #[inline(always)]
    fn enter(self, node: &Node, ray: &BoxRay, t_max: f32) -> (u32, [f32; LANES]) {
        // SAFETY: `self` proves the features.
        unsafe { enter(node, ray, t_max) }
    }

    #[inline(always)]
    fn straddling(self, corners: &[[[f32; LANES]; 3]; 3], ray: &TracedRay) -> u32 {
        // SAFETY: `self` proves the features.
        unsafe { straddling(corners, ray) }
    }

    #[inline(always)]
    fn fetch<T>(self, value: &T) {
        fetch(value);
    }

    #[inline(always)]
    fn transpose(self, masks: &[u8; BUNDLE]) -> [u64; LANES] {
        // SAFETY: `self` proves the features.
        unsafe { transpose(masks) }
    }

    #[inline(always)]
    fn push(self, children: &[Child; LANES], mask: u32, room: &mut [Child; LANES]) {
        // SAFETY: `self` proves the features.
        unsafe { push(children, mask, room) }
    }
}

/// Where the ray enters and leaves the boxes.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn interval(node: &Node, ray: &BoxRay, t_max: f32) -> (__m256, __m256) {
    let (mut near, mut far) = (_mm256_set1_ps(ray.t_min), _mm256_set1_ps(t_max));
    for axis in 0..3 {
        let inverse = _mm256_set1_ps(ray.inverse[axis]);
        // SAFETY: `BoxRay::new` made the places of these planes, which the node holds.
        let [first, last] = unsafe { [plane(node, ray.first[axis]), plane(node, ray.first[axis] ^ FAR)] };
        let first = _mm256_fmsub_ps(first, inverse, _mm256_set1_ps(ray.offsets[0][axis]));
        let last = _mm256_fmsub_ps(last, inverse, _mm256_set1_ps(ray.offsets[1][axis]));
        // The second operand is kept where the first is not a number: it cuts nothing off.
        near = _mm256_max_ps(first, near);
        far = _mm256_min_ps(last, far);
    }
    (near, far)
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn enter(node: &Node, ray: &BoxRay, t_max: f32) -> (u32, [f32; LANES]) {
    let (near, far) = interval(node, ray, t_max);
    let mut nears = [0.0; LANES];
    // SAFETY: the array holds the eight lanes that are written.
    unsafe { _mm256_storeu_ps(nears.as_mut_ptr(), near) };
    (_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32, nears)
}

/// The lowest and the highest of each triangle's edge functions.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(super) fn extremes(corners: &[[[f32; LANES]; 3]; 3], ray: &TracedRay) -> (__m256, __m256) {
    let [a, b, c] = [sheared(&corners[0], ray), sheared(&corners[1], ray), sheared(&corners[2], ray)];
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    // What is not a number falls out of the extremes or makes the comparison fail: it rejects nothing.
    let lowest = _mm256_min_ps(_mm256_min_ps(u, v), w);
    let highest = _mm256_max_ps(_mm256_max_ps(u, v), w);
    (lowest, highest)
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn straddling(corners: &[[[f32; LANES]; 3]; 3], ray: &TracedRay) -> u32 {
    let (lowest, highest) = extremes(corners, ray);
    let zero = _mm256_setzero_ps();
    let below = _mm256_cmp_ps::<_CMP_LT_OQ>(lowest, zero);
    let above = _mm256_cmp_ps::<_CMP_GT_OQ>(highest, zero);
    !_mm256_movemask_ps(_mm256_and_ps(below, above)) as u32 & ALL_LANES
}

/// The first two of the coordinates that [`TracedRay::shear`] gives.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn sheared(corner: &[[f32; LANES]; 3], ray: &TracedRay) -> [__m256; 2] {
    let [x, y, z] = ray.axes;
    let z = _mm256_sub_ps(load(&corner[z as usize]), _mm256_set1_ps(ray.start[2]));
    let x = _mm256_sub_ps(load(&corner[x as usize]), _mm256_set1_ps(ray.start[0]));
    let y = _mm256_sub_ps(load(&corner[y as usize]), _mm256_set1_ps(ray.start[1]));
    [
        _mm256_sub_ps(x, _mm256_mul_ps(_mm256_set1_ps(ray.slopes[0]), z)),
        _mm256_sub_ps(y, _mm256_mul_ps(_mm256_set1_ps(ray.slopes[1]), z)),
    ]
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn edge(p: [__m256; 2], q: [__m256; 2]) -> __m256 {
    _mm256_sub_ps(_mm256_mul_ps(p[0], q[1]), _mm256_mul_ps(p[1], q[0]))
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn push(children: &[Child; LANES], mask: u32, room: &mut [Child; LANES]) {
    let order = &FRONT[mask as usize & (FRONT.len() - 1)];
    // SAFETY: a `Child` is a transparent `u32`, and all three arrays hold eight elements.
    unsafe {
        let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order.as_ptr().cast()));
        let children = _mm256_loadu_si256(children.as_ptr().cast());
        _mm256_storeu_si256(room.as_mut_ptr().cast(), _mm256_permutevar8x32_epi32(children, order));
    }
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn transpose(masks: &[u8; BUNDLE]) -> [u64; LANES] {
    // SAFETY: the array holds the two times 32 bytes that are read.
    let [low, high] = [0, 32].map(|at| unsafe { _mm256_loadu_si256(masks[at..].as_ptr().cast()) });
    let mut rays = [0; LANES];
    for (lane, rays) in rays.iter_mut().enumerate() {
        // The lane's bit comes to the top of its byte; what the shift carries over stays below it.
        let up = _mm_cvtsi32_si128((LANES - 1 - lane) as i32);
        let low = _mm256_movemask_epi8(_mm256_sll_epi64(low, up)) as u32;
        let high = _mm256_movemask_epi8(_mm256_sll_epi64(high, up)) as u32;
        *rays = u64::from(low) | u64::from(high) << 32;
    }
    rays
}

#[inline(always)]
pub(super) fn fetch<T>(value: &T) {
    const LINE: usize = 64;
    for at in (0..size_of::<T>()).step_by(LINE) {
        // SAFETY: a hint reads nothing, and these instructions are part of x86-64.
        unsafe { _mm_prefetch::<_MM_HINT_T0>((&raw const *value).cast::<i8>().wrapping_add(at)) };
    }
}

/// # Safety
/// `place` must be that of a row of [`Node::planes`], in bytes.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
unsafe fn plane(node: &Node, place: u32) -> __m256 {
    // SAFETY: the caller's, and nodes are aligned to more than a row.
    unsafe { _mm256_load_ps((&raw const node.planes).byte_add(place as usize).cast()) }
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn load(lanes: &[f32; LANES]) -> __m256 {
    // SAFETY: the array holds the eight lanes that are read.
    unsafe { _mm256_loadu_ps(lanes.as_ptr()) }
}

/// For each mask, its lanes in ascending order, then zeros.
static FRONT: [[u8; LANES]; 1 << LANES] = {
    let mut table = [[0; LANES]; 1 << LANES];
    let mut mask = 0;
    while mask < table.len() {
        let (mut lane, mut next) = (0, 0);
        while lane < LANES {
            if mask >> lane & 1 == 1 {
                table[mask][next] = lane as u8;
                next += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};
