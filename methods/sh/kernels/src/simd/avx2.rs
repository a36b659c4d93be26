//! 256-bit vectors.

use std::arch::x86_64::*;

use super::Lanes;
use crate::LANES;
use crate::block::Block;

/// Eight `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct F32x8(__m256);

/// Four `f64`.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct F64x4(__m256d);

/// The methods that differ between the two types by the intrinsics' suffix alone.
macro_rules! arithmetic {
    ($wrap:ident, $t:ty, $width:literal, $set1:ident, $loadu:ident, $storeu:ident, $add:ident, $sub:ident, $mul:ident,
     $div:ident, $fmadd:ident, $fnmadd:ident, $sqrt:ident, $min:ident, $max:ident, $floor:ident, $cmp:ident, $blendv:ident,
     $movemask:ident, $first:ident) => {
        type Scalar = $t;
        const WIDTH: usize = $width;
        const TILE: usize = $width;

        #[inline(always)]
        fn splat(value: $t) -> Self {
            // SAFETY: AVX2 is there, see `Lanes`; so in every method.
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
            $wrap(unsafe { $floor(self.0) })
        }
        #[inline(always)]
        fn where_less(self, bound: Self, below: Self, otherwise: Self) -> Self {
            // SAFETY: as in `splat`.
            $wrap(unsafe { $blendv(otherwise.0, below.0, $cmp::<_CMP_LT_OQ>(self.0, bound.0)) })
        }
        #[inline(always)]
        fn first(self) -> $t {
            // SAFETY: as in `splat`.
            unsafe { $first(self.0) }
        }
        #[inline(always)]
        fn any_less(self, bound: Self) -> bool {
            // SAFETY: as in `splat`.
            unsafe { $movemask($cmp::<_CMP_LT_OQ>(self.0, bound.0)) != 0 }
        }
    };
}

/// Transposes eight rows of eight lanes.
#[inline]
#[target_feature(enable = "avx2")]
fn transpose_eight(rows: [__m256; 8]) -> [__m256; 8] {
    let [a, b, c, d, e, f, g, h] = rows;
    let pairs = [
        (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b)),
        (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d)),
        (_mm256_unpacklo_ps(e, f), _mm256_unpackhi_ps(e, f)),
        (_mm256_unpacklo_ps(g, h), _mm256_unpackhi_ps(g, h)),
    ];
    // columns (0, 4), (1, 5), (2, 6), (3, 7) of four rows each
    let fours = |x: (__m256, __m256), y: (__m256, __m256)| {
        [
            _mm256_shuffle_ps::<0x44>(x.0, y.0),
            _mm256_shuffle_ps::<0xee>(x.0, y.0),
            _mm256_shuffle_ps::<0x44>(x.1, y.1),
            _mm256_shuffle_ps::<0xee>(x.1, y.1),
        ]
    };
    let (upper, lower) = (fours(pairs[0], pairs[1]), fours(pairs[2], pairs[3]));
    let low = |i: usize| _mm256_permute2f128_ps::<0x20>(upper[i], lower[i]);
    let high = |i: usize| _mm256_permute2f128_ps::<0x31>(upper[i], lower[i]);
    [low(0), low(1), low(2), low(3), high(0), high(1), high(2), high(3)]
}

