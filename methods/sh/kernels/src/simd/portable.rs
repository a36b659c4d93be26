//! One lane: the scalar twin of the vector types.

use super::Lanes;
use crate::LANES;
use crate::block::Block;
use crate::real::Real;

macro_rules! scalar {
    ($t:ty, $mantissa:literal, $bias:literal, $bits:ty) => {
        impl Lanes for $t {
            type Scalar = $t;
            const WIDTH: usize = 1;
            const TILE: usize = 1;

            #[inline(always)]
            fn splat(value: $t) -> Self {
                value
            }
            #[inline(always)]
            fn load(from: &[$t; LANES], part: usize) -> Self {
                from[part]
            }
            #[inline(always)]
            fn store(self, to: &mut [$t; LANES], part: usize) {
                to[part] = self;
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                self - other
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                self * other
            }
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                self / other
            }
            // Without the instruction, the fused operation is a call twenty times as slow.
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }
            #[inline(always)]
            fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                addend - self * factor
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Real::sqrt(self)
            }
            #[inline(always)]
            fn rsqrt(self) -> Self {
                1.0 / Real::sqrt(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn floor(self) -> Self {
                <$t>::floor(self)
            }
            #[inline(always)]
            fn pow2(self) -> Self {
                <$t>::from_bits(((self as i32 + $bias) as $bits) << $mantissa)
            }
            #[inline(always)]
            fn exponent(self) -> Self {
                ((self.to_bits() >> $mantissa) as i32 - $bias) as $t
            }
            #[inline(always)]
            fn where_less(self, bound: Self, below: Self, otherwise: Self) -> Self {
                if self < bound { below } else { otherwise }
            }
            #[inline(always)]
            fn first(self) -> $t {
                self
            }
            #[inline(always)]
            fn any_less(self, bound: Self) -> bool {
                self < bound
            }
            #[inline(always)]
            fn select_from(self, table: &[$t; 16]) -> Self {
                table[self as usize & 15]
            }
            #[inline(always)]
            fn transpose_in(from: &[$t], _stride: usize, to: &mut [Block<$t>], part: usize) {
                to[0].0[part] = from[0];
            }
            #[inline(always)]
            fn transpose_out(from: &[Block<$t>], part: usize, to: &mut [$t], _stride: usize) {
                to[0] = from[0].0[part];
            }
        }
    };
}

scalar!(f32, 23, 127, u32);
scalar!(f64, 52, 1023, u64);
