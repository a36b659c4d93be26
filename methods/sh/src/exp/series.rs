//! The product series, plain (PS-p) and scaled, squared and factored (PS*-p).

use super::{ExpWorkspace, SquaringRule, Work, renormalise, restore, scale_by_power};
use crate::order::{SQRT_4_PI, assert_vector};
use halflight_sh_kernels::Real;

/// The highest degree of PS*-p.
const MAX_FACTORED_DEGREE: usize = 20;

impl<T: Real> ExpWorkspace<T> {
    /// PS-p: the product series `1 + f + f*f/2 + …` to `degree`, powers amassed from left to right (Ren 2006, eq. 17).
    ///
    /// It converges only once the degree is well above the magnitude of the most negative eigenvalue of `f`'s product
    /// matrix, and rounding then limits it: at -16.5 no degree gives two digits in `f32`.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn product_series(&mut self, degree: usize, f: &[T], out: &mut [T]) -> Work {
        assert_vector(self.order, f);
        assert_vector(self.order, out);
        // f, the running term and the sum each carry a power of two.
        self.residual.copy_from_slice(f);
        let f_exponent = renormalise(&mut self.residual);
        out.fill(T::ZERO);
        out[0] = T::from_f64(SQRT_4_PI);
        self.term.copy_from_slice(out);
        let (mut term_exponent, mut sum_exponent) = (0.0, 0.0);
        for power in 1..=degree {
            if power == 1 {
                self.term.copy_from_slice(&self.residual); // f * 1 = f
            } else {
                self.batch.single_product(&self.residual, &self.term, &mut self.scratch);
                let divisor = T::from_f64(power as f64);
                self.term.iter_mut().zip(&self.scratch).for_each(|(t, &v)| *t = v / divisor);
            }
            term_exponent += f_exponent + renormalise(&mut self.term);
            if term_exponent > sum_exponent {
                scale_by_power(out, (sum_exponent - term_exponent).max(-2000.0) as i32);
                sum_exponent = term_exponent;
            }
            let shift = T::from_f64((term_exponent - sum_exponent).exp2());
            out.iter_mut().zip(&self.term).for_each(|(sum, &t)| *sum += shift * t);
        }
        restore(out, sum_exponent, 0.0);
        Work { products: degree.saturating_sub(2) as u32, squares: u32::from(degree >= 2) }
    }

    /// PS*-p: DC isolation (20), scaling and squaring (21), and the series of `degree` p split into even and odd powers
    /// (Ren 2006, eq. 22): `⌊p/2⌋` even powers and, from degree 3, one more product.
    ///
    /// # Panics
    /// If the degree is 0 or above 20, or a slice does not hold `n²` coefficients.
    pub fn scaled_series(&mut self, degree: usize, rule: SquaringRule, f: &[T], out: &mut [T]) -> Work {
        assert_vector(self.order, out);
        assert!((1..=MAX_FACTORED_DEGREE).contains(&degree), "PS*-p: degree {degree}, expected 1 to 20");
        let (mean, norm) = self.isolate_mean(f);
        // More squarings than the rule asks for only where the highest power would overflow f32.
        let squarings = rule.count(norm, (80.0 / degree as f64).exp2());
        scale_by_power(&mut self.residual, -squarings);
        let mut work = self.factored_series(degree, out);
        let exponent = self.square_repeatedly(out, squarings);
        restore(out, exponent, mean);
        work.squares += squarings as u32;
        work
    }

    /// The factored series of the stored residual.
    fn factored_series(&mut self, degree: usize, out: &mut [T]) -> Work {
        let mut work = self.even_powers(degree / 2);
        let size = out.len();
        out.fill(T::ZERO);
        self.term.fill(T::ZERO);
        out[0] = T::from_f64(SQRT_4_PI);
        self.term[0] = out[0];
        let mut reciprocal = 1.0; // 1/(2k+1)!
        for (k, power) in self.powers.chunks_exact(size).take(degree / 2).enumerate() {
            let even = reciprocal / (2 * k + 2) as f64;
            reciprocal = even / (2 * k + 3) as f64;
            add_scaled(out, even, power);
            if 2 * k + 3 <= degree {
                add_scaled(&mut self.term, reciprocal, power);
            }
        }
        if degree < 3 {
            add_scaled(out, 1.0, &self.residual); // the odd factor is 1
        } else {
            self.batch.single_product(&self.residual, &self.term, &mut self.scratch);
            add_scaled(out, 1.0, &self.scratch);
            work.products += 1;
        }
        work
    }

    /// Stores the powers 2, 4, …, `2·count` of the residual, by squaring where the half power is at hand.
    fn even_powers(&mut self, count: usize) -> Work {
        let size = self.residual.len();
        if self.powers.len() < count * size {
            self.powers.resize(count * size, T::ZERO);
        }
        let mut work = Work::default();
        for k in 1..=count {
            let (done, rest) = self.powers.split_at_mut((k - 1) * size);
            let power = |k: usize| &done[(k - 1) * size..k * size];
            let next = &mut rest[..size];
            match k {
                1 => self.batch.single_square(&self.residual, next),
                _ if k % 2 == 0 => self.batch.single_square(power(k / 2), next),
                _ => self.batch.single_product(power(k - 1), power(1), next),
            }
            *if k > 1 && k % 2 == 1 { &mut work.products } else { &mut work.squares } += 1;
        }
        work
    }
}

fn add_scaled<T: Real>(sum: &mut [T], factor: f64, vector: &[T]) {
    let factor = T::from_f64(factor);
    sum.iter_mut().zip(vector).for_each(|(s, &v)| *s += factor * v);
}
