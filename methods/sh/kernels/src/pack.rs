//! Between vectors that lie one after another and blocks of lanes: transposes in registers.

use std::marker::PhantomData;

use crate::LANES;
use crate::block::Block;
use crate::product::Kernel;
use crate::real::Real;
use crate::simd::{Lanes, Task};

/// Vectors to the lanes of blocks; lanes that are left over become 0.
pub(crate) struct Pack<'a, T, K> {
    pub(crate) vectors: &'a [T],
    pub(crate) blocks: &'a mut [Block<T>],
    pub(crate) kernel: PhantomData<K>,
}

/// The inverse.
pub(crate) struct Unpack<'a, T, K> {
    pub(crate) blocks: &'a [Block<T>],
    pub(crate) vectors: &'a mut [T],
    pub(crate) kernel: PhantomData<K>,
}

/// Where tiles of `width` coefficients start; the last one may overlap the one before.
#[inline(always)]
fn tiles(size: usize, width: usize) -> impl Iterator<Item = usize> {
    (0..size.div_ceil(width)).map(move |tile| (tile * width).min(size - width))
}

impl<T: Real, K: Kernel> Task<T> for Pack<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let size = K::SIZE;
        for (group, blocks) in self.vectors.chunks(LANES * size).zip(self.blocks.chunks_exact_mut(size)) {
            if group.len() == LANES * size && size >= V::TILE {
                for part in 0..LANES / V::WIDTH {
                    for first in tiles(size, V::TILE) {
                        V::transpose_in(&group[part * V::WIDTH * size + first..], size, &mut blocks[first..], part);
                    }
                }
            } else {
                for (i, block) in blocks.iter_mut().enumerate() {
                    *block = Block::ZERO;
                    block.0.iter_mut().zip(group.chunks_exact(size)).for_each(|(lane, vector)| *lane = vector[i]);
                }
            }
        }
    }
}

impl<T: Real, K: Kernel> Task<T> for Unpack<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let size = K::SIZE;
        for (group, blocks) in self.vectors.chunks_mut(LANES * size).zip(self.blocks.chunks_exact(size)) {
            if group.len() == LANES * size && size >= V::TILE {
                for part in 0..LANES / V::WIDTH {
                    for first in tiles(size, V::TILE) {
                        V::transpose_out(&blocks[first..], part, &mut group[part * V::WIDTH * size + first..], size);
                    }
                }
            } else {
                for (lane, vector) in group.chunks_exact_mut(size).enumerate() {
                    vector.iter_mut().zip(blocks).for_each(|(value, block)| *value = block.0[lane]);
                }
            }
        }
    }
}
