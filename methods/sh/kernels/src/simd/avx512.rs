//! 512-bit vectors.

use std::arch::x86_64::*;

use super::Lanes;
use super::avx2::sum_rows_of_eight;
use crate::LANES;
use crate::block::Block;

/// Sixteen `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct F32x16(__m512);

/// Eight `f64`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct F64x8(__m512d);

/// The methods that differ between the two types by the intrinsics' suffix alone.
macro_rules! arithmetic {
    ($wrap:ident, $t:ty, $width:literal, $set1:ident, $loadu:ident, $storeu:ident, $add:ident, $sub:ident, $mul:ident,
     $div:ident, $fmadd:ident, $fnmadd:ident, $sqrt:ident, $min:ident, $max:ident, $scale:ident, $cmp:ident,
     $blend:ident, $getexp:ident, $scalef:ident) => {
        type Scalar = $t;
        const WIDTH: usize = $width;

        #[inline(always)]
        fn splat(value: $t) -> Self {
            // SAFETY: AVX-512 is there, see `Lanes`; so in every method.
            $wrap(unsafe { $set1(value) })
        }
        #[inline(always)]
        fn load(from: &[$t; LANES], part: usize) -> Self {
            let from = &from[part * $width..(part + 1) * $width];
            // SAFETY: the slice holds as many lanes as are read.
            $wrap(unsafe { $loadu(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [$t; LANES], part: usize) {
            let to = &mut to[part * $width..(part + 1) * $width];
            // SAFETY: the slice holds as many lanes as are written.
            unsafe { $storeu(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $add(self.0, other.0) })
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $sub(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $mul(self.0, other.0) })
        }
        #[inline(always)]
        fn div(self, other: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $div(self.0, other.0) })
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, addend: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $fmadd(self.0, factor.0, addend.0) })
        }
        #[inline(always)]
        fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $fnmadd(self.0, factor.0, addend.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $sqrt(self.0) })
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $min(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $max(self.0, other.0) })
        }
        #[inline(always)]
        fn floor(self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $scale::<{ _MM_FROUND_TO_NEG_INF }>(self.0) })
        }
        #[inline(always)]
        fn where_less(self, bound: Self, below: Self, otherwise: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $blend($cmp::<_CMP_LT_OQ>(self.0, bound.0), otherwise.0, below.0) })
        }
        #[inline(always)]
        fn any_less(self, bound: Self) -> bool {
            // SAFETY: as in `splat`.
            unsafe { $cmp::<_CMP_LT_OQ>(self.0, bound.0) != 0 }
        }
        #[inline(always)]
        fn pow2(self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $scalef($set1(1.0), self.0) })
        }
        #[inline(always)]
        fn exponent(self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $getexp(self.0) })
        }
    };
}

impl Lanes for F32x16 {
    arithmetic!(
        F32x16,
        f32,
        16,
        _mm512_set1_ps,
        _mm512_loadu_ps,
        _mm512_storeu_ps,
        _mm512_add_ps,
        _mm512_sub_ps,
        _mm512_mul_ps,
        _mm512_div_ps,
        _mm512_fmadd_ps,
        _mm512_fnmadd_ps,
        _mm512_sqrt_ps,
        _mm512_min_ps,
        _mm512_max_ps,
        _mm512_roundscale_ps,
        _mm512_cmp_ps_mask,
        _mm512_mask_blend_ps,
        _mm512_getexp_ps,
        _mm512_scalef_ps
    );

    #[inline(always)]
    fn sum_rows(rows: &[Block<f32>], out: &mut [f32]) {
        // SAFETY: as in `splat`; a row holds the lanes that are read.
        unsafe {
            sum_rows_of_eight(rows, out, |row| {
                _mm256_add_ps(_mm256_loadu_ps(row.as_ptr()), _mm256_loadu_ps(row.as_ptr().add(8)))
            });
        }
    }
    #[inline(always)]
    fn select_from(self, table: &[f32; 16]) -> Self {
        // SAFETY: as in `splat`; the table fills the register.
        F32x16(unsafe { _mm512_permutexvar_ps(_mm512_cvtps_epi32(self.0), _mm512_loadu_ps(table.as_ptr())) })
    }
}

impl Lanes for F64x8 {
    arithmetic!(
        F64x8,
        f64,
        8,
        _mm512_set1_pd,
        _mm512_loadu_pd,
        _mm512_storeu_pd,
        _mm512_add_pd,
        _mm512_sub_pd,
        _mm512_mul_pd,
        _mm512_div_pd,
        _mm512_fmadd_pd,
        _mm512_fnmadd_pd,
        _mm512_sqrt_pd,
        _mm512_min_pd,
        _mm512_max_pd,
        _mm512_roundscale_pd,
        _mm512_cmp_pd_mask,
        _mm512_mask_blend_pd,
        _mm512_getexp_pd,
        _mm512_scalef_pd
    );

    #[inline(always)]
    fn select_from(self, table: &[f64; 16]) -> Self {
        // SAFETY: as in `splat`; the table fills two registers.
        unsafe {
            let index = _mm512_cvtepi32_epi64(_mm512_cvtpd_epi32(self.0));
            let (low, high) = (_mm512_loadu_pd(table.as_ptr()), _mm512_loadu_pd(table.as_ptr().add(8)));
            F64x8(_mm512_permutex2var_pd(low, index, high))
        }
    }
}
