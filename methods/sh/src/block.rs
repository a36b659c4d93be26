//! Batches of vectors in blocks of 16.

use halflight_sh_kernels::{Block, LANES, Real, Simd};

use crate::order::{assert_order, coefficients};

/// Blocks that hold `vectors` vectors of an order.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
pub fn blocks_for(order: usize, vectors: usize) -> usize {
    assert_order(order);
    vectors.div_ceil(LANES) * coefficients(order)
}

/// Reorders vectors that lie one after another into blocks; lanes that are left over become 0.
///
/// # Panics
/// If `vectors` does not hold whole vectors, or `blocks` not as many as [`blocks_for`] tells.
pub fn pack<T: Real>(order: usize, vectors: &[T], blocks: &mut [Block<T>]) {
    assert_shapes(order, vectors.len(), blocks.len());
    T::pack(Simd::best(), order, vectors, blocks);
}

/// The inverse of [`pack`].
///
/// # Panics
/// As [`pack`].
pub fn unpack<T: Real>(order: usize, blocks: &[Block<T>], vectors: &mut [T]) {
    assert_shapes(order, vectors.len(), blocks.len());
    T::unpack(Simd::best(), order, blocks, vectors);
}

fn assert_shapes(order: usize, values: usize, blocks: usize) {
    assert_order(order);
    let size = coefficients(order);
    assert_eq!(values % size, 0, "vectors of order {order} have {size} coefficients");
    assert_eq!(blocks, blocks_for(order, values / size), "blocks for {} vectors of order {order}", values / size);
}
