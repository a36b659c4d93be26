//! The whole product series for batches, without eigenvectors.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::{Batch, BatchExp};
use crate::exp::{ExpWorkspace, Work};
use crate::order::SQRT_4_PI;

/// Vectors whose mean is further from 0 are left to [`ExpWorkspace`], which keeps results below 1e30.
const MAX_MEAN: f64 = 50.0;

/// Chebyshev terms below this are left out: no result is shorter than 1.
const SMALLEST_TERM: f64 = 1e-9;

/// Radii of spectra are raised to this, so that what grows with their reciprocal stays in range.
const LEAST_RADIUS: f64 = 0.01;

/// More terms than any radius needs that is not left to [`ExpWorkspace`].
const MAX_TERMS: usize = 64;

/// Vectors in double precision.
#[derive(Clone, Debug, Default)]
pub(super) struct Wide {
    /// `2 f̂/r`.
    slope: Vec<Block<f64>>,
    product: Vec<Block<f64>>,
    newer: Vec<Block<f64>>,
    older: Vec<Block<f64>>,
    /// Chebyshev coefficients by ascending degree.
    terms: Vec<Block<f64>>,
}

impl<T: Real> BatchExp<T> {
    /// The exponential of [`ExpWorkspace::eigen`], the whole product series.
    ///
    /// `e^M 1` of the product matrix M is summed in Chebyshev polynomials of M, a product in `f64` for each degree (Clenshaw's
    /// recurrence), over an interval that holds all eigenvalues: those of the vector without its mean lie within
    /// `±r = ±n‖f̂‖/√4π`. Its result is no shorter than 1 (Jensen's inequality: M's mean over 1 is 0), so that the relative
    /// error is about `e^r` roundings of `f64`. Lanes for which that is more than a rounding of `T` are left to
    /// [`ExpWorkspace`]: those of `r` above 18 in `f32`, all in `f64`.
    ///
    /// # Panics
    /// As [`BatchExp::hybrid`].
    pub fn eigen(&mut self, f: &[Block<T>], out: &mut [Block<T>], work: &mut [Work]) {
        let most_radius = (T::EPSILON.to_f64() / (8.0 * f64::EPSILON)).ln();
        self.for_groups(f, out, work, |this, f, out, work| {
            let (mut extreme, mut factor) = ([false; LANES], [0.0; LANES]);
            this.wide.start(f.len());
            for lane in 0..work.len() {
                let mean = f[0].0[lane].to_f64() / SQRT_4_PI;
                let tame = mean.abs() <= MAX_MEAN && this.wide.expand(this.batch.order(), f, lane, most_radius);
                (extreme[lane], factor[lane]) = (!tame, if tame { mean.exp() } else { 0.0 });
            }
            this.wide.sum(this.batch);
            for (out, value) in out.iter_mut().zip(&this.wide.newer) {
                *out = Block(std::array::from_fn(|lane| T::from_f64(factor[lane] * value.0[lane])));
            }
            this.redo(&extreme, f, out, work, ExpWorkspace::eigen);
        });
    }
}

impl Wide {
    fn start(&mut self, size: usize) {
        for vector in [&mut self.slope, &mut self.product, &mut self.newer, &mut self.older] {
            vector.clear();
            vector.resize(size, Block::ZERO);
        }
        self.terms.clear();
    }

    /// Sets a lane's slope and terms; false if its spectrum may be wider than `most_radius`.
    fn expand<T: Real>(&mut self, order: usize, f: &[Block<T>], lane: usize, most_radius: f64) -> bool {
        let squares: f64 = f[1..].iter().map(|block| block.0[lane].to_f64().powi(2)).sum();
        let bound = order as f64 * squares.sqrt() / SQRT_4_PI;
        if bound.is_nan() || bound > most_radius {
            return false;
        }
        let radius = bound.max(LEAST_RADIUS);
        for (slope, block) in self.slope.iter_mut().zip(f).skip(1) {
            slope.0[lane] = 2.0 / radius * block.0[lane].to_f64();
        }
        let (terms, count) = chebyshev_terms(radius);
        self.terms.resize(self.terms.len().max(count), Block::ZERO);
        self.terms.iter_mut().zip(&terms[..count]).for_each(|(block, &term)| block.0[lane] = term);
        true
    }

    /// Leaves the sums of the series in `newer`. Terms that a lane does not have are 0 and change nothing in it.
    fn sum(&mut self, batch: Batch) {
        for (degree, term) in self.terms.iter().enumerate().rev() {
            if degree + 1 < self.terms.len() {
                batch.product(&self.slope, &self.newer, &mut self.product); // of 0 at first
            }
            // the last step is `c_0 + x b_1 - b_2`, the others have 2x
            let factor = if degree == 0 { 0.5 } else { 1.0 };
            run(batch.simd(), Step { factor, term, product: &self.product, sum: &mut self.older });
            std::mem::swap(&mut self.newer, &mut self.older);
        }
    }
}

/// The Chebyshev coefficients of `e^(radius·x)`, which are `I_0` and `2 I_k` at the radius, and how many there are to count.
///
/// By Miller's recurrence from a degree where they are negligible, normalised by their sum, `e^radius`.
fn chebyshev_terms(radius: f64) -> ([f64; MAX_TERMS], usize) {
    let mut terms = [0.0; MAX_TERMS];
    let top = (14.0 + 2.0 * radius).min((MAX_TERMS - 2) as f64) as usize;
    terms[top] = 1e-200;
    let step = 2.0 / radius;
    for k in (0..top).rev() {
        terms[k] = terms[k + 2] + step * (k + 1) as f64 * terms[k + 1];
    }
    let sum = terms[0] + 2.0 * terms[1..].iter().sum::<f64>();
    let scale = 2.0 * radius.exp() / sum;
    terms.iter_mut().for_each(|term| *term *= scale);
    terms[0] *= 0.5;
    let count = terms[..top].iter().rposition(|&term| term > SMALLEST_TERM).map_or(1, |last| last + 1);
    (terms, count)
}

/// `sum = factor·product - sum + term·1`.
struct Step<'a> {
    factor: f64,
    term: &'a Block<f64>,
    product: &'a [Block<f64>],
    sum: &'a mut [Block<f64>],
}

impl Task<f64> for Step<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f64>>(self) {
        for part in 0..LANES / V::WIDTH {
            for (product, sum) in self.product.iter().zip(&mut *self.sum) {
                let scaled = V::load(&product.0, part).mul(V::splat(self.factor));
                scaled.sub(V::load(&sum.0, part)).store(&mut sum.0, part);
            }
            let first = &mut self.sum[0].0;
            V::load(&self.term.0, part).mul_add(V::constant(SQRT_4_PI), V::load(first, part)).store(first, part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_sum_to_the_exponential() {
        for radius in [LEAST_RADIUS, 0.1, 1.0, 4.0, 10.0, 18.0] {
            let (terms, count) = chebyshev_terms(radius);
            for x in [-1.0, -0.6, 0.0, 0.3, 1.0f64] {
                let sum: f64 = (0..count).map(|k| terms[k] * (k as f64 * x.acos()).cos()).sum();
                assert!((sum - (radius * x).exp()).abs() < 3e-9 + 1e-14 * radius.exp(), "e^({radius}·{x}): {sum}");
            }
        }
    }
}
