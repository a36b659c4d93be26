//! Eight lanes again, with AVX-512's comparisons into masks, its compression and its 32 registers.
//!
//! Sixteen lanes would want other nodes and leaves, for little: a visit waits on latency, not on arithmetic.

use std::arch::x86_64::*;

use super::super::{
    ALL_LANES, BUNDLE, Bundle, Child, Found, Hierarchy, Id, LANES, Node, Packet, Stack, stream, traverse,
};
use super::{BoxRay, Kernel, avx2};
use crate::traced_ray::TracedRay;

/// Proof that AVX-512 F, VL and BW are there besides all that [`avx2::Avx2`] proves: made by [`Avx512::detect`] only.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

impl Avx512 {
    pub(super) fn detect() -> Option<Self> {
        let wide = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512bw");
        avx2::Avx2::detect().filter(|_| wide).map(|_| Avx512(()))
    }

    pub(super) fn any<P: Packet>(
        self,
        tree: &Hierarchy<P>,
        ray: &TracedRay,
        t_max: f32,
        stack: &mut Stack<P::Scratch>,
    ) -> bool {
        #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw")]
        fn compiled<P: Packet>(
            k: Avx512,
            tree: &Hierarchy<P>,
            ray: &TracedRay,
            t: f32,
            stack: &mut Stack<P::Scratch>,
        ) -> bool {
            traverse::any(k, tree, ray, t, stack)
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
        #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw")]
        fn compiled<P: Packet>(
            kernel: Avx512,
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
        #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw")]
        fn compiled<P: Packet>(
            kernel: Avx512,
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

impl Kernel for Avx512 {
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
        avx2::fetch(value);
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

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw")]
fn enter(node: &Node, ray: &BoxRay, t_max: f32) -> (u32, [f32; LANES]) {
    let (near, far) = avx2::interval(node, ray, t_max);
    let mut nears = [0.0; LANES];
    // SAFETY: the array holds the eight lanes that are written.
    unsafe { _mm256_storeu_ps(nears.as_mut_ptr(), near) };
    (_mm256_cmp_ps_mask::<_CMP_LE_OQ>(near, far).into(), nears)
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw")]
fn straddling(corners: &[[[f32; LANES]; 3]; 3], ray: &TracedRay) -> u32 {
    let (lowest, highest) = avx2::extremes(corners, ray);
    let zero = _mm256_setzero_ps();
    let below = _mm256_cmp_ps_mask::<_CMP_LT_OQ>(lowest, zero);
    let both = _mm256_mask_cmp_ps_mask::<_CMP_GT_OQ>(below, highest, zero);
    u32::from(!both) & ALL_LANES
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw")]
fn push(children: &[Child; LANES], mask: u32, room: &mut [Child; LANES]) {
    // SAFETY: a `Child` is a transparent `u32`, and both arrays hold eight.
    unsafe {
        let children = _mm256_loadu_si256(children.as_ptr().cast());
        // Compressed in a register: compressing straight to memory is slow on Zen 4.
        _mm256_storeu_si256(room.as_mut_ptr().cast(), _mm256_maskz_compress_epi32(mask as __mmask8, children));
    }
}

#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw")]
fn transpose(masks: &[u8; BUNDLE]) -> [u64; LANES] {
    // SAFETY: the array holds the 64 bytes that are read.
    let masks = unsafe { _mm512_loadu_si512(masks.as_ptr().cast()) };
    let mut rays = [0; LANES];
    for (lane, rays) in rays.iter_mut().enumerate() {
        *rays = _mm512_test_epi8_mask(masks, _mm512_set1_epi8((1u8 << lane).cast_signed()));
    }
    rays
}
