//! Exponentials of batches.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::Batch;
use super::eigen::Wide;
use crate::exp::{ExpWorkspace, SquaringRule, Work, linear_pieces, unclipped_norm};
use crate::order::{SQRT_4_PI, coefficients};

/// Vectors are left to [`ExpWorkspace`] where `n/√4π·‖f̂‖`, which bounds the eigenvalues, exceeds this: squares might
/// overflow `f32` on the way.
const MAX_EIGENVALUE: f64 = 40.0;

/// Likewise where the mean does.
const MAX_MEAN: f64 = 60.0;

/// The exponentials of [`ExpWorkspace`] for batches: one vector a lane, each squared as often as it needs.
///
/// A lane's result does not depend on the other lanes. Vectors of extreme length, whose squares might overflow on the way,
/// are handed to [`ExpWorkspace`], so that every finite input gives a finite output.
#[derive(Clone, Debug)]
pub struct BatchExp<T> {
    pub(super) batch: Batch,
    one: ExpWorkspace<T>,
    pub(super) residual: Vec<Block<T>>,
    pub(super) value: Vec<Block<T>>,
    pub(super) next: Vec<Block<T>>,
    pub(super) powers: Vec<Vec<Block<T>>>,
    pub(super) wide: Wide,
}

/// What the lanes of one group of vectors need.
#[derive(Clone, Copy)]
pub(super) struct Group<T> {
    /// `e^mean`, the factor that ends the exponential.
    factor: Block<T>,
    /// The norm of the residual, scaled.
    norm: Block<T>,
    /// Squarings of each lane.
    squarings: Block<T>,
    /// Lanes that [`ExpWorkspace`] takes.
    pub(super) extreme: [bool; LANES],
}

impl<T: Real> BatchExp<T> {
    /// The exponentials of an order by the instructions of `batch`.
    pub fn new(batch: Batch) -> Self {
        let zeros = vec![Block::ZERO; coefficients(batch.order())];
        Self {
            batch,
            one: ExpWorkspace::new(batch.order()),
            residual: zeros.clone(),
            value: zeros.clone(),
            next: zeros,
            powers: Vec::new(),
            wide: Wide::default(),
        }
    }

    /// The batch operations that it uses.
    pub fn batch(&self) -> Batch {
        self.batch
    }

    /// HYB, see [`ExpWorkspace::hybrid`]; writes the operations of each vector to `work`, whose length is the number of
    /// vectors.
    ///
    /// # Panics
    /// If the batches differ in size, do not hold whole vectors, or hold fewer vectors than `work`.
    pub fn hybrid(&mut self, rule: SquaringRule, f: &[Block<T>], out: &mut [Block<T>], work: &mut [Work]) {
        let limit = unclipped_norm(self.batch.order());
        self.for_groups(f, out, work, |this, f, out, work| {
            let group = this.isolate(rule, limit, f);
            this.linear(&group.norm);
            this.finish(&group, out, 0, work);
            this.redo(&group.extreme, f, out, work, |one, f, out| one.hybrid(rule, f, out));
        });
    }

    /// OL, see [`ExpWorkspace::optimal_linear`].
    ///
    /// # Panics
    /// As [`BatchExp::hybrid`].
    pub fn optimal_linear(&mut self, f: &[Block<T>], out: &mut [Block<T>], work: &mut [Work]) {
        self.for_groups(f, out, work, |this, f, out, work| {
            let mut group = this.isolate(SquaringRule { offset: -1000.0 }, f64::INFINITY, f);
            group.squarings = Block::ZERO;
            this.linear(&group.norm);
            this.finish(&group, out, 0, work);
            this.redo(&group.extreme, f, out, work, ExpWorkspace::optimal_linear);
        });
    }

