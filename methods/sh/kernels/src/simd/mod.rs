//! Vectors of lanes in registers, and the choice of the instruction set at run time.
//!
//! A kernel is a [`Task`]: generic code over [`Lanes`], compiled once for each instruction set and for plain scalars. The
//! scalar instance is the twin that tests hold the others against.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

#[cfg(target_arch = "x86_64")]
pub(crate) use {
    avx2::{F32x8, F64x4},
    avx512::{F32x16, F64x8},
};

use std::sync::atomic::{AtomicU8, Ordering};

use crate::block::Block;
use crate::real::Real;

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// Scalar code that runs everywhere, with sums and products rounded apart.
    Portable,
    /// 256-bit vectors with fused multiply-add.
    Avx2,
    /// 512-bit vectors.
    Avx512,
}

impl Simd {
    /// All instruction sets, the widest last.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The widest that this machine has, or, if the environment's `HALFLIGHT_SIMD` names a narrower one (`portable`, `avx2`, `avx512`) when the
    /// program first asks, that.
    #[inline]
    pub fn best() -> Self {
        static BEST: AtomicU8 = AtomicU8::new(u8::MAX);
        let known = BEST.load(Ordering::Relaxed);
        Self::ALL.get(usize::from(known)).copied().unwrap_or_else(|| {
            let found = Self::widest();
            BEST.store(found as u8, Ordering::Relaxed);
            found
        })
    }

    #[cold]
    fn widest() -> Self {
        let asked = std::env::var("HALFLIGHT_SIMD").ok().and_then(|name| Self::named(&name)).unwrap_or(Self::Avx512);
        let mut sets = Self::ALL.into_iter().rev().filter(|simd| *simd <= asked);
        sets.find(|simd| simd.is_detected()).unwrap_or(Self::Portable)
    }

    fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|simd| format!("{simd:?}").eq_ignore_ascii_case(name))
    }

    /// Whether it may be run: this machine has it, and `HALFLIGHT_SIMD` does not leave it out.
    #[inline]
    pub fn is_available(self) -> bool {
        self <= Self::best()
    }

    fn is_detected(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => is_x86_feature_detected!("avx512f") && Self::Avx2.is_detected(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}

/// Some lanes of one scalar type in a register.
///
/// The types other than scalars may be used only inside [`run`], which has made sure that the machine has their
/// instructions: that is what the `unsafe` blocks of their methods rely on.
pub trait Lanes: Copy + 'static {
    /// The type of a lane.
    type Scalar: Real;
    /// The number of lanes, a divisor of [`LANES`](crate::LANES).
    const WIDTH: usize;
    /// Coefficients that a transpose moves at a time.
    const TILE: usize;

    /// All lanes the same.
    fn splat(value: Self::Scalar) -> Self;
    /// The lanes `part·WIDTH..(part + 1)·WIDTH` of 16.
    fn load(from: &[Self::Scalar; crate::LANES], part: usize) -> Self;
    /// Writes the lanes `part·WIDTH..(part + 1)·WIDTH` of 16.
    fn store(self, to: &mut [Self::Scalar; crate::LANES], part: usize);
    /// `self + other`.
    fn add(self, other: Self) -> Self;
    /// `self - other`.
    fn sub(self, other: Self) -> Self;
    /// `self·other`.
    fn mul(self, other: Self) -> Self;
    /// `self/other`.
    fn div(self, other: Self) -> Self;
    /// `self·factor + addend`, rounded once where the machine can.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `addend - self·factor`, rounded once where the machine can.
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// `1/√self` of a positive normal number, to four roundings; on some machines far quicker than a root and a quotient.
    fn rsqrt(self) -> Self;
    /// The smaller one; `other` if either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger one; `other` if either is NaN.
    fn max(self, other: Self) -> Self;
    /// The largest integer that is not above.
    fn floor(self) -> Self;
    /// `2^self` of an integer within the exponents of normal numbers.
    fn pow2(self) -> Self;
    /// `⌊log2 self⌋` of a positive normal number.
    fn exponent(self) -> Self;
    /// In each lane `below` where `self < bound`, else `otherwise`.
    fn where_less(self, bound: Self, below: Self, otherwise: Self) -> Self;
    /// The first lane.
    fn first(self) -> Self::Scalar;
    /// Whether `self < bound` in any lane.
    fn any_less(self, bound: Self) -> bool;
    /// In each lane the entry of `table` whose number, 0 to 15, `self` is.
    fn select_from(self, table: &[Self::Scalar; 16]) -> Self;

    /// A tile of `WIDTH` vectors, `stride` apart, and `TILE` coefficients to blocks.
    fn transpose_in(from: &[Self::Scalar], stride: usize, to: &mut [Block<Self::Scalar>], part: usize);
    /// The inverse.
    fn transpose_out(from: &[Block<Self::Scalar>], part: usize, to: &mut [Self::Scalar], stride: usize);

    /// Writes the sum of the first `WIDTH` lanes of each row.
    #[inline(always)]
    fn sum_rows(rows: &[Block<Self::Scalar>], out: &mut [Self::Scalar]) {
        for (row, out) in rows.iter().zip(out) {
            *out = row.0[..Self::WIDTH].iter().fold(Self::Scalar::ZERO, |sum, &lane| sum + lane);
        }
    }

    /// All lanes the same.
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::splat(Self::Scalar::from_f64(value))
    }

    /// `1/√self` from an estimate, by a step of Newton's: an error of e leaves one of 1.5·e².
    #[inline(always)]
    fn refine_rsqrt(self, estimate: Self) -> Self {
        let square = self.mul(estimate).mul(estimate);
        estimate.mul(square.neg_mul_add(Self::constant(0.5), Self::constant(1.5)))
    }

    /// The magnitude.
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(Self::constant(0.0).sub(self))
    }
}

/// A computation that is generic over the instruction set.
pub trait Task<T: Real> {
    /// Runs on lanes of a type. Implementations are `#[inline(always)]`, so that they are compiled for its instructions, and
    /// do without closures in what is hot: one that the compiler does not inline is not.
    fn run<V: Lanes<Scalar = T>>(self);
}

/// Runs a task on an instruction set.
///
/// # Panics
/// If it is not available.
#[inline]
pub fn run<T: Real>(simd: Simd, task: impl Task<T>) {
    assert!(simd.is_available(), "{simd:?} instructions are not available on this machine");
    match simd {
        Simd::Portable => run_portable(task),
        #[cfg(target_arch = "x86_64")]
        Simd::Avx2 => {
            // SAFETY: the machine has the instructions, as asserted: all that are narrower than the best.
            unsafe { run_avx2(task) }
        }
        #[cfg(target_arch = "x86_64")]
        Simd::Avx512 => {
            // SAFETY: as above.
            unsafe { run_avx512(task) }
        }
        #[cfg(not(target_arch = "x86_64"))]
        _ => unreachable!("not available on this machine"),
    }
}

/// Apart, so that what it needs of the stack does not burden the others.
#[inline(never)]
fn run_portable<T: Real>(task: impl Task<T>) {
    task.run::<T::Portable>();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<T: Real>(task: impl Task<T>) {
    task.run::<T::Avx2>();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn run_avx512<T: Real>(task: impl Task<T>) {
    task.run::<T::Avx512>();
}
