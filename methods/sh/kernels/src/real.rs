//! The two scalar types of the crate.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Closes [`Real`] to other types and names the vector types of each.
mod sealed {
    use crate::kernels::Kernels;
    use crate::simd::Lanes;
    #[cfg(target_arch = "x86_64")]
    use crate::simd::{F32x8, F32x16, F64x4, F64x8};

    pub trait Sealed: Kernels {
        type Portable: Lanes<Scalar = Self>;
        /// The tables of this precision.
        fn table<const K: usize, const P: usize>(
            single: &'static [[f32; K]; P],
            double: &'static [[f64; K]; P],
        ) -> &'static [[Self; K]; P];
        #[cfg(target_arch = "x86_64")]
        type Avx2: Lanes<Scalar = Self>;
        #[cfg(target_arch = "x86_64")]
        type Avx512: Lanes<Scalar = Self>;
    }

    impl Sealed for f32 {
        type Portable = Self;
        #[inline(always)]
        fn table<const K: usize, const P: usize>(
            single: &'static [[f32; K]; P],
            _double: &'static [[f64; K]; P],
        ) -> &'static [[Self; K]; P] {
            single
        }
        #[cfg(target_arch = "x86_64")]
        type Avx2 = F32x8;
        #[cfg(target_arch = "x86_64")]
        type Avx512 = F32x16;
    }

    impl Sealed for f64 {
        type Portable = Self;
        #[inline(always)]
        fn table<const K: usize, const P: usize>(
            _single: &'static [[f32; K]; P],
            double: &'static [[f64; K]; P],
        ) -> &'static [[Self; K]; P] {
            double
        }
        #[cfg(target_arch = "x86_64")]
        type Avx2 = F64x4;
        #[cfg(target_arch = "x86_64")]
        type Avx512 = F64x8;
    }
}

pub(crate) use sealed::Sealed as Precision;

/// A floating-point scalar: `f32` or `f64`.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;

    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;
    /// The value as `f64`, exact.
    fn to_f64(self) -> f64;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// The absolute value.
    fn abs(self) -> Self;
    /// The smaller value; the other one if one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger value; the other one if one is NaN.
    fn max(self, other: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

macro_rules! real {
    ($t:ty) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = <$t>::EPSILON;

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                self.sin_cos()
            }
            #[inline]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                self.min(other)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                self.max(other)
            }
            #[inline]
            fn is_finite(self) -> bool {
                self.is_finite()
            }
        }
    };
}

real!(f32);
real!(f64);
