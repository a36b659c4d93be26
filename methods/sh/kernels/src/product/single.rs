//! The product of one pair of vectors, a ring in each lane.

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
        let (a, b) = (Splat(self.a), Splat(self.b));
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
        let a = Splat(self.a);
        let [forward, backward] = K::tables::<T>();
        let mut sums = K::rows::<T>();
        for part in 0..K::RINGS.div_ceil(V::WIDTH) {
            let (forward, backward) = (Rows { rows: forward, part }, Rows { rows: backward, part });
            K::rings_square::<V>(&a, &forward, &backward, &mut Sums { rows: sums.as_mut(), first: part == 0 });
        }
        V::sum_rows(sums.as_mut(), self.out);
    }
}

/// The coefficients of one vector, each the only lane of a register.
pub(crate) struct Scalars<S>(pub(crate) S);

macro_rules! scalars {
    ($t:ty) => {
        impl Source<$t> for Scalars<&[$t]> {
            #[inline(always)]
            fn get(&self, i: usize) -> $t {
                self.0[i]
            }
        }
        impl Source<$t> for Scalars<&mut [$t]> {
            #[inline(always)]
            fn get(&self, i: usize) -> $t {
                self.0[i]
            }
        }
        impl Sink<$t> for Scalars<&mut [$t]> {
            #[inline(always)]
            fn set(&mut self, i: usize, value: $t) {
                self.0[i] = value;
            }
        }
    };
}

scalars!(f32);
scalars!(f64);

/// Up to this order the rings of a single pair are too few to pay, and scalar triples win.
pub(crate) const MAX_SCALAR_ORDER: usize = 3;

/// The narrowest instructions that hold all rings of an order in one register, or else the widest.
pub(crate) fn suited<T: Real, K: Kernel>(simd: Simd) -> Simd {
    if K::RINGS * size_of::<T>() <= 32 { simd.min(Simd::Avx2) } else { simd }
}
