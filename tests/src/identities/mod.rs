//! The identities of spherical harmonics (SH) algebra as a library: whoever has SH code of their own can hold it against them.
//!
//! Implement [`ShOps`] for your code, with as many of its operations as you have, and call [`check`]. The identities do not
//! depend on conventions of sign or order within a band: they need a real basis that is orthonormal over the sphere, with
//! bands one after another (`n²` coefficients for bands `0..n`). Integrals are exact quadratures of this crate's own.
//!
//! ```
//! use halflight_tests::identities::{ShOps, check};
//!
//! struct Mine;
//!
//! impl ShOps for Mine {
//!     fn orders(&self) -> std::ops::RangeInclusive<usize> {
//!         1..=2
//!     }
//!     fn tolerance(&self) -> f64 {
//!         1e-14
//!     }
//!     fn evaluate(&self, order: usize, [x, y, z]: [f64; 3]) -> Vec<f64> {
//!         let (c, k) = (0.282_094_791_773_878_1, 0.488_602_511_902_919_9);
//!         [c, k * y, k * z, k * x][..order * order].to_vec()
//!     }
//! }
//!
//! assert_eq!(check(&Mine), []);
//! ```

mod laws;
mod sphere;
pub mod strategies;

use std::fmt;
use std::ops::RangeInclusive;

use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

pub use sphere::Sphere;

/// A rotation matrix by rows.
pub type Matrix = [[f64; 3]; 3];

/// SH code to be checked. Vectors of order `n` hold `n²` coefficients; what answers `None` is not checked.
pub trait ShOps {
    /// The orders that it supports.
    fn orders(&self) -> RangeInclusive<usize>;
    /// The largest error, relative to the lengths of the vectors that go in (of results, for exponentials), times the order.
    fn tolerance(&self) -> f64;
    /// The basis functions at a unit vector.
    fn evaluate(&self, order: usize, direction: [f64; 3]) -> Vec<f64>;
    /// The product of two functions, truncated to their order.
    fn product(&self, _order: usize, _a: &[f64], _b: &[f64]) -> Option<Vec<f64>> {
        None
    }
    /// The function turned by a rotation: `s ↦ f(R⁻¹ s)`.
    fn rotate(&self, _order: usize, _rotation: &Matrix, _f: &[f64]) -> Option<Vec<f64>> {
        None
    }
    /// The SH exponential.
    fn exp(&self, _order: usize, _f: &[f64]) -> Option<Vec<f64>> {
        None
    }
    /// The SH logarithm of a function that is positive.
    fn log(&self, _order: usize, _g: &[f64]) -> Option<Vec<f64>> {
        None
    }
    /// Whether the exponential isolates the mean, `exp(f + c·1) = e^c exp(f)`.
    fn isolates_mean(&self) -> bool {
        true
    }
}

/// An identity that does not hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("order {order}: {identity}: {detail}")]
pub struct Violation {
    /// What should hold.
    pub identity: &'static str,
    /// The order at which it fails.
    pub order: usize,
    /// The smallest failing case found.
    pub detail: String,
}

/// Cases that each identity is tried with, at each order.
const CASES: u32 = 16;

/// Checks every identity at every order on a fixed sequence of cases, and returns those that fail.
pub fn check(ops: &impl ShOps) -> Vec<Violation> {
    let mut violations = Vec::new();
    for order in ops.orders() {
        let laws = laws::Laws::new(ops, order);
        let mut law = |identity: &'static str, result: Result<(), String>| {
            violations.extend(result.err().map(|detail| Violation { identity, order, detail }));
        };
        law("the basis is orthonormal", laws.orthonormal());
        law(
            "squares of a band's functions sum to a constant",
            try_cases(strategies::direction(), |s| laws.addition(s)),
        );
        let (vector, rotation) = (strategies::vector(order), strategies::rotation());
        law("projection returns the coefficients", try_cases(&vector, |f| laws.projection(&f)));
        let pairs = (&vector, &vector);
        law("products are projections of products", try_cases(pairs, |(a, b)| laws.product_is_projection(&a, &b)));
        law("products commute", try_cases(pairs, |(a, b)| laws.product_commutes(&a, &b)));
        law("1 is the unit of products", try_cases(&vector, |f| laws.product_has_unit(&f)));
        let three = (&vector, &vector, &vector);
        law("products are linear", try_cases(three, |(a, b, c)| laws.product_is_linear(&a, &b, &c)));
        let turned = (&vector, &rotation, strategies::direction());
        law("rotation moves values", try_cases(turned, |(f, r, s)| laws.rotation_moves_values(&f, &r, s)));
        let twice = (&vector, &rotation, &rotation);
        law("rotations compose", try_cases(twice, |(f, r, q)| laws.rotations_compose(&f, &r, &q)));
        law("rotation keeps lengths", try_cases((&vector, &rotation), |(f, r)| laws.rotation_keeps_length(&f, &r)));
        let both = (&vector, &vector, &rotation);
        law("rotation commutes with products", try_cases(both, |(a, b, r)| laws.rotation_and_product(&a, &b, &r)));
        law("exp(0) = 1", laws.exp_of_zero());
        law("exp(f + c·1) = e^c exp(f)", try_cases((&vector, -2.0f64..1.0), |(f, c)| laws.exp_isolates_mean(&f, c)));
        law("rotation commutes with exp", try_cases((&vector, &rotation), |(f, r)| laws.rotation_and_exp(&f, &r)));
        law("rotation commutes with log", try_cases((&vector, &rotation), |(f, r)| laws.rotation_and_log(&f, &r)));
    }
    violations
}

/// Runs a property on the strategy's values; the error tells the smallest failing one.
fn try_cases<S: Strategy>(strategy: S, law: impl Fn(S::Value) -> Result<(), String>) -> Result<(), String> {
    let config = Config { cases: CASES, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let outcome = runner.run(&strategy, |value| law(value).map_err(TestCaseError::fail));
    outcome.map_err(|error| shorten(&error))
}

fn shorten(error: &impl fmt::Display) -> String {
    error.to_string().lines().next().unwrap_or_default().into()
}
