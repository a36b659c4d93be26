//! The basis functions as polynomials of a direction.

use std::f64::consts::{PI, SQRT_2};
use std::sync::LazyLock;

use crate::order::{MAX_ORDER, assert_vector, index};
use halflight_sh_kernels::Real;

/// The three-term recurrence of the normalised associated Legendre functions with `sin^m` divided out:
/// `p_lm = rise_lm·z·p_(l-1)m - fall_lm·p_(l-2)m`, started from `p_mm = start_m`.
struct Recurrence {
    start: [f64; MAX_ORDER],
    rise: [[f64; MAX_ORDER]; MAX_ORDER],
    fall: [[f64; MAX_ORDER]; MAX_ORDER],
}

static RECURRENCE: LazyLock<Recurrence> = LazyLock::new(|| {
    let mut r = Recurrence {
        start: [0.0; MAX_ORDER],
        rise: [[0.0; MAX_ORDER]; MAX_ORDER],
        fall: [[0.0; MAX_ORDER]; MAX_ORDER],
    };
    let mut sectoral = (0.25 / PI).sqrt();
    for m in 0..MAX_ORDER {
        if m > 0 {
            sectoral *= ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
        }
        r.start[m] = if m == 0 { sectoral } else { SQRT_2 * sectoral };
        for l in m + 1..MAX_ORDER {
            let [l2, m2, below2] = [l * l, m * m, (l - 1) * (l - 1)].map(|v| v as f64);
            r.rise[l][m] = ((4.0 * l2 - 1.0) / (l2 - m2)).sqrt();
            r.fall[l][m] = r.rise[l][m] * ((below2 - m2) / (4.0 * below2 - 1.0)).max(0.0).sqrt();
        }
    }
    r
});

/// Writes `y_i(direction)` for the `n²` basis functions of an order.
///
/// The functions are evaluated as polynomials, so that there is no singular direction; off the unit sphere they are
/// those polynomials, not the harmonics of the normalised direction.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or `out` does not hold `n²` values.
pub fn evaluate<T: Real>(order: usize, direction: [T; 3], out: &mut [T]) {
    assert_vector(order, out);
    let recurrence = &*RECURRENCE;
    let [x, y, z] = direction;
    // (x + iy)^m = sin^m θ·(cos mφ + i sin mφ)
    let (mut cosine, mut sine) = (T::ONE, T::ZERO);
    for m in 0..order {
        let (mut below, mut p) = (T::ZERO, T::from_f64(recurrence.start[m]));
        for l in m..order {
            if l > m {
                let rise = T::from_f64(recurrence.rise[l][m]);
                let fall = T::from_f64(recurrence.fall[l][m]);
                (below, p) = (p, rise * z * p - fall * below);
            }
            out[index(l, -(m as isize))] = p * sine;
            out[index(l, m as isize)] = p * cosine; // last: for m = 0 both are the same coefficient
        }
        (cosine, sine) = (x * cosine - y * sine, x * sine + y * cosine);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first three bands and two of the fourth as the tables in textbooks print them.
    #[test]
    fn low_bands_match_the_printed_polynomials() {
        for [x, y, z] in [[0.48f64, 0.6, 0.64], [0.0, 0.0, 1.0], [-0.6, 0.0, -0.8], [0.0, 1.0, 0.0]] {
            let expected = [
                (0, 0.282_094_791_773_878),
                (1, 0.488_602_511_902_92 * y),
                (2, 0.488_602_511_902_92 * z),
                (3, 0.488_602_511_902_92 * x),
                (4, 1.092_548_430_592_079 * x * y),
                (5, 1.092_548_430_592_079 * y * z),
                (6, 0.315_391_565_252_52 * (3.0 * z * z - 1.0)),
                (7, 1.092_548_430_592_079 * x * z),
                (8, 0.546_274_215_296_04 * (x * x - y * y)),
                (9, 0.590_043_589_926_644 * y * (3.0 * x * x - y * y)),
                (12, 0.373_176_332_590_115 * z * (5.0 * z * z - 3.0)),
            ];
            let mut out = [0.0; 16];
            evaluate(4, [x, y, z], &mut out);
            for (i, value) in expected {
                assert!((out[i] - value).abs() < 1e-13, "y_{i} = {} instead of {value}", out[i]);
            }
        }
    }

    /// The addition theorem: Σ y_i² = n²/4π everywhere.
    #[test]
    fn squares_sum_to_the_addition_theorem() {
        for order in 1..=MAX_ORDER {
            let mut out = vec![0.0f64; order * order];
            evaluate(order, [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0], &mut out);
            let sum: f64 = out.iter().map(|v| v * v).sum();
            assert!((sum - (order * order) as f64 / (4.0 * PI)).abs() < 1e-12);
        }
    }
}
