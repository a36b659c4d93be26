//! Numbers as a scene file shows them: as many digits as mean something. What is derived from a model is rounded, so that
//! deriving it again from an export of the same scene, whose rounding differs in the last bits, gives the same file.

use glam::DVec3;

/// Significant digits of derived numbers.
const DIGITS: i32 = 6;

/// Rounded to a multiple of a power of ten that leaves so many digits to a number of a given size. What is not finite stays so,
/// for the scene's checks to name it.
fn rounded(value: f64, size: f64, digits: i32) -> f32 {
    if size == 0.0 || !size.is_finite() {
        return (value + 0.0) as f32;
    }
    let last = size.abs().log10().floor() as i32 + 1 - digits;
    // Powers of ten with negative exponents are not exact; their inverses are.
    let near = match last {
        0.. => (value / 10f64.powi(last)).round() * 10f64.powi(last),
        _ => (value * 10f64.powi(-last)).round() / 10f64.powi(-last),
    };
    // Adding 0 makes one of the two zeros.
    if near.is_finite() { (near + 0.0) as f32 } else { value as f32 }
}

pub(super) fn number(value: f64) -> f32 {
    rounded(value, value, DIGITS)
}

/// Each component as exact as the greatest.
pub(super) fn vector(value: DVec3) -> [f32; 3] {
    within(value, value.abs().max_element())
}

/// As exact as things of a given size need it.
pub(super) fn within(value: DVec3, size: f64) -> [f32; 3] {
    value.to_array().map(|v| rounded(v, size, DIGITS))
}

/// A direction, its greatest component 1: of unit vectors rounding would change the length, and another rounding the digits.
pub(super) fn direction(value: DVec3) -> [f32; 3] {
    let value = value / value.abs().max_element();
    value.to_array().map(|v| rounded(v, 1.0, DIGITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_kept_and_rounding_twice_is_rounding_once() {
        assert_eq!(number(123_456_789.0), 123_457_000.0);
        assert_eq!(number(0.1 + 0.2), 0.3);
        assert_eq!(number(f64::from(5f32.to_radians().to_degrees())), 5.0);
        assert_eq!(vector(DVec3::new(1000.0, 1.234_567, -1e-9)), [1000.0, 1.23, 0.0]);
        assert!(vector(DVec3::new(1.0, 1.0, -1e-9))[2].is_sign_positive());
        assert_eq!(direction(DVec3::new(0.0, -0.5, 0.25)), [0.0, -1.0, 0.5]);
        assert_eq!(vector(DVec3::ZERO), [0.0; 3]);
        assert_eq!((number(f64::INFINITY), number(1e-310)), (f32::INFINITY, 0.0));
        for i in 1..2000 {
            let value = number((f64::from(i) * 0.04).exp());
            assert_eq!(number(f64::from(value) * (1.0 + 2e-7)), value);
        }
    }
}
