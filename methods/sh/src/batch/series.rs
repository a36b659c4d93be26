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
        let (batch, size) = (self.batch, self.residual.len());
        self.powers.resize_with(self.powers.len().max(degree / 2), || vec![Block::ZERO; size]);
        for k in 1..=degree / 2 {
            let (done, rest) = self.powers.split_at_mut(k - 1);
            match k {
                1 => batch.square(&self.residual, &mut rest[0]),
                _ if k % 2 == 0 => batch.square(&done[k / 2 - 1], &mut rest[0]),
                _ => batch.product(&done[k - 2], &done[0], &mut rest[0]),
            }
            *if k > 1 && k % 2 == 1 { &mut work.products } else { &mut work.squares } += 1;
        }
        // 1/k! for even and odd powers; the first odd one stands for the residual itself
        let [mut even, mut odd] = [[T::ZERO; MAX_DEGREE / 2]; 2];
        let mut reciprocal = 1.0;
        for (k, (even, odd)) in even.iter_mut().zip(&mut odd).enumerate() {
            reciprocal /= (2 * k + 2) as f64;
            *even = T::from_f64(reciprocal);
            reciprocal /= (2 * k + 3) as f64;
            *odd = T::from_f64(reciprocal);
        }
        let powers = &self.powers[..degree / 2];
        if degree < 3 {
            let sum = Polynomial { first: Some(&self.residual), factors: &even, powers, out: &mut self.value };
            run(batch.simd(), sum);
        } else {
            let odd = &odd[..(degree - 1) / 2];
            run(batch.simd(), Polynomial { first: None, factors: odd, powers, out: &mut self.value });
            batch.product(&self.residual, &self.value, &mut self.next);
            let sum = Polynomial { first: Some(&self.next), factors: &even, powers, out: &mut self.value };
            run(batch.simd(), sum);
            work.products += 1;
        }
        work
    }
}

/// `out = 1 + first + Σ factor·power`, for as many powers as there are factors.
struct Polynomial<'a, T> {
    first: Option<&'a [Block<T>]>,
    factors: &'a [T],
    powers: &'a [Vec<Block<T>>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for Polynomial<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let mut one = V::constant(SQRT_4_PI);
        for (i, out) in self.out.iter_mut().enumerate() {
            for part in 0..LANES / V::WIDTH {
                let mut sum = one;
                for (power, &factor) in self.powers.iter().zip(self.factors) {
                    sum = V::load(&power[i].0, part).mul_add(V::splat(factor), sum);
                }
                if let Some(first) = self.first {
                    sum = sum.add(V::load(&first[i].0, part));
                }
                sum.store(&mut out.0, part);
            }
            one = V::constant(0.0);
        }
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
