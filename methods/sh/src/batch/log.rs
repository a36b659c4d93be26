//! Logarithms of batches.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::Batch;
use crate::gamma::gamma;
use crate::log::{EIGENVALUE_CLIP, log_quotient};
use crate::order::{SQRT_4_PI, assert_order, coefficients};

/// Sweeps after which an eigenanalysis ends; six to eight are usual, and only NaN needs more than ten.
const MAX_SWEEPS: usize = 16;

/// The square of what is left beside the diagonal counts as nothing below this share of the whole.
const NEGLIGIBLE: f64 = 1e-31;

/// [`log_eigen`](crate::log_eigen) for batches: the eigenanalyses of 16 product matrices go on side by side.
///
/// Cyclic Jacobi rotations (Golub and Van Loan, §8.5) take more operations than the reduction to tridiagonal form that one vector
/// goes through, but the same ones in every lane, without branches. All is in `f64`.
#[derive(Clone, Debug)]
pub struct BatchLog {
    batch: Batch,
    /// The lower triangle by rows.
    matrix: Vec<Block<f64>>,
    vector: Vec<Block<f64>>,
    /// Cosine and sine of each rotation, in their order.
    turns: Vec<[Block<f64>; 2]>,
}

impl BatchLog {
    /// The logarithms of an order by the instructions of `batch`.
    pub fn new(batch: Batch) -> Self {
        assert_order(batch.order());
        let size = coefficients(batch.order());
        let (matrix, vector) = (vec![Block::ZERO; size * (size + 1) / 2], vec![Block::ZERO; size]);
        Self { batch, matrix, vector, turns: Vec::new() }
    }

    /// The logarithm that inverts the truncated exponential (Ren 2006, eqs. 30–32), lane by lane; `g` as
    /// [`log_eigen`](crate::log_eigen) asks for it.
    ///
    /// # Panics
    /// If the batches differ in size or do not hold `n²` blocks for each 16 vectors.
    pub fn eigen<T: Real>(&mut self, g: &[Block<T>], out: &mut [Block<T>]) {
        let size = self.vector.len();
        assert!(g.len() == out.len() && g.len().is_multiple_of(size), "n² blocks for each 16 vectors");
        for (g, out) in g.chunks_exact(size).zip(out.chunks_exact_mut(size)) {
            for (wide, block) in self.vector.iter_mut().zip(g) {
                *wide = Block(std::array::from_fn(|lane| block.0[lane].to_f64()));
            }
            self.fill_matrix();
            self.vector[0].0.iter_mut().for_each(|value| *value -= SQRT_4_PI);
            self.diagonalise();
            self.scale();
            run(self.batch.simd(), Back { vector: &mut self.vector, turns: &self.turns });
            for (out, wide) in out.iter_mut().zip(&self.vector) {
                *out = Block(std::array::from_fn(|lane| T::from_f64(wide.0[lane])));
            }
        }
    }

    /// The product matrix `Σ_k Γ_ijk g_k`.
    fn fill_matrix(&mut self) {
        self.matrix.fill(Block::ZERO);
        for triple in gamma(self.batch.order()).triples() {
            let [i, j, k] = [triple.i, triple.j, triple.k].map(usize::from);
            let places = [(j, i, k), (k, i, j), (k, j, i)];
            for (at, &(row, column, factor)) in places.iter().enumerate() {
                // Equal indices name the same entry and the same factor more than once.
                if !places[..at].contains(&(row, column, factor)) {
                    let entry = &mut self.matrix[below(row, column)].0;
                    let factor = &self.vector[factor].0;
                    entry.iter_mut().zip(factor).for_each(|(sum, g)| *sum += triple.value * g);
                }
            }
        }
    }

    fn diagonalise(&mut self) {
        self.turns.clear();
        for _ in 0..MAX_SWEEPS {
            let (simd, mut done, size) = (self.batch.simd(), false, self.vector.len());
            run(simd, Diagonal { size, matrix: &self.matrix, reached: &mut done });
            if done {
                return;
            }
            let first = self.turns.len();
            self.turns.resize(first + size * (size - 1) / 2, [Block::ZERO; 2]);
            run(simd, Sweep { matrix: &mut self.matrix, vector: &mut self.vector, turns: &mut self.turns[first..] });
        }
    }

    /// The function of the eigenvalues, which stand on the diagonal now.
    fn scale(&mut self) {
        for lane in 0..LANES {
            let value = |i: usize| self.matrix[below(i, i)].0[lane];
            let largest = (0..self.vector.len()).map(value).fold(f64::NEG_INFINITY, f64::max);
            for (i, entry) in self.vector.iter_mut().enumerate() {
                let value = self.matrix[below(i, i)].0[lane];
                entry.0[lane] *= log_quotient(value.max(EIGENVALUE_CLIP * largest));
            }
        }
    }
}

