//! Basis functions and zonal vectors at batches of directions.

use std::marker::PhantomData;

use super::{Kernel, Part};
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
    pub(crate) zonal: &'a [Block<T>],
    pub(crate) directions: &'a [[Block<T>; 3]],
    pub(crate) out: &'a mut [Block<T>],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for ZonalSum<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for part in 0..LANES / V::WIDTH {
            K::sum_zonal::<V>(self.zonal, self.directions, self.out, part);
        }
    }
}
