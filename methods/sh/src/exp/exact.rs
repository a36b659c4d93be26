//! The numerically exact exponential.

use super::LARGEST;
use crate::log::{SMOOTH, reconstruct};
use crate::order::assert_vector;
use crate::quadrature::project;

/// The projection of `exp f(s)`, `∫ exp(Σ f_i y_i(s)) y(s) ds` (Ren 2006, eq. 10), by quadrature of degree 127; values
/// above 1e30 count as 1e30. An oracle: thousands of times slower than the variants.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER) or a slice does not hold `n²` coefficients.
pub fn exact(order: usize, f: &[f64], out: &mut [f64]) {
    assert_vector(order, f);
    assert_vector(order, out);
    out.copy_from_slice(&project(order, &SMOOTH, |s| reconstruct(order, f, s).exp().min(LARGEST)));
}
