//! The same loops compiled twice: for every machine, and for one with AVX2 and fused multiply-add.

/// Arithmetic of loops, generic so that they can be compiled with and without fused multiply-add.
pub(crate) trait Level {
    /// `a·b + c`.
    fn mul_add<T: Scalar>(a: T, b: T, c: T) -> T;
}

/// Rounded twice.
pub(crate) struct Plain;
/// Rounded once.
pub(crate) struct Fused;

impl Level for Plain {
    #[inline(always)]
    fn mul_add<T: Scalar>(a: T, b: T, c: T) -> T {
        a * b + c
    }
}

impl Level for Fused {
    #[inline(always)]
    fn mul_add<T: Scalar>(a: T, b: T, c: T) -> T {
        a.fused(b, c)
    }
}

/// `f32` and `f64`.
pub trait Scalar: rustfft::FftNum + Default + std::ops::AddAssign + std::ops::MulAssign {
    /// 0.
    const ZERO: Self;
    /// The nearest value of this type.
    fn of(value: f64) -> Self;
    /// The value as `f64`, exact.
    fn wide(self) -> f64;
    /// `self·b + c`, rounded once.
    fn fused(self, b: Self, c: Self) -> Self;
}

macro_rules! scalar {
    ($t:ty) => {
        impl Scalar for $t {
            const ZERO: Self = 0.0;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn wide(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn fused(self, b: Self, c: Self) -> Self {
                self.mul_add(b, c)
            }
        }
    };
}

scalar!(f32);
scalar!(f64);

/// A loop.
pub(crate) trait Loop {
    /// Runs it; implementations are `#[inline(always)]`.
    fn run<L: Level>(self);
}

/// Runs a loop by the best instructions that it is compiled for.
pub(crate) fn run(task: impl Loop) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2,fma")]
        fn wide(task: impl Loop) {
            task.run::<Fused>();
        }
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            // SAFETY: the machine has the instructions, as was just found.
            unsafe { wide(task) };
            return;
        }
    }
    task.run::<Plain>();
}
