//! The product series for batches, plain (PS-p) and scaled, squared and factored (PS*-p).

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::BatchExp;
use super::exp::Scale;
use crate::exp::{SquaringRule, Work};
use crate::order::SQRT_4_PI;

/// The highest degree of PS*-p, as for [`ExpWorkspace`](crate::ExpWorkspace).
const MAX_DEGREE: usize = 20;

impl<T: Real> BatchExp<T> {
    /// PS-p, see [`ExpWorkspace::product_series`](crate::ExpWorkspace::product_series).
    ///
    /// # Panics
    /// As [`BatchExp::hybrid`].
    pub fn product_series(&mut self, degree: usize, f: &[Block<T>], out: &mut [Block<T>], work: &mut [Work]) {
        let unsquared = SquaringRule { offset: -1000.0 };
        self.for_groups(f, out, work, |this, f, out, work| {
            let (batch, group) = (this.batch, this.isolate(unsquared, f64::INFINITY, f));
            out.fill(Block::ZERO);
            out[0] = Block::splat(T::from_f64(SQRT_4_PI));
            for power in 1..=degree {
                match power {
                    1 => this.next.copy_from_slice(f), // f * 1 = f
                    2 => batch.square(f, &mut this.next),
                    _ => batch.product(f, &this.value, &mut this.next),
                }
                let factor = Block::splat(T::from_f64(1.0 / power as f64));
                run(batch.simd(), Scale { factor: &factor, x: &this.next, out: &mut this.value });
                run(batch.simd(), AddScaled { factor: T::ONE, x: &this.value, sum: &mut *out });
            }
            let spent = Work { products: degree.saturating_sub(2) as u32, squares: u32::from(degree >= 2) };
            work.fill(spent);
            this.redo(&group.extreme, f, out, work, |one, f, out| one.product_series(degree, f, out));
        });
    }

    /// PS*-p, see [`ExpWorkspace::scaled_series`](crate::ExpWorkspace::scaled_series).
    ///
    /// # Panics
    /// If the degree is 0 or above 20; as [`BatchExp::hybrid`].
    pub fn scaled_series(
        &mut self,
        degree: usize,
        rule: SquaringRule,
        f: &[Block<T>],
        out: &mut [Block<T>],
        work: &mut [Work],
    ) {
        assert!((1..=MAX_DEGREE).contains(&degree), "PS*-p: degree {degree}, expected 1 to 20");
        // As in `ExpWorkspace`: more squarings only where the highest power would overflow.
        let limit = (80.0 / degree as f64).exp2();
        self.for_groups(f, out, work, |this, f, out, work| {
            let group = this.isolate(rule, limit, f);
            let spent = this.series(degree);
            work.iter_mut().for_each(|work| *work = spent);
            this.finish(&group, out, spent.squares, work);
            this.redo(&group.extreme, f, out, work, |one, f, out| one.scaled_series(degree, rule, f, out));
        });
    }

    /// The factored series of the residual.
    fn series(&mut self, degree: usize) -> Work {
        let mut work = Work::default();
        let (batch, zeros) = (self.batch, vec![Block::ZERO; self.residual.len()]);
        self.powers.resize(self.powers.len().max(degree / 2), zeros);
        for k in 1..=degree / 2 {
            let (done, rest) = self.powers.split_at_mut(k - 1);
            match k {
                1 => batch.square(&self.residual, &mut rest[0]),
                _ if k % 2 == 0 => batch.square(&done[k / 2 - 1], &mut rest[0]),
                _ => batch.product(&done[k - 2], &done[0], &mut rest[0]),
            }
            *if k > 1 && k % 2 == 1 { &mut work.products } else { &mut work.squares } += 1;
        }
        let one = T::from_f64(SQRT_4_PI);
        self.value.fill(Block::ZERO);
        self.value[0] = Block::splat(one);
        let mut odd = self.value.clone();
        let mut reciprocal = 1.0; // 1/(2k+1)!
        for (k, power) in self.powers.iter().take(degree / 2).enumerate() {
            let even = reciprocal / (2 * k + 2) as f64;
            reciprocal = even / (2 * k + 3) as f64;
            run(batch.simd(), AddScaled { factor: T::from_f64(even), x: power, sum: &mut self.value });
            if 2 * k + 3 <= degree {
                run(batch.simd(), AddScaled { factor: T::from_f64(reciprocal), x: power, sum: &mut odd });
            }
        }
        if degree < 3 {
            run(batch.simd(), AddScaled { factor: T::ONE, x: &self.residual, sum: &mut self.value });
        } else {
            batch.product(&self.residual, &odd, &mut self.next);
            run(batch.simd(), AddScaled { factor: T::ONE, x: &self.next, sum: &mut self.value });
            work.products += 1;
        }
        work
    }
}

/// `sum += factor·x`.
struct AddScaled<'a, T> {
    factor: T,
    x: &'a [Block<T>],
    sum: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for AddScaled<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for (x, sum) in self.x.iter().zip(self.sum) {
            for part in 0..LANES / V::WIDTH {
                let term = V::load(&x.0, part);
                term.mul_add(V::splat(self.factor), V::load(&sum.0, part)).store(&mut sum.0, part);
            }
        }
    }
}
