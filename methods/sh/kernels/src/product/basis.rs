//! Basis functions and zonal vectors at batches of directions.

use std::marker::PhantomData;

use super::{Kernel, Part, Sink, Source};
use crate::LANES;
use crate::block::Block;
use crate::real::Real;
use crate::simd::{Lanes, Task};

/// The basis functions at directions, three blocks each.
pub(crate) struct Evaluate<'a, T, K> {
    pub(crate) directions: &'a [[Block<T>; 3]],
    pub(crate) out: &'a mut [Block<T>],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for Evaluate<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for (direction, out) in self.directions.iter().zip(self.out.chunks_exact_mut(K::SIZE)) {
            for part in 0..LANES / V::WIDTH {
                let direction = Part { blocks: direction.as_slice(), part };
                K::evaluate::<V>(&direction, &mut Part { blocks: &mut *out, part });
            }
        }
    }
}

/// Zonal vectors turned to directions, `order` blocks each.
pub(crate) struct Zonal<'a, T, K> {
    pub(crate) order: usize,
    pub(crate) zonal: &'a [Block<T>],
    pub(crate) directions: &'a [[Block<T>; 3]],
    pub(crate) out: &'a mut [Block<T>],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for Zonal<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let lobes = self.zonal.chunks_exact(self.order).zip(self.directions);
        for ((zonal, direction), out) in lobes.zip(self.out.chunks_exact_mut(K::SIZE)) {
            for part in 0..LANES / V::WIDTH {
                let zonal = Part { blocks: zonal, part };
                let direction = Part { blocks: direction.as_slice(), part };
                K::rotate_zonal::<V>(&direction, &zonal, &mut Part { blocks: &mut *out, part });
            }
        }
    }
}

/// The same added up in `out`, one vector a lane.
pub(crate) struct ZonalSum<'a, T, K> {
    pub(crate) order: usize,
    pub(crate) zonal: &'a [Block<T>],
    pub(crate) directions: &'a [[Block<T>; 3]],
    pub(crate) out: &'a mut [Block<T>],
    pub(crate) kernel: PhantomData<K>,
}

/// Coefficients that stay in registers, as far as there are enough.
struct Registers<S>(S);

impl<V: Lanes, S: AsRef<[V]>> Source<V> for Registers<S> {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        self.0.as_ref()[i]
    }
}

impl<V: Lanes, S: AsMut<[V]>> Sink<V> for Registers<S> {
    #[inline(always)]
    fn set(&mut self, i: usize, value: V) {
        self.0.as_mut()[i] = value;
    }
}

impl<T: Real, K: Kernel> Task<T> for ZonalSum<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for part in 0..LANES / V::WIDTH {
            let mut sums = Registers(K::coefficients(|i| V::load(&self.out[i].0, part)));
            for (zonal, direction) in self.zonal.chunks_exact(self.order).zip(self.directions) {
                let direction = Part { blocks: direction.as_slice(), part };
                K::add_zonal::<V>(&direction, &Part { blocks: zonal, part }, &mut sums);
            }
            self.out.iter_mut().enumerate().for_each(|(i, block)| sums.get(i).store(&mut block.0, part));
        }
    }
}
