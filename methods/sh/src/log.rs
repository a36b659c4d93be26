//! The SH logarithm of a visibility vector (Ren 2006, §5).

use std::sync::LazyLock;

use crate::basis::evaluate;
use crate::eigen::SymmetricEigen;
use crate::gamma::gamma;
use crate::order::{MAX_COEFFICIENTS, SQRT_4_PI, assert_vector, coefficients};
use crate::quadrature::{Quadrature, project};

/// Eigenvalues below this part of the largest one are raised to it before the logarithm (Ren 2006, after eq. 32).
pub const EIGENVALUE_CLIP: f64 = 0.02;

/// Polynomial degree of the rule for functions that are no polynomials: logarithms and exponentials of vectors.
const SMOOTH_DEGREE: usize = 127;

/// The quadrature for integrands that are smooth or at least continuous, but no polynomials.
pub(crate) static SMOOTH: LazyLock<Quadrature> = LazyLock::new(|| Quadrature::exact(SMOOTH_DEGREE));

/// The naive logarithm, `∫ log(max(g(s), ε)) y(s) ds` (Ren 2006, eq. 25), by quadrature of degree 127.
///
/// Where the clip acts the integrand has a kink, and coefficients are good to about 1e-3; elsewhere to rounding.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER) or a slice does not hold `n²` coefficients.
pub fn log_naive(order: usize, g: &[f64], epsilon: f64, out: &mut [f64]) {
    assert_vector(order, g);
    assert_vector(order, out);
    out.copy_from_slice(&project(order, &SMOOTH, |s| reconstruct(order, g, s).max(epsilon).ln()));
}

/// The value `Σ g_i y_i(s)` of a vector in direction `s` (Ren 2006, eq. 2).
pub(crate) fn reconstruct(order: usize, g: &[f64], s: [f64; 3]) -> f64 {
    let mut basis = [0.0; MAX_COEFFICIENTS];
    let basis = &mut basis[..coefficients(order)];
    evaluate(order, s, basis);
    basis.iter().zip(g).map(|(y, c)| y * c).sum()
}

/// The logarithm that inverts the truncated exponential, `Rᵀ q'(D̃) R (g - 1)` from the eigenanalysis of `g`'s product
/// matrix with its eigenvalues clipped at [`EIGENVALUE_CLIP`] of the largest (Ren 2006, eqs. 30–32).
///
/// `g` must be finite and its largest eigenvalue positive, which holds wherever the mean of `g` is positive.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER) or a slice does not hold `n²` coefficients.
pub fn log_eigen(order: usize, g: &[f64], out: &mut [f64]) {
    assert_vector(order, g);
    assert_vector(order, out);
    let size = coefficients(order);
    let mut matrix = vec![0.0; size * size];
    gamma(order).product_matrix(g, &mut matrix);
    let mut eigen = SymmetricEigen::new();
    eigen.decompose(size, &matrix);
    let floor = EIGENVALUE_CLIP * eigen.largest();
    out.copy_from_slice(g);
    out[0] -= SQRT_4_PI;
    eigen.apply(out, |value| log_quotient(value.max(floor)));
}

/// `q'(x) = log x/(x - 1)` (Ren 2006, eq. 31) with its limit 1 at `x = 1`.
pub(crate) fn log_quotient(x: f64) -> f64 {
    let above = x - 1.0;
    if above == 0.0 { 1.0 } else { above.ln_1p() / above }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotient_is_smooth_through_one() {
        assert_eq!(log_quotient(1.0), 1.0);
        for delta in [1e-16, 1e-12, 1e-8, 1e-4] {
            for x in [1.0 - delta, 1.0 + delta] {
                assert!((log_quotient(x) - (1.0 - 0.5 * (x - 1.0))).abs() < 1e-8, "q'({x})");
            }
        }
        assert!((log_quotient(2.0) - 2f64.ln()).abs() < 1e-15);
        assert!((log_quotient(0.02) - 0.02f64.ln() / -0.98).abs() < 1e-15);
    }

    #[test]
    fn both_logarithms_of_a_constant_are_constant() {
        for order in 1..=crate::MAX_ORDER {
            let mut g = vec![0.0; coefficients(order)];
            g[0] = 0.3 * SQRT_4_PI;
            let mut out = g.clone();
            for naive in [true, false] {
                if naive {
                    log_naive(order, &g, 1e-3, &mut out)
                } else {
                    log_eigen(order, &g, &mut out)
                }
                assert!((out[0] - 0.3f64.ln() * SQRT_4_PI).abs() < 1e-12);
                assert!(out[1..].iter().all(|v| v.abs() < 1e-12));
            }
        }
    }

    #[test]
    fn naive_clip_bounds_the_logarithm_of_nothing() {
        let mut out = [0.0; 16];
        log_naive(4, &[0.0; 16], 0.01, &mut out);
        assert!((out[0] - 0.01f64.ln() * SQRT_4_PI).abs() < 1e-12);
    }
}
