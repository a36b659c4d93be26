//! The numerically exact exponential, 16 vectors side by side.

use halflight_sh::{Block, LANES, Quadrature, coefficients, evaluate};

/// Exponents are cut off here: `e^69` is the largest value that leaves room for sums in `f32`.
const LARGEST: f32 = 69.0;

/// Directions spread over the sphere with the basis functions there.
pub(crate) struct Directions {
    size: usize,
    /// `order²` values a direction.
    basis: Vec<f32>,
    /// Solid angle of each; all together the sphere.
    weights: Vec<f32>,
}

impl Directions {
    /// Gauss–Legendre rings with twice as many directions each: exact for polynomials of degree `2·rings − 1`.
    pub(crate) fn new(order: usize, rings: usize) -> Self {
        let size = coefficients(order);
        let Quadrature { directions, weights } = Quadrature::exact(2 * rings - 1);
        let mut basis = Vec::with_capacity(directions.len() * size);
        let mut values = vec![0.0; size];
        for direction in directions {
            evaluate(order, direction, &mut values);
            basis.extend(values.iter().map(|value| *value as f32));
        }
        let weights = weights.iter().map(|weight| *weight as f32).collect();
        Directions { size, basis, weights }
    }

    /// `∫ exp(Σ f_i y_i(s)) y(s) ds` (Ren 2006, eq. 10) in each lane; `order²` blocks in and out.
    pub(crate) fn exp(&self, f: &[Block<f32>], out: &mut [Block<f32>]) {
        out.fill(Block::ZERO);
        for (basis, weight) in self.basis.chunks_exact(self.size).zip(&self.weights) {
            let mut value = [0.0; LANES];
            for (y, f) in basis.iter().zip(f) {
                value.iter_mut().zip(f.0).for_each(|(value, f)| *value += y * f);
            }
            let value = value.map(|value| weight * value.min(LARGEST).exp());
            for (y, out) in basis.iter().zip(&mut *out) {
                out.0.iter_mut().zip(value).for_each(|(out, value)| *out += y * value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_the_oracles_integral() {
        for order in [1, 2, 4, 6] {
            let wave = |i: usize, lane: usize| (((7 * i + 3 * lane) as f64).sin() - 0.4) * 0.25 * lane as f64;
            let size = coefficients(order);
            let f: Vec<Block<f32>> =
                (0..size).map(|i| Block(std::array::from_fn(|lane| wave(i, lane) as f32))).collect();
            let mut out = vec![Block::splat(f32::NAN); size];
            Directions::new(order, 32).exp(&f, &mut out);
            for lane in 0..LANES {
                let f: Vec<f64> = f.iter().map(|block| f64::from(block.0[lane])).collect();
                let mut exact = vec![0.0; size];
                halflight_sh::exp_exact(order, &f, &mut exact);
                let norm = exact.iter().map(|value| value * value).sum::<f64>().sqrt();
                for (got, exact) in out.iter().zip(&exact) {
                    assert!((f64::from(got.0[lane]) - exact).abs() < 2e-5 * norm, "order {order}, lane {lane}");
                }
            }
        }
    }

    #[test]
    fn beyond_all_bounds_it_stays_finite() {
        let f: Vec<Block<f32>> = (0..16).map(|i| Block::splat(if i % 2 == 0 { 1e4 } else { -1e4 })).collect();
        let mut out = vec![Block::ZERO; 16];
        Directions::new(4, 16).exp(&f, &mut out);
        assert!(out.iter().all(|block| block.0.iter().all(|value| value.is_finite())));
    }
}
