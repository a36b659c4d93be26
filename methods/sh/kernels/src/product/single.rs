//! The product of one pair of vectors: a ring in each lane, or one lane alone.

use std::marker::PhantomData;

use super::{Kernel, Sink, Source};
use crate::LANES;
use crate::block::Block;
use crate::real::Real;
use crate::simd::{Lanes, Simd, Task};

/// A vector whose coefficients fill all lanes.
struct Splat<'a, T>(&'a [T]);

impl<V: Lanes> Source<V> for Splat<'_, V::Scalar> {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        V::splat(self.0[i])
    }
}

/// The lanes of one register within the rows of a table.
struct Rows<'a, T> {
    rows: &'a [[T; LANES]],
    part: usize,
}

impl<V: Lanes> Source<V> for Rows<'_, V::Scalar> {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        V::load(&self.rows[i], self.part)
    }
}

/// Sums of what rings contribute, one lane of a register each; the first register overwrites.
struct Sums<'a, T> {
    rows: &'a mut [Block<T>],
    first: bool,
}

impl<V: Lanes> Sink<V> for Sums<'_, V::Scalar> {
    #[inline(always)]
    fn set(&mut self, i: usize, value: V) {
        let row = &mut self.rows[i].0;
        let sum = if self.first { value } else { value.add(V::load(row, 0)) };
        sum.store(row, 0);
    }
}

/// One product.
pub(crate) struct SingleProduct<'a, T, K> {
    pub(crate) a: &'a [T],
    pub(crate) b: &'a [T],
    pub(crate) out: &'a mut [T],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for SingleProduct<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let (a, b) = (Splat(&self.a[..K::SIZE]), Splat(&self.b[..K::SIZE]));
        let [forward, backward] = K::tables::<T>();
        let mut sums = K::rows::<T>();
        for part in 0..K::RINGS.div_ceil(V::WIDTH) {
            let (forward, backward) = (Rows { rows: forward, part }, Rows { rows: backward, part });
            K::rings_product::<V>(&a, &b, &forward, &backward, &mut Sums { rows: sums.as_mut(), first: part == 0 });
        }
        V::sum_rows(sums.as_mut(), self.out);
    }
}

/// One square.
pub(crate) struct SingleSquare<'a, T, K> {
    pub(crate) a: &'a [T],
    pub(crate) out: &'a mut [T],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for SingleSquare<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let a = Splat(&self.a[..K::SIZE]);
        let [forward, backward] = K::tables::<T>();
        let mut sums = K::rows::<T>();
        for part in 0..K::RINGS.div_ceil(V::WIDTH) {
            let (forward, backward) = (Rows { rows: forward, part }, Rows { rows: backward, part });
            K::rings_square::<V>(&a, &forward, &backward, &mut Sums { rows: sums.as_mut(), first: part == 0 });
        }
        V::sum_rows(sums.as_mut(), self.out);
    }
}

/// One product by the batch's program in the first lane, where the others would hold the same.
pub(crate) struct SoleProduct<'a, T, K> {
    pub(crate) a: &'a [T],
    pub(crate) b: &'a [T],
    pub(crate) out: &'a mut [T],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for SoleProduct<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let (a, b, out) = (&self.a[..K::SIZE], &self.b[..K::SIZE], &mut self.out[..K::SIZE]);
        K::product::<V>(&Splat(a), &Splat(b), &mut FirstLane(out));
    }
}

/// One square likewise.
pub(crate) struct SoleSquare<'a, T, K> {
    pub(crate) a: &'a [T],
    pub(crate) out: &'a mut [T],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for SoleSquare<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        K::square::<V>(&Splat(&self.a[..K::SIZE]), &mut FirstLane(&mut self.out[..K::SIZE]));
    }
}

/// The vector that the first lanes make.
struct FirstLane<'a, T>(&'a mut [T]);

impl<V: Lanes> Source<V> for FirstLane<'_, V::Scalar> {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        V::splat(self.0[i])
    }
}

impl<V: Lanes> Sink<V> for FirstLane<'_, V::Scalar> {
    #[inline(always)]
    fn set(&mut self, i: usize, value: V) {
        self.0[i] = value.first();
    }
}

/// Up to so many coefficients, those of order 3, the rings of a single pair are too few to pay, and triples win.
pub(crate) const MAX_TRIPLES_SIZE: usize = 9;

/// The narrowest instructions that hold all rings of an order in one register, or else the widest.
pub(crate) fn suited<T: Real, K: Kernel>(simd: Simd) -> Simd {
    if K::RINGS * size_of::<T>() <= 32 { simd.min(Simd::Avx2) } else { simd }
}
