//! Orders, coefficient counts and indices.

use std::fmt;

/// The highest supported order.
pub const MAX_ORDER: usize = 8;

/// Coefficients of a vector of [`MAX_ORDER`], the size of every scratch buffer.
pub(crate) const MAX_COEFFICIENTS: usize = coefficients(MAX_ORDER);

/// `√(4π)`, the coefficient of `y_0` in the vector of the constant 1.
pub(crate) const SQRT_4_PI: f64 = 3.544_907_701_811_032;

/// The number of coefficients of an order, `n²`.
pub const fn coefficients(order: usize) -> usize {
    order * order
}

/// The index `l(l+1) + m` of `y_lm`, `-l ≤ m ≤ l`.
pub const fn index(l: usize, m: isize) -> usize {
    (l * (l + 1)).wrapping_add_signed(m)
}

/// Accepts orders 1 to [`MAX_ORDER`].
///
/// # Errors
/// [`OrderError`] for every other order.
pub fn check_order(order: usize) -> Result<(), OrderError> {
    if (1..=MAX_ORDER).contains(&order) { Ok(()) } else { Err(OrderError { order }) }
}

/// An order outside 1 to [`MAX_ORDER`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OrderError {
    /// The order that was asked for.
    pub order: usize,
}

impl fmt::Display for OrderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "spherical harmonics order {}: expected 1 to {MAX_ORDER}", self.order)
    }
}

impl std::error::Error for OrderError {}

/// The check of internal entry points, whose callers have validated the user's order.
///
/// # Panics
/// Outside 1 to [`MAX_ORDER`].
#[track_caller]
pub(crate) fn assert_order(order: usize) {
    if let Err(error) = check_order(order) {
        panic!("{error}");
    }
}

/// Asserts that `slice` holds the `n²` coefficients of a valid order.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or the length differs.
#[track_caller]
pub(crate) fn assert_vector<T>(order: usize, slice: &[T]) {
    assert_order(order);
    assert_eq!(slice.len(), coefficients(order), "an SH vector of order {order} has {} coefficients", order * order);
}

/// Asserts that `slice` holds one value for each band of a valid order.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or the length differs.
#[track_caller]
pub(crate) fn assert_zonal<T>(order: usize, slice: &[T]) {
    assert_order(order);
    assert_eq!(slice.len(), order, "a zonal vector of order {order} has one value a band");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_runs_over_all_coefficients_in_order() {
        let all: Vec<usize> =
            (0..MAX_ORDER).flat_map(|l| (-(l as isize)..=l as isize).map(move |m| index(l, m))).collect();
        assert_eq!(all, (0..coefficients(MAX_ORDER)).collect::<Vec<_>>());
    }

    #[test]
    fn only_orders_one_to_eight_pass() {
        for order in 0..20 {
            assert_eq!(check_order(order).is_ok(), order > 0 && order < 9);
        }
        assert_eq!(check_order(9).unwrap_err().to_string(), "spherical harmonics order 9: expected 1 to 8");
    }
}