    /// Calls `exp` with the blocks and works of each 16 vectors.
    pub(super) fn for_groups(
        &mut self,
        f: &[Block<T>],
        out: &mut [Block<T>],
        work: &mut [Work],
        mut exp: impl FnMut(&mut Self, &[Block<T>], &mut [Block<T>], &mut [Work]),
    ) {
        let size = coefficients(self.batch.order());
        self.batch.assert_batches([f.len()], out.len());
        assert!(work.len() <= f.len() / size * LANES, "work of {} vectors in {} blocks", work.len(), f.len());
        work.fill(Work::default());
        let mut works = work.chunks_mut(LANES);
        for (f, out) in f.chunks_exact(size).zip(out.chunks_exact_mut(size)) {
            exp(self, f, out, works.next().unwrap_or_default());
        }
    }

    /// DC isolation and scaling: stores the residual and tells what the lanes need.
    pub(super) fn isolate(&mut self, rule: SquaringRule, limit: f64, f: &[Block<T>]) -> Group<T> {
        let mut group =
            Group { factor: Block::ZERO, norm: Block::ZERO, squarings: Block::ZERO, extreme: [false; LANES] };
        let bound = MAX_EIGENVALUE * SQRT_4_PI / self.batch.order() as f64;
        let mut whole_norm = Block::ZERO;
        run(
            self.batch.simd(),
            Isolate {
                f,
                residual: &mut self.residual,
                group: &mut group,
                whole_norm: &mut whole_norm,
                scale: rule.offset.exp2(),
                limit,
            },
        );
        for (lane, extreme) in group.extreme.iter_mut().enumerate() {
            let tame = whole_norm.0[lane].to_f64() <= bound && f[0].0[lane].to_f64().abs() <= MAX_MEAN * SQRT_4_PI;
            *extreme = !tame;
            if *extreme {
                group.squarings.0[lane] = T::ZERO;
            }
        }
        group
    }

    /// `a·1 + b·f̂` of the residual.
    fn linear(&mut self, norm: &Block<T>) {
        let task = Linear { order: self.batch.order(), norm, residual: &self.residual, out: &mut self.value };
        run(self.batch.simd(), task);
    }

    /// Squares each lane as often as it needs, multiplies by `e^mean` and writes the result.
    pub(super) fn finish(&mut self, group: &Group<T>, out: &mut [Block<T>], spent: u32, work: &mut [Work]) {
        let most = group.squarings.0.iter().fold(T::ZERO, |most, &count| most.max(count)).to_f64() as u32;
        for round in 0..most {
            self.batch.square(&self.value, &mut self.next);
            let round = T::from_f64(f64::from(round));
            if group.squarings.0.iter().all(|&count| count > round) {
                std::mem::swap(&mut self.value, &mut self.next);
            } else {
                self.batch.replace_above(round, &group.squarings, &self.next, &mut self.value);
            }
        }
        run(self.batch.simd(), Scale { factor: &group.factor, x: &self.value, out });
        for (work, count) in work.iter_mut().zip(group.squarings.0) {
            work.squares = spent + count.to_f64() as u32;
        }
    }

    /// Computes extreme lanes, and those whose result is not finite, by themselves.
    pub(super) fn redo(
        &mut self,
        extreme: &[bool; LANES],
        f: &[Block<T>],
        out: &mut [Block<T>],
        work: &mut [Work],
        mut exp: impl FnMut(&mut ExpWorkspace<T>, &[T], &mut [T]) -> Work,
    ) {
        for (lane, &extreme) in extreme.iter().enumerate() {
            let finite = out.iter().all(|block| block.0[lane].is_finite());
            if extreme || !finite {
                let input: Vec<T> = f.iter().map(|block| block.0[lane]).collect();
                let mut result = input.clone();
                let spent = exp(&mut self.one, &input, &mut result);
                out.iter_mut().zip(result).for_each(|(block, value)| block.0[lane] = value);
                work.get_mut(lane).into_iter().for_each(|work| *work = spent);
            }
        }
    }
}

struct Isolate<'a, T> {
    f: &'a [Block<T>],
    residual: &'a mut [Block<T>],
    group: &'a mut Group<T>,
    whole_norm: &'a mut Block<T>,
    /// `2^offset` of the squaring rule.
    scale: f64,
    limit: f64,
}

