//! The SH exponential, which turns a sum of log visibilities into visibility (Ren 2006, §4), in the paper's variants.
//!
//! | variant | function | truncation |
//! |---|---|---|
//! | PS-p | [`ExpWorkspace::product_series`] | Taylor series of SH products |
//! | PS*-p | [`ExpWorkspace::scaled_series`] | the same after DC isolation and scaling, then squared; factored |
//! | OL | [`ExpWorkspace::optimal_linear`] | `a·1 + b·f`, fitted to circles |
//! | HYB | [`ExpWorkspace::hybrid`] | OL after scaling, then squared |
//! | eigen | [`ExpWorkspace::eigen`] | none: the whole product series |
//! | exact | [`exact()`] | none but the final projection: the oracle of what the variants stand for |
//!
//! # Finite by construction
//!
//! Where many blockers overlap, the product series itself grows beyond every bound (its matrix has eigenvalues above 0,
//! for a product above 1). Intermediate vectors are therefore kept with a separate binary exponent, and a result is
//! scaled so that no coefficient exceeds 1e30: every finite input gives a finite output, which
//! [`project_binary_bound`](crate::project_binary_bound) then brings into range.

mod eigen;
mod exact;
mod linear;
mod series;

use std::f64::consts::LN_2;

pub use exact::exact;
pub(crate) use linear::{linear_pieces, unclipped_norm};

use crate::batch::Batch;
use crate::gamma::{Gamma, gamma};
use crate::order::{SQRT_4_PI, assert_vector, coefficients};
use eigen::EigenScratch;
use halflight_sh_kernels::Real;

/// No coefficient of a result exceeds this.
const LARGEST: f64 = 1e30;

/// The operations that an exponential took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// SH products of two different vectors.
    pub products: u32,
    /// SH squares.
    pub squares: u32,
}

/// How often a scaled exponential is squared: `max(0, ⌊log2 ‖f̂‖ + offset⌋)` times, where `f̂` is the vector without its
/// mean (Ren 2006, after eq. 21). The default offset is the paper's, 3, which scales `‖f̂‖` below 1/4; it is also the least
/// that brings HYB as close to true visibility as it gets at order 4. [`SquaringRule::for_order`] is that for each order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquaringRule {
    /// What is added to the logarithm; higher is more accurate and slower.
    pub offset: f64,
}

impl Default for SquaringRule {
    fn default() -> Self {
        Self { offset: 3.0 }
    }
}

impl SquaringRule {
    /// The least offset whose mean error against the true visibility of circles is within 2% of the least that any has (order
    /// 3: one more than that), as `cargo bench -p halflight-sh --bench squaring` measures it: `⌈order/2⌉ + 1`.
    pub fn for_order(order: usize) -> Self {
        Self { offset: (order.div_ceil(2) + 1) as f64 }
    }

    /// The number of squarings for a vector of norm `norm`, and at least as many as bring the norm down to `limit`.
    fn count(self, norm: f64, limit: f64) -> i32 {
        if norm > 0.0 {
            let forced = (norm / limit).log2().ceil();
            (norm.log2() + self.offset).floor().max(forced).clamp(0.0, 2048.0) as i32
        } else {
            0
        }
    }
}

/// The exponentials of one order with their scratch memory: keep one per thread, calls then allocate nothing (the first
/// call of a variant may).
///
/// All take `n²` coefficients `f`, finite, and write `n²` coefficients.
///
/// # Panics
/// All panic if a slice does not hold `n²` coefficients.
#[derive(Clone, Debug)]
pub struct ExpWorkspace<T> {
    order: usize,
    gamma: &'static Gamma,
    batch: Batch,
    /// The vector to be exponentiated, without its mean and scaled down.
    residual: Vec<T>,
    scratch: Vec<T>,
    /// A running term or sum.
    term: Vec<T>,
    /// Even powers, one after another.
    powers: Vec<T>,
    eigen: EigenScratch,
}

impl<T: Real> ExpWorkspace<T> {
    /// The workspace of an order.
    ///
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
    pub fn new(order: usize) -> Self {
        let gamma = gamma(order);
        let zeros = vec![T::ZERO; coefficients(order)];
        Self {
            order,
            gamma,
            batch: Batch::new(order),
            residual: zeros.clone(),
            scratch: zeros.clone(),
            term: zeros,
            powers: Vec::new(),
            eigen: EigenScratch::default(),
        }
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.order
    }

    /// DC isolation (Ren 2006, eqs. 19–20): stores `f` without its mean and returns the mean value over the sphere and
    /// the norm of the rest.
    fn isolate_mean(&mut self, f: &[T]) -> (f64, f64) {
        assert_vector(self.order, f);
        self.residual.copy_from_slice(f);
        self.residual[0] = T::ZERO;
        (f[0].to_f64() / SQRT_4_PI, norm(&self.residual))
    }

    /// Squares `value` repeatedly (Ren 2006, eq. 21); returns the power of two by which the result is to be multiplied.
    fn square_repeatedly(&mut self, value: &mut [T], count: i32) -> f64 {
        let mut exponent = 0.0;
        for _ in 0..count {
            exponent = 2.0 * (exponent + renormalise(value));
            self.batch.single_square(value, &mut self.scratch);
            value.copy_from_slice(&self.scratch);
        }
        exponent
    }
}

/// The Euclidean norm, finite for every finite vector of `f32` and up to entries of 1e307 in `f64`.
fn norm<T: Real>(vector: &[T]) -> f64 {
    let scaled_by = |factor: f64| vector.iter().map(|v| (v.to_f64() * factor).powi(2)).sum::<f64>();
    let squares = scaled_by(1.0);
    if (1e-280..1e280).contains(&squares) {
        return squares.sqrt();
    }
    // The squares leave the range of f64, or there are none.
    let largest = largest_magnitude(vector).max(f64::MIN_POSITIVE);
    largest * scaled_by(1.0 / largest).sqrt()
}

fn largest_magnitude<T: Real>(vector: &[T]) -> f64 {
    vector.iter().fold(T::ZERO, |largest, v| largest.max(v.abs())).to_f64()
}

/// Multiplies a vector by a power of two, so that rounding is not disturbed.
fn scale_by_power<T: Real>(vector: &mut [T], exponent: i32) {
    let factor = 2f64.powi(exponent);
    vector.iter_mut().for_each(|v| *v = T::from_f64(v.to_f64() * factor));
}

/// If the vector is far from 1 in magnitude, scales it near to it by a power of two; returns the exponent to restore it.
fn renormalise<T: Real>(vector: &mut [T]) -> f64 {
    let largest = largest_magnitude(vector);
    if largest == 0.0 || (1.0 / 65536.0..65536.0).contains(&largest) {
        return 0.0;
    }
    let exponent = largest.log2().floor().clamp(-1000.0, 1000.0);
    scale_by_power(vector, -exponent as i32);
    exponent
}

/// Multiplies a vector by `2^exponent·e^mean`, or by less where a coefficient would exceed [`LARGEST`].
fn restore<T: Real>(vector: &mut [T], exponent: f64, mean: f64) {
    let exponent = exponent + renormalise(vector);
    let largest = largest_magnitude(vector);
    if largest > 0.0 {
        let factor = (exponent * LN_2 + mean).exp().min(LARGEST / largest);
        vector.iter_mut().for_each(|v| *v = T::from_f64(v.to_f64() * factor));
    }
}