/// Transposes four rows of four lanes.
#[inline]
#[target_feature(enable = "avx2")]
fn transpose_four([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    let (ab0, ab1) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    let (cd0, cd1) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
    [
        _mm256_permute2f128_pd::<0x20>(ab0, cd0),
        _mm256_permute2f128_pd::<0x20>(ab1, cd1),
        _mm256_permute2f128_pd::<0x31>(ab0, cd0),
        _mm256_permute2f128_pd::<0x31>(ab1, cd1),
    ]
}

/// The two transposes of a type from the one in registers.
macro_rules! transposes {
    ($wrap:ident, $t:ty, $width:literal, $loadu:ident, $storeu:ident, $transpose:ident) => {
        #[inline(always)]
        fn transpose_in(from: &[$t], stride: usize, to: &mut [Block<$t>], part: usize) {
            let mut rows = [Self::splat(0.0).0; $width];
            for (lane, row) in rows.iter_mut().enumerate() {
                let from = &from[lane * stride..][..$width];
                // SAFETY: the slice holds as many lanes as are read.
                *row = unsafe { $loadu(from.as_ptr()) };
            }
            // SAFETY: as in `splat`.
            let columns = unsafe { $transpose(rows) };
            for (block, column) in to[..$width].iter_mut().zip(columns) {
                $wrap(column).store(&mut block.0, part);
            }
        }
        #[inline(always)]
        fn transpose_out(from: &[Block<$t>], part: usize, to: &mut [$t], stride: usize) {
            let mut columns = [Self::splat(0.0).0; $width];
            for (column, block) in columns.iter_mut().zip(&from[..$width]) {
                *column = Self::load(&block.0, part).0;
            }
            // SAFETY: as in `splat`.
            let rows = unsafe { $transpose(columns) };
            for (lane, row) in rows.into_iter().enumerate() {
                let to = &mut to[lane * stride..][..$width];
                // SAFETY: the slice holds as many lanes as are written.
                unsafe { $storeu(to.as_mut_ptr(), row) }
            }
        }
    };
}

/// The sums of eight rows of eight lanes.
#[inline]
#[target_feature(enable = "avx2")]
fn sum_eight(rows: [__m256; 8]) -> __m256 {
    let [a, b, c, d, e, f, g, h] = rows;
    let low = _mm256_hadd_ps(_mm256_hadd_ps(a, b), _mm256_hadd_ps(c, d));
    let high = _mm256_hadd_ps(_mm256_hadd_ps(e, f), _mm256_hadd_ps(g, h));
    // each 128-bit half of `low` holds half of the sums of a to d, of `high` those of e to h
    _mm256_add_ps(_mm256_permute2f128_ps::<0x20>(low, high), _mm256_permute2f128_ps::<0x31>(low, high))
}

/// Writes the sums of rows that `load` yields, eight at a time.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn sum_rows_of_eight(rows: &[Block<f32>], out: &mut [f32], load: impl Fn(&[f32; LANES]) -> __m256) {
    for (rows, out) in rows.chunks(8).zip(out.chunks_mut(8)) {
        let row = |i: usize| load(&rows[i.min(rows.len() - 1)].0);
        let sums = sum_eight([row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7)]);
        if let Ok(out) = <&mut [f32; 8]>::try_from(&mut *out) {
            // SAFETY: the array holds as many lanes as are written.
            unsafe { _mm256_storeu_ps(out.as_mut_ptr(), sums) }
        } else {
            let mut all = [0.0; 8];
            // SAFETY: as above.
            unsafe { _mm256_storeu_ps(all.as_mut_ptr(), sums) }
            out.copy_from_slice(&all[..out.len()]);
        }
    }
}

impl Lanes for F32x8 {
    arithmetic!(
        F32x8,
        f32,
        8,
        _mm256_set1_ps,
        _mm256_loadu_ps,
        _mm256_storeu_ps,
        _mm256_add_ps,
        _mm256_sub_ps,
        _mm256_mul_ps,
        _mm256_div_ps,
        _mm256_fmadd_ps,
        _mm256_fnmadd_ps,
        _mm256_sqrt_ps,
        _mm256_min_ps,
        _mm256_max_ps,
        _mm256_floor_ps,
        _mm256_cmp_ps,
        _mm256_blendv_ps,
        _mm256_movemask_ps,
        _mm256_cvtss_f32
    );

    #[inline(always)]
    fn rsqrt(self) -> Self {
        // SAFETY: as in `splat`.
        self.refine_rsqrt(F32x8(unsafe { _mm256_rsqrt_ps(self.0) }))
    }

