//! Piecewise polynomials that lanes look up without gathers: at most 16 pieces, whose coefficients fit a register each.

use std::any::Any;

use halflight_sh_kernels::{Lanes, Real};

/// The most pieces: what [`Lanes::select_from`] selects from.
pub(crate) const PIECES: usize = 16;

/// The degree of a piece.
pub(crate) const DEGREE: usize = 7;

/// `width` functions of one variable, a polynomial of degree 7 in each of 16 pieces.
#[derive(Clone, Debug)]
pub(crate) struct Pieces<T> {
    /// Where pieces begin.
    starts: [T; PIECES],
    /// The middle of each piece.
    middles: [T; PIECES],
    /// One over half the length of each.
    scales: [T; PIECES],
    /// For each function, the coefficients by ascending powers of the position in a piece, from -1 to 1.
    functions: Vec<[[T; PIECES]; DEGREE + 1]>,
    end: T,
}

/// A piece in the making.
struct Piece {
    start: f64,
    end: f64,
    /// For each function its coefficients.
    fit: Vec<[f64; DEGREE + 1]>,
    error: f64,
}

impl<T: Real> Pieces<T> {
    /// Fits `f`, which writes `width` values, between the first and the last of the ascending `breaks`, the kinks in
    /// between; the piece with the largest error, times `weight` at its middle, is halved until there are 16.
    ///
    /// # Panics
    /// If there are more than 15 kinks.
    pub(crate) fn fit(
        width: usize,
        breaks: &[f64],
        weight: fn(f64) -> f64,
        mut f: impl FnMut(f64, &mut [f64]),
    ) -> Self {
        let mut pieces: Vec<Piece> =
            breaks.windows(2).map(|ends| Piece::fit(width, ends[0], ends[1], &mut f)).collect();
        assert!((1..=PIECES).contains(&pieces.len()), "{} pieces, expected 1 to {PIECES}", pieces.len());
        while pieces.len() < PIECES {
            let cost = |at: usize| pieces[at].error * weight(0.5 * (pieces[at].start + pieces[at].end));
            let worst = (0..pieces.len()).max_by(|&a, &b| cost(a).total_cmp(&cost(b))).expect("some");
            let Piece { start, end, .. } = pieces[worst];
            let middle = 0.5 * (start + end);
            let halves = [(start, middle), (middle, end)].map(|(start, end)| Piece::fit(width, start, end, &mut f));
            pieces.splice(worst..=worst, halves);
        }
        let column = |value: &dyn Fn(&Piece) -> f64| std::array::from_fn(|k| T::from_f64(value(&pieces[k])));
        Self {
            starts: column(&|piece| piece.start),
            middles: column(&|piece| 0.5 * (piece.start + piece.end)),
            scales: column(&|piece| 2.0 / (piece.end - piece.start)),
            functions: (0..width)
                .map(|function| std::array::from_fn(|power| column(&|piece| piece.fit[function][power])))
                .collect(),
            end: T::from_f64(*breaks.last().expect("two breaks")),
        }
    }

    /// Calls `out` with the number and the value of each function at `x`, clamped to the domain.
    #[inline(always)]
    pub(crate) fn lookup<V: Lanes<Scalar = T>>(&self, x: V, mut out: impl FnMut(usize, V)) {
        let x = x.max(V::splat(self.starts[0])).min(V::splat(self.end));
        // The last piece that begins at or below x, by bisection.
        let mut number = V::constant(0.0);
        for step in [8.0, 4.0, 2.0, 1.0] {
            let further = number.add(V::constant(step));
            number = x.where_less(further.select_from(&self.starts), number, further);
        }
        let position = x.sub(number.select_from(&self.middles)).mul(number.select_from(&self.scales));
        for (function, powers) in self.functions.iter().enumerate() {
            let mut value = number.select_from(&powers[DEGREE]);
            for power in powers[..DEGREE].iter().rev() {
                value = value.mul_add(position, number.select_from(power));
            }
            out(function, value);
        }
    }
}

impl Pieces<f32> {
    /// Adds all numbers to a table: starts, ends, middles and scales of the pieces, then for each function and power the coefficients of
    /// all pieces.
    pub(crate) fn print(&self, table: &mut Vec<f32>) {
        table.extend(self.starts);
        table.extend(&self.starts[1..]);
        table.push(self.end);
        table.extend(self.middles);
        table.extend(self.scales);
        table.extend(self.functions.iter().flatten().flatten());
    }
}

impl Piece {
    /// Interpolates at Chebyshev points and measures the error between them.
    fn fit(width: usize, start: f64, end: f64, f: &mut impl FnMut(f64, &mut [f64])) -> Self {
        let at = |t: f64| 0.5 * (start + end) + 0.5 * (end - start) * t;
        let nodes: [f64; DEGREE + 1] =
            std::array::from_fn(|k| -((2 * k + 1) as f64 / (2 * DEGREE + 2) as f64 * std::f64::consts::PI).cos());
        let mut values = vec![0.0; width];
        let mut samples = vec![[0.0; DEGREE + 1]; width];
        for (k, &t) in nodes.iter().enumerate() {
            f(at(t), &mut values);
            samples.iter_mut().zip(&values).for_each(|(row, &value)| row[k] = value);
        }
        let fit: Vec<_> = samples.iter().map(|row| interpolate(&nodes, row)).collect();
        let mut error = 0.0f64;
        for t in [-1.0, -0.85, -0.5, -0.13, 0.13, 0.5, 0.85, 1.0] {
            f(at(t), &mut values);
            for (powers, value) in fit.iter().zip(&values) {
                let got = powers.iter().rev().fold(0.0, |sum, power| sum * t + power);
                error = error.max((got - value).abs());
            }
        }
        Self { start, end, fit, error }
    }
}

/// The coefficients by ascending powers of the polynomial through points (Newton's differences, expanded).
pub(crate) fn interpolate<const N: usize>(nodes: &[f64; N], values: &[f64; N]) -> [f64; N] {
    let mut differences = *values;
    for k in 1..N {
        for i in (k..N).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (nodes[i] - nodes[i - k]);
        }
    }
    let mut powers = [0.0; N];
    for k in (0..N).rev() {
        for i in (0..N).rev() {
            powers[i] = if i > 0 { powers[i - 1] } else { 0.0 } - nodes[k] * powers[i];
        }
        powers[0] += differences[k];
    }
    powers
}

/// The fit of a type, which one of the two is.
pub(crate) fn of_precision<F: Any>(single: &'static dyn Any, double: &'static dyn Any) -> &'static F {
    [single, double].into_iter().find_map(|fit| fit.downcast_ref()).expect("f32 or f64")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_functions_with_a_kink_are_fitted() {
        let f = |x: f64| if x < 0.3 { x.exp() } else { (0.3f64).exp() + 2.0 * (x - 0.3) };
        let pieces = Pieces::<f64>::fit(2, &[0.0, 0.3, 2.0], |_| 1.0, |x, out| (out[0], out[1]) = (f(x), 1.0 - x));
        for k in 0..=200 {
            let x = f64::from(k) / 100.0;
            pieces.lookup(x, |function, value| {
                let want = if function == 0 { f(x) } else { 1.0 - x };
                assert!((value - want).abs() < 1e-11, "function {function} at {x}: {value} instead of {want}");
            });
        }
        pieces.lookup(5.0, |function, value| assert!(function == 0 || (value + 1.0f64).abs() < 1e-14));
    }
}
