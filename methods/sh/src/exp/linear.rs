//! The optimal linear approximation (OL) and its scaled and squared form (HYB).

use std::sync::OnceLock;

use super::{ExpWorkspace, SquaringRule, Work, norm, restore, scale_by_power};
use crate::circle::{CircleTable, circle_log, circle_visibility, log_kinks};
use crate::order::{MAX_ORDER, SQRT_4_PI, assert_vector};
use crate::pieces::{Pieces, of_precision};
use crate::table::Table;
use halflight_sh_kernels::Real;

/// Intervals of the table, and of the search for the end of its domain.
const INTERVALS: usize = 256;

/// The coefficients `a` and `b` of `exp f̂ ≈ a·1 + b·f̂` against `‖f̂‖`, fitted to circles (Ren 2006, eqs. 23–24).
struct LinearTable {
    table: Table,
    /// Where the curves have kinks.
    kinks: Vec<f64>,
    /// Up to here the circles' `‖f̂‖` grows with their radius, so that it identifies them: the table's end. Interpolation
    /// errs by up to 2e-4 just before an end where the growth stops (orders 3 and up), below 1e-5 elsewhere.
    end: f64,
    /// Up to here no eigenvalue of a circle's logarithm was clipped, so that other shapes have the same curves.
    unclipped: f64,
}

/// The table of an order, at least 2.
fn linear_table(order: usize) -> &'static LinearTable {
    static TABLES: [OnceLock<LinearTable>; MAX_ORDER] = [const { OnceLock::new() }; MAX_ORDER];
    TABLES[order - 1].get_or_init(|| LinearTable::fit(order))
}

impl LinearTable {
    fn fit(order: usize) -> Self {
        let circle_norm = |height: f64| circle_norm(order, height);
        let fine = 16 * INTERVALS;
        let steps = (0..=fine).map(|k| k as f64 / fine as f64);
        let mut last = (0.0, 0.0);
        for height in steps {
            let norm = circle_norm(height);
            if norm < last.1 {
                break;
            }
            last = (height, norm);
        }
        let (top, end) = last;
        let kinks: Vec<f64> = log_kinks(order).iter().filter(|&&k| k < top).map(|&k| circle_norm(k)).collect();
        let unclipped = kinks.first().copied().unwrap_or(end);
        let breaks = [&[0.0], kinks.as_slice(), &[end]].concat();
        let table = Table::sample(2, &breaks, INTERVALS, |norm, out| {
            let (mut low, mut high) = (0.0, top);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if circle_norm(middle) < norm { low = middle } else { high = middle }
            }
            out.copy_from_slice(&fit_circle(order, high));
        });
        Self { table, kinks, end, unclipped }
    }

    /// `a` and `b` at a norm. Past the table's end, `a` and the length of `b·f̂` stay as they are there.
    fn lookup<T: Real>(&self, norm: f64) -> [T; 2] {
        let mut factors = [0.0; 2];
        self.table.lookup(norm, &mut factors);
        if norm > self.end {
            factors[1] *= self.end / norm;
        }
        factors.map(T::from_f64)
    }
}

/// `‖f̂‖` of the log of a circle of height `1 - cos θ`, by the circle table.
fn circle_norm(order: usize, height: f64) -> f64 {
    let mut log = [0.0; MAX_ORDER];
    CircleTable::log(order).lookup((height * (2.0 - height)).sqrt(), &mut log[..order]);
    norm(&log[1..order])
}

/// The least-squares `a` and `b` of one circle (Ren 2006, eq. 24).
fn fit_circle(order: usize, height: f64) -> [f64; 2] {
    let (mut g, mut f) = (vec![0.0; order], vec![0.0; order]);
    circle_visibility(order, 1.0 - height, &mut g);
    circle_log(order, 1.0 - height, &mut f);
    let scale = (-f[0] / SQRT_4_PI).exp();
    let dot = |a: &[f64], b: &[f64]| -> f64 { a[1..].iter().zip(&b[1..]).map(|(x, y)| x * y).sum() };
    let length = dot(&f, &f);
    let slope = if length > 0.0 { scale * dot(&g, &f) / length } else { 1.0 };
    [scale * g[0] / SQRT_4_PI, slope]
}

/// The table of an order, at least 2, as pieces, and where it ends.
pub(crate) fn linear_pieces<T: Real>(order: usize) -> (&'static Pieces<T>, f64) {
    static FITS: [OnceLock<(Pieces<f32>, Pieces<f64>)>; MAX_ORDER] = [const { OnceLock::new() }; MAX_ORDER];
    let table = linear_table(order);
    let (single, double) = FITS[order - 1].get_or_init(|| {
        let breaks = [&[0.0], table.kinks.as_slice(), &[table.end]].concat();
        let f = |norm: f64, out: &mut [f64]| out.copy_from_slice(&table.lookup::<f64>(norm));
        // Squaring doubles a relative error, and the shorter a vector was made, the oftener it is squared.
        let weight = |norm: f64| 1.0 / (norm + 0.05);
        (Pieces::fit(2, &breaks, weight, f), Pieces::fit(2, &breaks, weight, f))
    });
    (of_precision(single, double), table.end)
}

/// The norm up to which no eigenvalue of a circle's logarithm was clipped.
pub(crate) fn unclipped_norm(order: usize) -> f64 {
    if order > 1 { linear_table(order).unclipped } else { 1.0 }
}

impl<T: Real> ExpWorkspace<T> {
    /// OL: `exp(mean)·(a·1 + b·f̂)` with `a` and `b` looked up by `‖f̂‖` (Ren 2006, eq. 23).
    ///
    /// The paper claims it for orders up to 4 and `‖f̂‖ < 4.8`, where the logarithm of the circles it is fitted to is not
    /// clipped. Beyond the largest circle that its norm identifies (one of 90° at orders 2 and 4), it holds `a` and the
    /// length of `b·f̂`.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn optimal_linear(&mut self, f: &[T], out: &mut [T]) -> Work {
        assert_vector(self.order, out);
        let (mean, norm) = self.isolate_mean(f);
        self.linear(norm, out);
        restore(out, 0.0, mean);
        Work::default()
    }

    /// HYB: OL of the vector scaled down by a power of two, then squared (Ren 2006, §4.3).
    ///
    /// Works at every order: there are at least as many squarings as bring `‖f̂‖` into the domain where OL's curves do
    /// not depend on the clip.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn hybrid(&mut self, rule: SquaringRule, f: &[T], out: &mut [T]) -> Work {
        assert_vector(self.order, out);
        let (mean, norm) = self.isolate_mean(f);
        let limit = if norm > 0.0 { linear_table(self.order).unclipped } else { 1.0 };
        let squarings = rule.count(norm, limit);
        scale_by_power(&mut self.residual, -squarings);
        self.linear(norm * 2f64.powi(-squarings), out);
        let exponent = self.square_repeatedly(out, squarings);
        restore(out, exponent, mean);
        Work { products: 0, squares: squarings as u32 }
    }

    /// `a·1 + b·f̂` of the stored residual, whose norm is given.
    fn linear(&self, norm: f64, out: &mut [T]) {
        // At order 1 there is only the mean, and no table.
        let [a, b] = if norm > 0.0 { linear_table(self.order).lookup(norm) } else { [T::ONE; 2] };
        out.iter_mut().zip(&self.residual).for_each(|(o, &r)| *o = b * r);
        out[0] = a * T::from_f64(SQRT_4_PI);
    }
}
