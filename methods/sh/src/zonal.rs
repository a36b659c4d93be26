//! Zonal vectors: rotation to an axis, the clamped cosine, windows (one factor a band).

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

use crate::basis::evaluate;
use crate::order::{MAX_ORDER, assert_order, assert_zonal, coefficients};
use halflight_sh_kernels::Real;

/// `√(4π/(2l+1))`: the factor by which a zonal coefficient multiplies `y_lm(axis)`.
static LOBE_SCALE: LazyLock<[f64; MAX_ORDER]> =
    LazyLock::new(|| std::array::from_fn(|l| (4.0 * PI / (2 * l + 1) as f64).sqrt()));

/// The clamped cosine's zonal coefficients, see [`clamped_cosine`].
static CLAMPED_COSINE: LazyLock<[f64; MAX_ORDER]> = LazyLock::new(|| {
    // ∫₀¹ z P_l(z) dz, from the closed form for even l; consecutive even bands have the ratio -(l-1)/(l+4).
    let mut integrals = [0.0; MAX_ORDER];
    (integrals[0], integrals[1]) = (1.0 / 2.0, 1.0 / 3.0);
    let mut even = 1.0 / 8.0;
    for l in (2..MAX_ORDER).step_by(2) {
        integrals[l] = even;
        even *= -((l - 1) as f64) / (l + 4) as f64;
    }
    std::array::from_fn(|l| 2.0 * ((2 * l + 1) as f64 / (4.0 * PI)).sqrt() * integrals[l])
});

/// Turns a function that is symmetric about z so that it is symmetric about `axis` (a unit vector): the coefficient of
/// `y_lm` becomes `√(4π/(2l+1))·zonal_l·y_lm(axis)` (Sloan et al. 2005).
///
/// `zonal` holds the `n` coefficients of `y_l0`, `out` the `n²` coefficients.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or a slice has the wrong length.
pub fn rotate_zonal<T: Real>(order: usize, zonal: &[T], axis: [T; 3], out: &mut [T]) {
    assert_zonal(order, zonal);
    evaluate(order, axis, out);
    for (l, &value) in zonal.iter().enumerate() {
        let scale = T::from_f64(LOBE_SCALE[l]) * value;
        out[band(l)].iter_mut().for_each(|y| *y *= scale);
    }
}

/// The `n` zonal coefficients of `max(z, 0)/π`, the irradiance weighting `H` about z (Ren 2006, eq. 9). With the 1/π, a
/// sky of radiance 1 integrates to 1.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`].
pub fn clamped_cosine(order: usize) -> &'static [f64] {
    assert_order(order);
    &CLAMPED_COSINE[..order]
}

/// `H(N)`, the `n²` coefficients of `max(s·normal, 0)/π` (Ren 2006, eq. 9) for a unit normal.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or `out` has the wrong length.
pub fn irradiance_weights<T: Real>(order: usize, normal: [T; 3], out: &mut [T]) {
    let zonal: [T; MAX_ORDER] = CLAMPED_COSINE.map(T::from_f64);
    rotate_zonal(order, &zonal[..order], normal, out);
}

/// The window `α_l = cos(π/2·l/h)` for each band, 0 from `l = h` on; Ren 2006 uses `h = 2n`. `h` is positive; an
/// infinite one leaves every band as it is.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`].
pub fn window(order: usize, h: f64) -> Vec<f64> {
    assert_order(order);
    (0..order).map(|l| if l == 0 { 1.0 } else { (FRAC_PI_2 * (l as f64 / h).min(1.0)).cos() }).collect()
}

/// Multiplies the coefficients of each band `l` by `scale[l]`.
///
/// # Panics
/// If the order, which is `scale`'s length, is outside 1 to [`MAX_ORDER`], or `coefficients` does not hold `n²` values.
pub fn apply_bands<T: Real>(scale: &[T], coefficients: &mut [T]) {
    crate::order::assert_vector(scale.len(), coefficients);
    for (l, &factor) in scale.iter().enumerate() {
        coefficients[band(l)].iter_mut().for_each(|value| *value *= factor);
    }
}

/// The range of a band's coefficients.
pub(crate) fn band(l: usize) -> std::ops::Range<usize> {
    coefficients(l)..coefficients(l + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gauss_legendre;

    /// The constants that Snyder and Nowrouzezahrai 2008 print, which lack the 1/π.
    #[test]
    fn clamped_cosine_has_the_printed_constants() {
        for (l, want) in [0.886227, 1.02333, 0.495416, 0.0].into_iter().enumerate() {
            assert!((PI * clamped_cosine(4)[l] - want).abs() < 5e-6);
        }
    }

    #[test]
    fn clamped_cosine_is_the_projection() {
        let (nodes, weights) = gauss_legendre(8);
        for (l, &value) in clamped_cosine(MAX_ORDER).iter().enumerate() {
            // over z in [0, 1], where the integrand is a polynomial
            let integral: f64 = nodes
                .iter()
                .zip(&weights)
                .map(|(x, w)| {
                    let z = 0.5 * (x + 1.0);
                    let mut y = vec![0.0; 64];
                    evaluate(8, [(1.0 - z * z).sqrt(), 0.0, z], &mut y);
                    0.5 * w * 2.0 * z * y[crate::index(l, 0)]
                })
                .sum();
            assert!((value - integral).abs() < 1e-14, "band {l}: {value} instead of {integral}");
        }
    }

    #[test]
    fn window_starts_at_one_and_falls_to_zero_at_h() {
        for (value, want) in window(4, 8.0).iter().zip([1.0, 0.980785, 0.923880, 0.831470]) {
            assert!((value - want).abs() < 1e-6);
        }
        assert!(window(8, 3.0)[3..].iter().all(|value| value.abs() < 1e-15));
        assert!(window(8, f64::INFINITY).iter().all(|&value| value == 1.0));
    }
}