impl<T: Real> Task<T> for Isolate<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for part in 0..LANES / V::WIDTH {
            let (zero, one) = (V::constant(0.0), V::constant(1.0));
            let mut squares = [zero; 2];
            for (i, block) in self.f.iter().enumerate().skip(1) {
                let x = V::load(&block.0, part);
                squares[i % 2] = x.mul_add(x, squares[i % 2]);
            }
            let norm = squares[0].add(squares[1]).sqrt();
            // as often as the rule asks for, and as brings the norm below the limit
            let asked = norm.mul(V::constant(self.scale)).exponent();
            let excess = norm.mul(V::constant(1.0 / self.limit)).max(V::constant(1e-30));
            let floor = excess.exponent();
            let forced = floor.pow2().where_less(excess, floor.add(one), floor);
            let count = zero.where_less(norm, asked.max(forced).max(zero).min(V::constant(60.0)), zero);
            let shrink = zero.sub(count).pow2();
            zero.store(&mut self.residual[0].0, part);
            for (block, residual) in self.f.iter().zip(&mut *self.residual).skip(1) {
                V::load(&block.0, part).mul(shrink).store(&mut residual.0, part);
            }
            let mean = V::load(&self.f[0].0, part).mul(V::constant(1.0 / SQRT_4_PI));
            exp(mean).store(&mut self.group.factor.0, part);
            norm.store(&mut self.whole_norm.0, part);
            norm.mul(shrink).store(&mut self.group.norm.0, part);
            count.store(&mut self.group.squarings.0, part);
        }
    }
}

/// `e^x` for `|x| ≤ 60`, clamped there, to two units in the last place of `f32`, eight of `f64`.
#[inline(always)]
fn exp<V: Lanes>(x: V) -> V {
    let x = x.max(V::constant(-MAX_MEAN)).min(V::constant(MAX_MEAN));
    let exponent = x.mul_add(V::constant(std::f64::consts::LOG2_E), V::constant(0.5)).floor();
    // ln 2 in two parts, the first short enough for exact multiples
    let high = 0.693_145_751_953_125;
    let rest = exponent.neg_mul_add(V::constant(high), x);
    let rest = exponent.neg_mul_add(V::constant(std::f64::consts::LN_2 - high), rest);
    let terms = if V::Scalar::EPSILON.to_f64() > 1e-10 { 8 } else { 14 };
    // Taylor's series on |x| ≤ ln 2/2
    let mut sum = V::constant(1.0);
    for k in (1..terms).rev() {
        sum = sum.mul(rest).mul_add(V::constant(1.0 / k as f64), V::constant(1.0));
    }
    sum.mul(exponent.pow2())
}

struct Linear<'a, T> {
    order: usize,
    norm: &'a Block<T>,
    residual: &'a [Block<T>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for Linear<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let pieces = (self.order > 1).then(|| linear_pieces::<T>(self.order));
        for part in 0..LANES / V::WIDTH {
            let norm = V::load(&self.norm.0, part);
            let mut factors = [V::constant(1.0); 2];
            if let Some((pieces, end)) = pieces {
                pieces.lookup(norm, |function, value| factors[function] = value);
                // past the end, the length of `b·f̂` stays
                factors[1] = factors[1].mul(V::constant(end).div(norm.max(V::constant(end))));
            }
            for (residual, out) in self.residual.iter().zip(&mut *self.out) {
                V::load(&residual.0, part).mul(factors[1]).store(&mut out.0, part);
            }
            factors[0].mul(V::constant(SQRT_4_PI)).store(&mut self.out[0].0, part);
        }
    }
}

/// `out = factor·x`, lane by lane.
pub(super) struct Scale<'a, T> {
    pub(super) factor: &'a Block<T>,
    pub(super) x: &'a [Block<T>],
    pub(super) out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for Scale<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for part in 0..LANES / V::WIDTH {
            let factor = V::load(&self.factor.0, part);
            for (x, out) in self.x.iter().zip(&mut *self.out) {
                V::load(&x.0, part).mul(factor).store(&mut out.0, part);
            }
        }
    }
}
