//! Functions that begin in proportion to their variable, near its 0: one polynomial that all lanes share, with nothing to look up.

use halflight_sh_kernels::{Lanes, Real};

use crate::pieces::interpolate;

/// Coefficients of a polynomial.
pub(crate) const TERMS: usize = 7;

/// The largest error of a fit, relative to the largest of the functions at the same place: a rounding of `f32`.
const ERROR: f64 = 6e-8;

/// Halvings of the interval in which the end of the fit is searched.
const STEPS: usize = 8;

/// `width` functions `x·p(x)` of a variable from 0 on, `p` a polynomial of degree 6.
#[derive(Clone, Debug)]
pub(crate) struct Small<T> {
    end: T,
    /// For each function, the coefficients of `p` by ascending powers.
    functions: Vec<[T; TERMS]>,
}

impl<T: Real> Small<T> {
    /// Fits `f`, which writes `width` values, from 0 as far as one polynomial goes, at most to `most`.
    pub(crate) fn fit(width: usize, most: f64, mut f: impl FnMut(f64, &mut [f64])) -> Self {
        let (mut good, mut bad) = (0.0, most);
        let mut functions = vec![[0.0; TERMS]; width];
        for _ in 0..STEPS {
            let end = 0.5 * (good + bad);
            let tried = through_chebyshev_points(width, end, &mut f);
            if error(&tried, end, &mut f) <= ERROR {
                (good, functions) = (end, tried);
            } else {
                bad = end;
            }
        }
        Self { end: T::from_f64(good), functions: functions.iter().map(|powers| powers.map(T::from_f64)).collect() }
    }

    /// Where the fit ends.
    #[inline(always)]
    pub(crate) fn end(&self) -> T {
        self.end
    }

    /// Calls `out` with the number and the value of each function at `x`, which lies between 0 and the end; 0 gives 0.
    #[inline(always)]
    pub(crate) fn lookup<V: Lanes<Scalar = T>>(&self, x: V, mut out: impl FnMut(usize, V)) {
        for (function, powers) in self.functions.iter().enumerate() {
            let mut value = V::splat(powers[TERMS - 1]);
            for &power in powers[..TERMS - 1].iter().rev() {
                value = value.mul_add(x, V::splat(power));
            }
            out(function, value.mul(x));
        }
    }
}

impl Small<f32> {
    /// Adds the coefficients to a table, function by function.
    pub(crate) fn print(&self, table: &mut Vec<f32>) {
        table.extend(self.functions.iter().flatten());
    }
}

/// The polynomials through Chebyshev points between 0 and `end`.
fn through_chebyshev_points(width: usize, end: f64, f: &mut impl FnMut(f64, &mut [f64])) -> Vec<[f64; TERMS]> {
    let turn = |k: usize| (2 * k + 1) as f64 / (2 * TERMS) as f64 * std::f64::consts::PI;
    let nodes: [f64; TERMS] = std::array::from_fn(|k| 0.5 * end * (1.0 - turn(k).cos()));
    let mut values = vec![0.0; width];
    let mut samples = vec![[0.0; TERMS]; width];
    for (k, &node) in nodes.iter().enumerate() {
        f(node, &mut values);
        samples.iter_mut().zip(&values).for_each(|(row, &value)| row[k] = value / node);
    }
    samples.iter().map(|row| interpolate(&nodes, row)).collect()
}

/// The largest error between the points.
fn error(functions: &[[f64; TERMS]], end: f64, f: &mut impl FnMut(f64, &mut [f64])) -> f64 {
    let mut values = vec![0.0; functions.len()];
    let mut worst = 0.0f64;
    for k in 1..=3 * TERMS {
        let x = end * k as f64 / (3 * TERMS) as f64;
        f(x, &mut values);
        let largest = values.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        for (powers, value) in functions.iter().zip(&values) {
            let found = x * powers.iter().rev().fold(0.0, |sum, power| sum * x + power);
            worst = worst.max((found - value).abs() / largest);
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_fitted_as_far_as_one_polynomial_goes() {
        let f = |x: f64| [(-x).ln_1p(), 0.5 * x];
        let small = Small::<f64>::fit(2, 0.9, |x, out| out.copy_from_slice(&f(x)));
        assert!((0.2..0.6).contains(&small.end()), "{}", small.end());
        for k in 0..=100 {
            let x = small.end() * f64::from(k) / 100.0;
            let want = f(x);
            small.lookup(x, |i, value| assert!((value - want[i]).abs() <= 2.0 * ERROR * want[0].abs(), "{i} at {x}"));
        }
    }

    #[test]
    fn a_kink_at_once_leaves_nothing_to_fit() {
        let small = Small::<f64>::fit(1, 1.0, |x, out| out[0] = x.sqrt());
        assert_eq!(small.end(), 0.0);
    }
}
