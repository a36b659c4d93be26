//! The basis functions without their azimuth.

use std::f64::consts::{PI, SQRT_2};

/// `y_lm` is `p_lm(θ) cos mφ`, and `y_l(-m)` is `p_lm(θ) sin mφ`; this is `p_lm` at one angle, given by its sine and cosine, which
/// need not be within half a turn.
pub(crate) struct Latitude {
    order: usize,
    values: Vec<f64>,
}

impl Latitude {
    pub(crate) fn new(order: usize, sine: f64, cosine: f64) -> Self {
        let mut values = vec![0.0; order * order];
        let mut sectoral = (0.25 / PI).sqrt();
        for m in 0..order {
            if m > 0 {
                sectoral *= sine * ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
            }
            let (mut below, mut p) = (0.0, if m == 0 { sectoral } else { SQRT_2 * sectoral });
            for l in m..order {
                if l > m {
                    let [l2, m2, below2] = [l * l, m * m, (l - 1) * (l - 1)].map(|v| v as f64);
                    let rise = ((4.0 * l2 - 1.0) / (l2 - m2)).sqrt();
                    let fall = rise * ((below2 - m2) / (4.0 * below2 - 1.0)).max(0.0).sqrt();
                    (below, p) = (p, rise * cosine * p - fall * below);
                }
                values[l * order + m] = p;
            }
        }
        Self { order, values }
    }

    /// `p_lm`, `m ≤ l`.
    pub(crate) fn at(&self, l: usize, m: usize) -> f64 {
        self.values[l * self.order + m]
    }
}
