//! Every kernel compiled for both scalar types here, not again in each crate that calls it.

use std::marker::PhantomData;

use crate::LANES;
use crate::block::Block;
use crate::pack::{Pack, Unpack};
use crate::product::{
    Evaluate, Kernel, MAX_SCALAR_ORDER, Product, Scalars, SingleProduct, SingleSquare, Square, Zonal, ZonalSum, suited,
    with_kernel,
};
use crate::simd::{Simd, run};

/// The kernels of a scalar type.
pub trait Kernels: Sized {
    /// Products of whole batches.
    fn products(simd: Simd, order: usize, a: &[Block<Self>], b: &[Block<Self>], out: &mut [Block<Self>]);
    /// Squares of whole batches.
    fn squares(simd: Simd, order: usize, a: &[Block<Self>], out: &mut [Block<Self>]);
    /// Basis functions at directions.
    fn evaluate(simd: Simd, order: usize, directions: &[[Block<Self>; 3]], out: &mut [Block<Self>]);
    /// Zonal vectors turned to directions.
    fn rotate_zonal(
        simd: Simd,
        order: usize,
        zonal: &[Block<Self>],
        directions: &[[Block<Self>; 3]],
        out: &mut [Block<Self>],
    );
    /// The same added up in `out`.
    fn sum_zonal(
        simd: Simd,
        order: usize,
        zonal: &[Block<Self>],
        directions: &[[Block<Self>; 3]],
        out: &mut [Block<Self>],
    );
    /// Vectors one after another to blocks.
    fn pack(simd: Simd, size: usize, vectors: &[Self], blocks: &mut [Block<Self>]);
    /// Blocks to vectors one after another.
    fn unpack(simd: Simd, size: usize, blocks: &[Block<Self>], vectors: &mut [Self]);
    /// Products of vectors one after another.
    fn product_vectors(simd: Simd, order: usize, a: &[Self], b: &[Self], out: &mut [Self]);
    /// One product.
    fn product(simd: Simd, order: usize, a: &[Self], b: &[Self], out: &mut [Self]);
    /// One square.
    fn square(simd: Simd, order: usize, a: &[Self], out: &mut [Self]);
}

macro_rules! kernels {
    ($t:ty) => {
        impl Kernels for $t {
            #[inline(never)]
            fn products(simd: Simd, order: usize, a: &[Block<$t>], b: &[Block<$t>], out: &mut [Block<$t>]) {
                with_kernel!(order, K => run(simd, Product { a, b, out, kernel: PhantomData::<K> }));
            }
            #[inline(never)]
            fn squares(simd: Simd, order: usize, a: &[Block<$t>], out: &mut [Block<$t>]) {
                with_kernel!(order, K => run(simd, Square { a, out, kernel: PhantomData::<K> }));
            }
            #[inline(never)]
            fn evaluate(simd: Simd, order: usize, directions: &[[Block<$t>; 3]], out: &mut [Block<$t>]) {
                with_kernel!(order, K => run(simd, Evaluate { directions, out, kernel: PhantomData::<K> }));
            }
            #[inline(never)]
            fn rotate_zonal(
                simd: Simd,
                order: usize,
                zonal: &[Block<$t>],
                directions: &[[Block<$t>; 3]],
                out: &mut [Block<$t>],
            ) {
                with_kernel!(order, K => {
                    run(simd, Zonal { order, zonal, directions, out, kernel: PhantomData::<K> })
                });
            }
            #[inline(never)]
            fn sum_zonal(
                simd: Simd,
                order: usize,
                zonal: &[Block<$t>],
                directions: &[[Block<$t>; 3]],
                out: &mut [Block<$t>],
            ) {
                with_kernel!(order, K => {
                    run(simd, ZonalSum { order, zonal, directions, out, kernel: PhantomData::<K> })
                });
            }
            fn pack(simd: Simd, size: usize, vectors: &[$t], blocks: &mut [Block<$t>]) {
                run(simd.min(Simd::Avx2), Pack { size, vectors, blocks });
            }
            fn unpack(simd: Simd, size: usize, blocks: &[Block<$t>], vectors: &mut [$t]) {
                run(simd.min(Simd::Avx2), Unpack { size, blocks, vectors });
            }
            fn product_vectors(simd: Simd, order: usize, a: &[$t], b: &[$t], out: &mut [$t]) {
                let size = order * order;
                let [mut left, mut right, mut result] = [[Block::ZERO; 64]; 3];
                let groups = a.chunks(LANES * size).zip(b.chunks(LANES * size)).zip(out.chunks_mut(LANES * size));
                for ((a, b), out) in groups {
                    Self::pack(simd, size, a, &mut left[..size]);
                    Self::pack(simd, size, b, &mut right[..size]);
                    Self::products(simd, order, &left[..size], &right[..size], &mut result[..size]);
                    Self::unpack(simd, size, &result[..size], out);
                }
            }
            #[inline(never)]
            fn product(simd: Simd, order: usize, a: &[$t], b: &[$t], out: &mut [$t]) {
                with_kernel!(order, K => match order {
                    ..=MAX_SCALAR_ORDER => K::product::<$t>(&Scalars(a), &Scalars(b), &mut Scalars(out)),
                    _ => run(suited::<$t, K>(simd), SingleProduct { a, b, out, kernel: PhantomData::<K> }),
                });
            }
            #[inline(never)]
            fn square(simd: Simd, order: usize, a: &[$t], out: &mut [$t]) {
                with_kernel!(order, K => match order {
                    ..=MAX_SCALAR_ORDER => K::square::<$t>(&Scalars(a), &mut Scalars(out)),
                    _ => run(suited::<$t, K>(simd), SingleSquare { a, out, kernel: PhantomData::<K> }),
                });
            }
        }
    };
}

kernels!(f32);
kernels!(f64);