/// Where the entry of a row and a column not after it stands.
#[inline(always)]
fn below(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Whether all lanes are diagonal.
struct Diagonal<'a> {
    size: usize,
    matrix: &'a [Block<f64>],
    reached: &'a mut bool,
}

impl Task<f64> for Diagonal<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f64>>(self) {
        *self.reached = true;
        for part in 0..LANES / V::WIDTH {
            let (mut whole, mut beside) = (V::splat(0.0), V::splat(0.0));
            for row in 0..self.size {
                for column in 0..row {
                    let entry = V::load(&self.matrix[below(row, column)].0, part);
                    beside = entry.mul_add(entry, beside);
                }
                let entry = V::load(&self.matrix[below(row, row)].0, part);
                whole = entry.mul_add(entry, whole);
            }
            *self.reached &= !whole.mul(V::splat(NEGLIGIBLE)).any_less(beside);
        }
    }
}

/// A rotation for every entry beside the diagonal, which makes it 0.
struct Sweep<'a> {
    matrix: &'a mut [Block<f64>],
    vector: &'a mut [Block<f64>],
    turns: &'a mut [[Block<f64>; 2]],
}

impl Task<f64> for Sweep<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f64>>(self) {
        let size = self.vector.len();
        for part in 0..LANES / V::WIDTH {
            let mut turns = self.turns.iter_mut();
            for p in 0..size {
                for q in p + 1..size {
                    let (cosine, sine) = annihilate::<V>(self.matrix, p, q, part);
                    for k in 0..p {
                        turn::<V>(self.matrix, below(p, k), below(q, k), cosine, sine, part);
                    }
                    for k in p + 1..q {
                        turn::<V>(self.matrix, below(k, p), below(q, k), cosine, sine, part);
                    }
                    for k in q + 1..size {
                        turn::<V>(self.matrix, below(k, p), below(k, q), cosine, sine, part);
                    }
                    turn::<V>(self.vector, p, q, cosine, sine, part);
                    let [cosines, sines] = turns.next().expect("a turn an entry");
                    cosine.store(&mut cosines.0, part);
                    sine.store(&mut sines.0, part);
                }
            }
        }
    }
}

/// Makes the entry of two coordinates 0, and their entries on the diagonal what they become; cosine and sine of the rotation.
#[inline(always)]
fn annihilate<V: Lanes<Scalar = f64>>(matrix: &mut [Block<f64>], p: usize, q: usize, part: usize) -> (V, V) {
    let (pp, qq, qp) = (below(p, p), below(q, q), below(q, p));
    let (a, b, beside) = (V::load(&matrix[pp].0, part), V::load(&matrix[qq].0, part), V::load(&matrix[qp].0, part));
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    let (difference, twice) = (b.sub(a), beside.add(beside));
    let sign = difference.where_less(zero, V::splat(-1.0), one);
    let longest = twice.mul_add(twice, difference.mul(difference)).sqrt();
    // Both are 0 where there is nothing to do; then the tangent is 0 as well.
    let denominator = sign.mul(difference).add(longest).max(V::splat(f64::MIN_POSITIVE));
    let tangent = sign.mul(twice).div(denominator);
    let cosine = one.div(tangent.mul_add(tangent, one).sqrt());
    tangent.neg_mul_add(beside, a).store(&mut matrix[pp].0, part);
    tangent.mul_add(beside, b).store(&mut matrix[qq].0, part);
    zero.store(&mut matrix[qp].0, part);
    (cosine, cosine.mul(tangent))
}

/// Turns the values at two places.
#[inline(always)]
fn turn<V: Lanes<Scalar = f64>>(values: &mut [Block<f64>], at_p: usize, at_q: usize, cosine: V, sine: V, part: usize) {
    let (p, q) = (V::load(&values[at_p].0, part), V::load(&values[at_q].0, part));
    sine.neg_mul_add(q, cosine.mul(p)).store(&mut values[at_p].0, part);
    sine.mul_add(p, cosine.mul(q)).store(&mut values[at_q].0, part);
}

/// All rotations backwards.
struct Back<'a> {
    vector: &'a mut [Block<f64>],
    turns: &'a [[Block<f64>; 2]],
}

impl Task<f64> for Back<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f64>>(self) {
        let size = self.vector.len();
        for part in 0..LANES / V::WIDTH {
            let mut turns = self.turns.iter().rev();
            for _ in 0..self.turns.len() / (size * (size - 1) / 2).max(1) {
                for p in (0..size).rev() {
                    for q in (p + 1..size).rev() {
                        let [cosines, sines] = turns.next().expect("a turn an entry");
                        let (cosine, sine) = (V::load(&cosines.0, part), V::load(&sines.0, part));
                        turn::<V>(self.vector, p, q, cosine, V::splat(0.0).sub(sine), part);
                    }
                }
            }
        }
    }
}
