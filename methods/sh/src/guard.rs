//! The overlap guard: what every visibility vector must satisfy.

use crate::order::{SQRT_4_PI, assert_vector};
use halflight_sh_kernels::Real;

/// Moves `g` into the set that holds the projection of every binary visibility function and returns whether it had to.
///
/// A binary V equals its square, so `0 ≤ g_0 ≤ √4π` and `‖g‖² ≤ ∫V² = ∫V = √4π·g_0`; it follows that `|g(s)| ≤ n`
/// everywhere. Products and exponentials of heavily overlapping blockers leave this set (they grow without bound); then
/// `g_0` is clamped and the other bands shrunk by one factor. Coefficients that are not finite become 0 first
/// (`g_0 = +∞` the upper bound), so the result is always finite. Excess within a few roundings of `T` is left alone: an
/// open sky passes unchanged, and the guard applied twice is the guard applied once.
///
/// The set is a ball (centre `√π·e_0`, radius `√π`), yet neither its nearest point nor a scaling of all of `g` does as
/// well: for the bunny in 64 spheres at order 4, RMSE 0.034 and 0.038 against 0.021 this way and 0.037 unguarded.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER) or `g` does not hold `n²` coefficients.
pub fn project_binary_bound<T: Real>(order: usize, g: &mut [T]) -> bool {
    assert_vector(order, g);
    let slack = 64.0 * T::EPSILON.to_f64();
    let (first, rest) = g.split_at_mut(1);
    let mut acted = false;

    let mean = first[0].to_f64();
    if !(-slack..=SQRT_4_PI + slack).contains(&mean) {
        first[0] = T::from_f64(if mean.is_nan() { 0.0 } else { mean.clamp(0.0, SQRT_4_PI) });
        acted = true;
    }
    for value in rest.iter_mut().filter(|value| !value.is_finite()) {
        *value = T::ZERO;
        acted = true;
    }

    let mean = first[0].to_f64();
    let bound = (mean * (SQRT_4_PI - mean)).max(0.0);
    let energy: f64 = rest.iter().map(|v| v.to_f64() * v.to_f64()).sum();
    if energy > bound + slack {
        let scale = T::from_f64((bound / energy).sqrt());
        rest.iter_mut().for_each(|v| *v *= scale);
        acted = true;
    }
    acted
}
