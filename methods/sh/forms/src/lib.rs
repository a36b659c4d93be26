//! The product of two real functions on the sphere in three forms, by plain loops over tables that are made in `f64` when a
//! form is built, at orders 1 to [`MAX_ORDER`]: which one is cheapest at which order is measured, not quoted
//! (`cargo bench -p halflight-sh-forms`).
//!
//! | form | multiply-adds grow as | how |
//! |---|---|---|
//! | [`Sparse`] | n⁵ | the nonzero entries of the triple product tensor |
//! | [`Rings`] | n⁴ | Fourier series in azimuth on rings at Gauss–Lobatto heights, multiplied there by convolution |
//! | [`Fourier`] | n³ | the Fourier series on the torus, multiplied on a grid by fast Fourier transforms |
//!
//! Conventions are those of `halflight-sh`, whose generated code, to order 8, makes the first two forms fast.
//!
//! ```
//! use halflight_sh_forms::{Form, Fourier, Sparse};
//!
//! let order = 12;
//! let a: Vec<f64> = (0..order * order).map(|i| (i as f64).sin()).collect();
//! let (mut sparse, mut fourier) = (a.clone(), a.clone());
//! Sparse::new(order).product(&a, &a, &mut sparse);
//! Fourier::new(order).product(&a, &a, &mut fourier);
//! assert!(sparse.iter().zip(&fourier).all(|(x, y)| (x - y).abs() < 1e-11));
//! ```

mod fourier;
mod latitude;
mod level;
mod rings;
mod sparse;

pub use fourier::Fourier;
pub use level::Scalar;
pub use rings::Rings;
pub use sparse::Sparse;

/// The highest order.
pub const MAX_ORDER: usize = 16;

/// A way to compute products of one order.
pub trait Form<T> {
    /// The projection of the product of two functions; `n²` coefficients each.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    fn product(&mut self, a: &[T], b: &[T], out: &mut [T]);
}

/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`].
#[track_caller]
fn assert_order(order: usize) {
    assert!((1..=MAX_ORDER).contains(&order), "order {order}: expected 1 to {MAX_ORDER}");
}

/// # Panics
/// If a slice does not hold `n²` coefficients.
#[track_caller]
fn assert_vectors(order: usize, lengths: [usize; 3]) {
    assert!(lengths.iter().all(|&len| len == order * order), "{lengths:?} coefficients, expected {order}²");
}
