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
     $blend:ident, $getexp:ident, $scalef:ident, $first:ident, $half_load:ident, $half_store:ident, $low:ident,
     $insert:ident, $extract:ident, $transpose:ident) => {
        type Scalar = $t;
        const WIDTH: usize = $width;
        const TILE: usize = $width / 2;

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
        fn first(self) -> $t {
            // SAFETY: as in `splat`.
            unsafe { $first(self.0) }
        }
        #[inline(always)]
        fn transpose_in(from: &[$t], stride: usize, to: &mut [Block<$t>], part: usize) {
            // Row `i` holds vector `i` in its low half and vector `i + TILE` in its high one.
            let mut rows = [Self::splat(0.0).0; $width / 2];
            for (lane, row) in rows.iter_mut().enumerate() {
                let low = &from[lane * stride..][..Self::TILE];
                let high = &from[(lane + Self::TILE) * stride..][..Self::TILE];
                // SAFETY: the slices hold as many lanes as are read.
                *row = unsafe { $insert::<1>($low($half_load(low.as_ptr())), $half_load(high.as_ptr())) };
            }
            // SAFETY: as in `splat`.
            let columns = unsafe { $transpose(rows) };
            for (block, column) in to[..Self::TILE].iter_mut().zip(columns) {
                $wrap(column).store(&mut block.0, part);
            }
        }
        #[inline(always)]
        fn transpose_out(from: &[Block<$t>], part: usize, to: &mut [$t], stride: usize) {
            let mut columns = [Self::splat(0.0).0; $width / 2];
            for (column, block) in columns.iter_mut().zip(&from[..Self::TILE]) {
                *column = Self::load(&block.0, part).0;
            }
            // SAFETY: as in `splat`.
            let rows = unsafe { $transpose(columns) };
            for (lane, row) in rows.into_iter().enumerate() {
                let low = &mut to[lane * stride..][..Self::TILE];
                // SAFETY: the slice holds as many lanes as are written.
                unsafe { $half_store(low.as_mut_ptr(), $extract::<0>(row)) }
                let high = &mut to[(lane + Self::TILE) * stride..][..Self::TILE];
                // SAFETY: as above.
                unsafe { $half_store(high.as_mut_ptr(), $extract::<1>(row)) }
            }
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

/// Replaces a half; the instruction for `f32` needs AVX-512DQ.
#[inline]
#[target_feature(enable = "avx512f")]
fn insert_half<const HALF: i32>(into: __m512, half: __m256) -> __m512 {
    _mm512_castpd_ps(_mm512_insertf64x4::<HALF>(_mm512_castps_pd(into), _mm256_castps_pd(half)))
}

#[inline]
#[target_feature(enable = "avx512f")]
fn extract_half<const HALF: i32>(from: __m512) -> __m256 {
    _mm256_castpd_ps(_mm512_extractf64x4_pd::<HALF>(_mm512_castps_pd(from)))
}

/// In each half the first, or the second, quarter of `low`, then that of `high`.
#[inline]
#[target_feature(enable = "avx512f")]
fn quarters<const SECOND: i64>(low: __m512d, high: __m512d) -> __m512d {
    let s = 2 * SECOND;
    _mm512_permutex2var_pd(low, _mm512_setr_epi64(s, s + 1, s + 8, s + 9, s + 4, s + 5, s + 12, s + 13), high)
}

/// Transposes eight rows of eight lanes in each half.
#[inline]
#[target_feature(enable = "avx512f")]
fn transpose_halves_of_eight([a, b, c, d, e, f, g, h]: [__m512; 8]) -> [__m512; 8] {
    // columns (0, 4), (1, 5), (2, 6), (3, 7) of four rows
    let four = |a: __m512, b: __m512, c: __m512, d: __m512| {
        let pairs = |a, b| [_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b)].map(|pair| _mm512_castps_pd(pair));
        let ([ab0, ab1], [cd0, cd1]) = (pairs(a, b), pairs(c, d));
        [
            _mm512_unpacklo_pd(ab0, cd0),
            _mm512_unpackhi_pd(ab0, cd0),
            _mm512_unpacklo_pd(ab1, cd1),
            _mm512_unpackhi_pd(ab1, cd1),
        ]
    };
    let (upper, lower) = (four(a, b, c, d), four(e, f, g, h));
    let column = |i: usize| match i {
        0..4 => _mm512_castpd_ps(quarters::<0>(upper[i], lower[i])),
        _ => _mm512_castpd_ps(quarters::<1>(upper[i - 4], lower[i - 4])),
    };
    [column(0), column(1), column(2), column(3), column(4), column(5), column(6), column(7)]
}

/// Transposes four rows of four lanes in each half.
#[inline]
#[target_feature(enable = "avx512f")]
fn transpose_halves_of_four([a, b, c, d]: [__m512d; 4]) -> [__m512d; 4] {
    let (ab0, ab1) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
    let (cd0, cd1) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
    [quarters::<0>(ab0, cd0), quarters::<0>(ab1, cd1), quarters::<1>(ab0, cd0), quarters::<1>(ab1, cd1)]
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
        _mm512_scalef_ps,
        _mm512_cvtss_f32,
        _mm256_loadu_ps,
        _mm256_storeu_ps,
        _mm512_castps256_ps512,
        insert_half,
        extract_half,
        transpose_halves_of_eight
    );

    #[inline(always)]
    fn rsqrt(self) -> Self {
        // SAFETY: as in `splat`.
        self.refine_rsqrt(F32x16(unsafe { _mm512_rsqrt14_ps(self.0) }))
    }

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
        _mm512_scalef_pd,
        _mm512_cvtsd_f64,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm512_castpd256_pd512,
        _mm512_insertf64x4,
        _mm512_extractf64x4_pd,
        transpose_halves_of_four
    );

    #[inline(always)]
    fn rsqrt(self) -> Self {
        Self::constant(1.0).div(self.sqrt())
    }

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
