//! Vectors to blocks and back.

use halflight_sh::{Batch, Block, LANES, Real, Simd, blocks_for, coefficients, pack, unpack};

use crate::vector::{convert, widen};

/// The batches of an order on every instruction set of the machine, with their names.
pub(crate) fn batches(order: usize) -> Vec<(String, Batch)> {
    let of = |simd: Simd| Batch::with_simd(order, simd).map(|batch| (format!("batch, {simd:?}"), batch));
    Simd::ALL.into_iter().filter_map(of).collect()
}

pub(crate) fn packed<'a, T: Real>(order: usize, vectors: impl IntoIterator<Item = &'a Vec<f64>>) -> Vec<Block<T>> {
    let flat: Vec<T> = vectors.into_iter().flat_map(|v| convert::<T>(v)).collect();
    let mut blocks = vec![Block::ZERO; blocks_for(order, flat.len() / coefficients(order))];
    pack(order, &flat, &mut blocks);
    blocks
}

pub(crate) fn unpacked<T: Real>(order: usize, blocks: &[Block<T>]) -> Vec<Vec<f64>> {
    let mut vectors = vec![T::ZERO; blocks.len() * LANES];
    unpack(order, blocks, &mut vectors);
    vectors.chunks_exact(coefficients(order)).map(widen).collect()
}

/// Values of 16 lanes at a time, component by component.
pub(crate) fn lanes<T: Real, const N: usize>(values: &[[f64; N]]) -> Vec<[Block<T>; N]> {
    let group = |group: &[[f64; N]]| {
        std::array::from_fn(|n| Block(std::array::from_fn(|lane| T::from_f64(group.get(lane).map_or(0.0, |v| v[n])))))
    };
    values.chunks(LANES).map(group).collect()
}
