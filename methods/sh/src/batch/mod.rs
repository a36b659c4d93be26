//! Operations on batches of vectors.

mod basis;
mod circles;
mod eigen;
mod exp;
mod guard;
mod linear;
mod log;
mod rotation;
mod series;

pub(crate) use circles::circle_log_fits;
pub use exp::BatchExp;
pub use log::BatchLog;

use halflight_sh_kernels::{Block, Real, Simd};

use crate::order::{MAX_COEFFICIENTS, assert_order, assert_vector, coefficients};

/// The operations of one order on batches of vectors in [`Block`]s, by the widest instructions that the machine has.
///
/// A lane's result does not depend on what the other lanes hold. Between instruction sets results differ by rounding.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    order: usize,
    simd: Simd,
}

/// The product `a * b` of one pair of vectors by the fastest code for this machine; see
/// [`Gamma::product`](crate::Gamma::product), the plain loop over the same.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER) or a slice does not hold `n²` coefficients.
pub fn product<T: Real>(order: usize, a: &[T], b: &[T], out: &mut [T]) {
    Batch::new(order).single_product(a, b, out);
}

/// The square `a * a` of one vector by the fastest code for this machine; see [`Gamma::square`](crate::Gamma::square).
///
/// # Panics
/// As [`product`].
pub fn square<T: Real>(order: usize, a: &[T], out: &mut [T]) {
    Batch::new(order).single_square(a, out);
}

impl Batch {
    /// The operations of an order.
    ///
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
    pub fn new(order: usize) -> Self {
        assert_order(order);
        Self { order, simd: Simd::best() }
    }

    /// The operations of an order by a given instruction set, if the machine has it.
    ///
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
    pub fn with_simd(order: usize, simd: Simd) -> Option<Self> {
        assert_order(order);
        simd.is_available().then_some(Self { order, simd })
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The instruction set.
    pub fn simd(&self) -> Simd {
        self.simd
    }

    /// The products of the vectors in `a` and `b`, lane by lane; see [`Gamma::product`](crate::Gamma::product).
    ///
    /// # Panics
    /// If the batches differ in size or do not hold whole vectors.
    pub fn product<T: Real>(&self, a: &[Block<T>], b: &[Block<T>], out: &mut [Block<T>]) {
        self.assert_batches([a.len(), b.len()], out.len());
        T::products(self.simd, self.order, a, b, out);
    }

    /// The squares of the vectors in `a`, lane by lane; see [`Gamma::square`](crate::Gamma::square).
    ///
    /// # Panics
    /// If the batches differ in size or do not hold whole vectors.
    pub fn square<T: Real>(&self, a: &[Block<T>], out: &mut [Block<T>]) {
        self.assert_batches([a.len()], out.len());
        T::squares(self.simd, self.order, a, out);
    }

    /// The products of vectors that lie one after another.
    ///
    /// # Panics
    /// If the slices differ in length or do not hold whole vectors.
    pub fn product_vectors<T: Real>(&self, a: &[T], b: &[T], out: &mut [T]) {
        self.assert_batches([a.len(), b.len()], out.len());
        T::product_vectors(self.simd, self.order, a, b, out);
    }

    /// The product of one pair of vectors.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn single_product<T: Real>(&self, a: &[T], b: &[T], out: &mut [T]) {
        self.assert_vectors([a.len(), b.len(), out.len()]);
        T::product(self.simd, self.order, a, b, out);
    }

    /// The square of one vector.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn single_square<T: Real>(&self, a: &[T], out: &mut [T]) {
        self.assert_vectors([a.len(), out.len()]);
        T::square(self.simd, self.order, a, out);
    }

    /// The integral of the product of three functions.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn single_triple_product<T: Real>(&self, a: &[T], b: &[T], c: &[T]) -> T {
        assert_vector(self.order, c);
        let mut product = [T::ZERO; MAX_COEFFICIENTS];
        let product = &mut product[..coefficients(self.order)];
        self.single_product(a, b, product);
        product.iter().zip(c).fold(T::ZERO, |sum, (&x, &y)| sum + x * y)
    }

    #[track_caller]
    fn assert_vectors<const N: usize>(&self, lengths: [usize; N]) {
        let size = self.order * self.order;
        assert!(lengths.iter().all(|&len| len == size), "vectors of {lengths:?} coefficients, expected {size}");
    }

    #[track_caller]
    fn assert_batches<const N: usize>(&self, inputs: [usize; N], out: usize) {
        let size = coefficients(self.order);
        assert_eq!(out % size, 0, "blocks of order {} come {size} at a time", self.order);
        assert!(inputs.iter().all(|&len| len == out), "batches of {inputs:?} and {out} blocks");
    }
}
