//! Linear operations in lanes: product matrices, triple products, dot products.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::Batch;
use crate::order::coefficients;

impl Batch {
    /// The products of one vector `a`, given by its product matrix (see
    /// [`Gamma::product_matrix`](crate::Gamma::product_matrix)), with every vector of `b`: `n⁴` multiply-adds each, which is
    /// less than a product takes from order 3 on.
    ///
    /// # Panics
    /// If the matrix does not hold `n⁴` entries, or the batches differ in size or do not hold whole vectors.
    pub fn matrix_product<T: Real>(&self, matrix: &[T], b: &[Block<T>], out: &mut [Block<T>]) {
        let size = coefficients(self.order);
        assert_eq!(matrix.len(), size * size, "a product matrix of order {} is {size}×{size}", self.order);
        self.assert_batches([b.len()], out.len());
        run(self.simd, Dense { size, matrix, x: b, out, stride: size });
    }

    /// The integrals of the products of three functions, lane by lane, one block for each `n²`; see
    /// [`Gamma::triple_product`](crate::Gamma::triple_product).
    ///
    /// # Panics
    /// If the batches differ in size, do not hold whole vectors, or `out` does not hold one block for each vector.
    pub fn triple_product<T: Real>(&self, a: &[Block<T>], b: &[Block<T>], c: &[Block<T>], out: &mut [Block<T>]) {
        let size = coefficients(self.order);
        self.assert_batches([a.len(), b.len()], c.len());
        assert_eq!(out.len() * size, c.len(), "one block for each vector of {size}");
        let mut product = [Block::ZERO; 64];
        let product = &mut product[..size];
        let vectors = a.chunks_exact(size).zip(b.chunks_exact(size)).zip(c.chunks_exact(size));
        for (((a, b), c), out) in vectors.zip(out) {
            self.product(a, b, product);
            run(self.simd, Dot { x: &*product, y: c, out });
        }
    }

    /// The dot product of one vector with the vector in each lane of a block.
    ///
    /// # Panics
    /// If `weights` and `vectors` do not hold one vector each.
    pub fn dot<T: Real>(&self, weights: &[T], vectors: &[Block<T>]) -> Block<T> {
        self.assert_batches([weights.len()], vectors.len());
        let mut out = Block::ZERO;
        run(self.simd, Weighted { weights, x: vectors, out: &mut out });
        out
    }

    /// The dot products of the vectors in the same lanes of two blocks.
    ///
    /// # Panics
    /// If `a` and `b` do not hold one block of vectors each.
    pub fn dot_each<T: Real>(&self, a: &[Block<T>], b: &[Block<T>]) -> Block<T> {
        self.assert_batches([a.len()], b.len());
        assert_eq!(a.len(), coefficients(self.order), "one block of vectors each");
        let mut out = Block::ZERO;
        run(self.simd, Dot { x: a, y: b, out: &mut out });
        out
    }

    /// Multiplies each block by a factor of its own, the same in all lanes.
    ///
    /// # Panics
    /// If there are not as many factors as blocks.
    pub fn scale<T: Real>(&self, factors: &[T], blocks: &mut [Block<T>]) {
        assert_eq!(factors.len(), blocks.len(), "one factor a block");
        run(self.simd, ScaleEach { factors, blocks });
    }

    /// Overwrites the lanes of `out` in which `values` exceeds `bound` with those of `input`.
    ///
    /// # Panics
    /// If the batches do not hold one block of vectors each.
    pub fn replace_above<T: Real>(&self, bound: T, values: &Block<T>, input: &[Block<T>], out: &mut [Block<T>]) {
        self.assert_batches([input.len()], out.len());
        assert_eq!(out.len(), coefficients(self.order), "one block of values, one of vectors");
        run(self.simd, Replace { bound, values, input, out });
    }
}

struct Weighted<'a, T> {
    weights: &'a [T],
    x: &'a [Block<T>],
    out: &'a mut Block<T>,
}

impl<T: Real> Task<T> for Weighted<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for part in 0..LANES / V::WIDTH {
            let mut sums = [V::constant(0.0); 4];
            for (i, (&weight, x)) in self.weights.iter().zip(self.x).enumerate() {
                sums[i % 4] = V::splat(weight).mul_add(V::load(&x.0, part), sums[i % 4]);
            }
            sums[0].add(sums[1]).add(sums[2].add(sums[3])).store(&mut self.out.0, part);
        }
    }
}

struct ScaleEach<'a, T> {
    factors: &'a [T],
    blocks: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for ScaleEach<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for (&factor, block) in self.factors.iter().zip(self.blocks) {
            for part in 0..LANES / V::WIDTH {
                V::load(&block.0, part).mul(V::splat(factor)).store(&mut block.0, part);
            }
        }
    }
}

struct Replace<'a, T> {
    bound: T,
    values: &'a Block<T>,
    input: &'a [Block<T>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for Replace<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for part in 0..LANES / V::WIDTH {
            let values = V::load(&self.values.0, part);
            for (input, out) in self.input.iter().zip(&mut *self.out) {
                let (new, old) = (V::load(&input.0, part), V::load(&out.0, part));
                V::splat(self.bound).where_less(values, new, old).store(&mut out.0, part);
            }
        }
    }
}

/// A square matrix times the leading coefficients of vectors that are `stride` blocks apart.
pub(super) struct Dense<'a, T> {
    pub(super) size: usize,
    pub(super) matrix: &'a [T],
    pub(super) x: &'a [Block<T>],
    pub(super) out: &'a mut [Block<T>],
    pub(super) stride: usize,
}

impl<T: Real> Task<T> for Dense<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let Self { size, matrix, x, out, stride } = self;
        for (x, out) in x.chunks(stride).zip(out.chunks_mut(stride)) {
            for part in 0..LANES / V::WIDTH {
                // Four rows at a time, so that their sums do not wait for one another.
                for (rows, out) in matrix.chunks(4 * size).zip(out[..size].chunks_mut(4)) {
                    let mut sums = [V::constant(0.0); 4];
                    for (column, x) in x[..size].iter().enumerate() {
                        let x = V::load(&x.0, part);
                        for (sum, row) in sums.iter_mut().zip(rows.chunks_exact(size)) {
                            *sum = V::splat(row[column]).mul_add(x, *sum);
                        }
                    }
                    out.iter_mut().zip(sums).for_each(|(out, sum)| sum.store(&mut out.0, part));
                }
            }
        }
    }
}

struct Dot<'a, T> {
    x: &'a [Block<T>],
    y: &'a [Block<T>],
    out: &'a mut Block<T>,
}

impl<T: Real> Task<T> for Dot<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for part in 0..LANES / V::WIDTH {
            let mut sums = [V::constant(0.0); 4];
            for (i, (x, y)) in self.x.iter().zip(self.y).enumerate() {
                sums[i % 4] = V::load(&x.0, part).mul_add(V::load(&y.0, part), sums[i % 4]);
            }
            sums[0].add(sums[1]).add(sums[2].add(sums[3])).store(&mut self.out.0, part);
        }
    }
}