    #[inline(always)]
    fn pow2(self) -> Self {
        // SAFETY: as in `splat`.
        unsafe {
            let biased = _mm256_add_epi32(_mm256_cvtps_epi32(self.0), _mm256_set1_epi32(127));
            F32x8(_mm256_castsi256_ps(_mm256_slli_epi32::<23>(biased)))
        }
    }
    #[inline(always)]
    fn exponent(self) -> Self {
        // SAFETY: as in `splat`.
        unsafe {
            let biased = _mm256_srli_epi32::<23>(_mm256_castps_si256(self.0));
            F32x8(_mm256_cvtepi32_ps(_mm256_sub_epi32(biased, _mm256_set1_epi32(127))))
        }
    }
    transposes!(F32x8, f32, 8, _mm256_loadu_ps, _mm256_storeu_ps, transpose_eight);

    #[inline(always)]
    fn sum_rows(rows: &[Block<f32>], out: &mut [f32]) {
        // SAFETY: as in `splat`; a row holds more lanes than are read.
        unsafe { sum_rows_of_eight(rows, out, |row| _mm256_loadu_ps(row.as_ptr())) }
    }
    #[inline(always)]
    fn select_from(self, table: &[f32; 16]) -> Self {
        // SAFETY: as in `splat`; the table holds both halves.
        unsafe {
            let index = _mm256_cvtps_epi32(self.0);
            let low = _mm256_permutevar8x32_ps(_mm256_loadu_ps(table.as_ptr()), index);
            let high = _mm256_permutevar8x32_ps(_mm256_loadu_ps(table.as_ptr().add(8)), index);
            // bit 3 of the number, moved to the sign, picks the half
            let half = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(index));
            F32x8(_mm256_blendv_ps(low, high, half))
        }
    }
}

impl Lanes for F64x4 {
    arithmetic!(
        F64x4,
        f64,
        4,
        _mm256_set1_pd,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_add_pd,
        _mm256_sub_pd,
        _mm256_mul_pd,
        _mm256_div_pd,
        _mm256_fmadd_pd,
        _mm256_fnmadd_pd,
        _mm256_sqrt_pd,
        _mm256_min_pd,
        _mm256_max_pd,
        _mm256_floor_pd,
        _mm256_cmp_pd,
        _mm256_blendv_pd,
        _mm256_movemask_pd,
        _mm256_cvtsd_f64
    );

    #[inline(always)]
    fn rsqrt(self) -> Self {
        Self::constant(1.0).div(self.sqrt())
    }
    transposes!(F64x4, f64, 4, _mm256_loadu_pd, _mm256_storeu_pd, transpose_four);

    #[inline(always)]
    fn pow2(self) -> Self {
        // SAFETY: as in `splat`.
        unsafe {
            let biased = _mm256_add_epi64(_mm256_cvtepi32_epi64(_mm256_cvtpd_epi32(self.0)), _mm256_set1_epi64x(1023));
            F64x4(_mm256_castsi256_pd(_mm256_slli_epi64::<52>(biased)))
        }
    }
    #[inline(always)]
    fn exponent(self) -> Self {
        // SAFETY: as in `splat`.
        unsafe {
            // The biased exponent below the mantissa of 2^52: as a number it is 2^52 more.
            let biased = _mm256_srli_epi64::<52>(_mm256_castpd_si256(self.0));
            let shift = _mm256_set1_pd(4_503_599_627_370_496.0);
            let number = _mm256_castsi256_pd(_mm256_or_si256(biased, _mm256_castpd_si256(shift)));
            F64x4(_mm256_sub_pd(number, _mm256_set1_pd(4_503_599_627_370_496.0 + 1023.0)))
        }
    }
    #[inline(always)]
    fn select_from(self, table: &[f64; 16]) -> Self {
        // SAFETY: as in `splat`; the mask keeps the numbers within the table.
        unsafe {
            let index = _mm_and_si128(_mm256_cvtpd_epi32(self.0), _mm_set1_epi32(15));
            F64x4(_mm256_i32gather_pd::<8>(table.as_ptr(), index))
        }
    }
}
