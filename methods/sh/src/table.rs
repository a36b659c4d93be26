//! Piecewise-cubic tables of vector functions of one variable, split where the function has kinks.

use halflight_sh_kernels::Real;

/// A table of `width` values against `x`, interpolated by the cubic through the four nearest nodes of a segment. It is
/// continuous, and as accurate beside a kink as elsewhere.
#[derive(Debug)]
pub(crate) struct Table {
    width: usize,
    intervals: usize,
    segments: Vec<Segment>,
}

#[derive(Debug)]
struct Segment {
    start: f64,
    end: f64,
    /// `(intervals + 1)·width` values.
    nodes: Vec<f64>,
}

impl Table {
    /// Samples `f`, which writes `width` values, at `intervals + 1` (at least 4) nodes between each two of the ascending
    /// `breaks`: the domain's ends and the kinks between them.
    pub(crate) fn sample(width: usize, breaks: &[f64], intervals: usize, mut f: impl FnMut(f64, &mut [f64])) -> Self {
        let segments = breaks
            .windows(2)
            .map(|ends| {
                let (start, end) = (ends[0], ends[1]);
                let mut nodes = vec![0.0; (intervals + 1) * width];
                for (k, out) in nodes.chunks_exact_mut(width).enumerate() {
                    let t = k as f64 / intervals as f64;
                    f(start + t * (end - start), out);
                }
                Segment { start, end, nodes }
            })
            .collect();
        Self { width, intervals, segments }
    }

    /// Writes the interpolated values at `x`, clamped to the domain (NaN counts as the start).
    pub(crate) fn lookup<T: Real>(&self, x: T, out: &mut [T]) {
        assert_eq!(out.len(), self.width, "the table holds {} values a node", self.width);
        let x = x.to_f64();
        let last = self.segments.len() - 1;
        let segment = self.segments[..last].iter().find(|s| x < s.end).unwrap_or(&self.segments[last]);
        let unit = (x - segment.start) / (segment.end - segment.start);
        let unit = if unit > 0.0 { unit.min(1.0) } else { 0.0 };
        let position = unit * self.intervals as f64;
        let first = (position as usize).saturating_sub(1).min(self.intervals - 3);
        let weights = cubic_weights(position - first as f64).map(T::from_f64);
        let rows: [&[f64]; 4] = std::array::from_fn(|k| {
            let start = (first + k) * self.width;
            &segment.nodes[start..start + self.width]
        });
        for (column, value) in out.iter_mut().enumerate() {
            let terms = weights.iter().zip(rows).map(|(&w, row)| w * T::from_f64(row[column]));
            *value = terms.fold(T::ZERO, |sum, term| sum + term);
        }
    }
}

/// The Lagrange weights of the nodes 0, 1, 2, 3 at `t`.
fn cubic_weights(t: f64) -> [f64; 4] {
    let (a, b, c, d) = (t, t - 1.0, t - 2.0, t - 3.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_with_a_kink_are_reproduced() {
        let f = |x: f64| if x < 0.3 { 1.0 + x * x * x } else { 1.027 - (x - 0.3) * (1.0 + x * x) };
        let table = Table::sample(1, &[0.0, 0.3, 1.0], 5, |x, out| out[0] = f(x));
        for k in 0..=100 {
            let x = f64::from(k) / 100.0;
            let mut out = [0.0];
            table.lookup(x, &mut out);
            assert!((out[0] - f(x)).abs() < 1e-14, "at {x}: {} instead of {}", out[0], f(x));
        }
    }

    /// Midway between the inner nodes the cubic of `x⁴` errs by 9/16 of the fourth power of the spacing, the least possible.
    #[test]
    fn the_four_nearest_nodes_are_used() {
        let table = Table::sample(1, &[0.0, 1.0], 10, |x, out| out[0] = x.powi(4));
        let mut out = [0.0];
        table.lookup(0.45, &mut out);
        assert!((out[0] - 0.45f64.powi(4)).abs() < 0.5626e-4);
    }

    #[test]
    fn outside_the_domain_the_ends_hold() {
        let table = Table::sample(1, &[1.0, 2.0], 3, |x, out| out[0] = x);
        for (x, want) in [(-5.0f32, 1.0), (7.0, 2.0), (f32::NAN, 1.0), (f32::INFINITY, 2.0)] {
            let mut out = [0.0];
            table.lookup(x, &mut out);
            assert_eq!(out[0], want);
        }
    }
}
