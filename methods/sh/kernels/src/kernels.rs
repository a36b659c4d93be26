//! Every kernel compiled for both scalar types here, not again in each crate that calls it.

use std::marker::PhantomData;

use crate::LANES;
use crate::block::Block;
use crate::pack::{Pack, Unpack};
use crate::product::{
    Evaluate, Kernel, MAX_TRIPLES_SIZE, Product, SingleProduct, SingleSquare, SoleProduct, SoleSquare, Square, Zonal,
    ZonalSum, suited, with_kernel,
};
use crate::real::Real;
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
    fn pack(simd: Simd, order: usize, vectors: &[Self], blocks: &mut [Block<Self>]);
    /// Blocks to vectors one after another.
    fn unpack(simd: Simd, order: usize, blocks: &[Block<Self>], vectors: &mut [Self]);
    /// Products of vectors one after another.
    fn product_vectors(simd: Simd, order: usize, a: &[Self], b: &[Self], out: &mut [Self]);
    /// One product.
    fn product(simd: Simd, order: usize, a: &[Self], b: &[Self], out: &mut [Self]);
    /// One square.
    fn square(simd: Simd, order: usize, a: &[Self], out: &mut [Self]);
}

/// One product. Not inlined, so that choosing among orders needs no stack.
#[inline(never)]
fn product<T: Real, K: Kernel>(simd: Simd, a: &[T], b: &[T], out: &mut [T]) {
    let kernel = PhantomData::<K>;
    if K::SIZE <= MAX_TRIPLES_SIZE {
        run(simd.min(Simd::Avx2), SoleProduct { a, b, out, kernel });
    } else {
        run(suited::<T, K>(simd), SingleProduct { a, b, out, kernel });
    }
}

/// One square likewise.
#[inline(never)]
fn square<T: Real, K: Kernel>(simd: Simd, a: &[T], out: &mut [T]) {
    let kernel = PhantomData::<K>;
    if K::SIZE <= MAX_TRIPLES_SIZE {
        run(simd.min(Simd::Avx2), SoleSquare { a, out, kernel });
    } else {
        run(suited::<T, K>(simd), SingleSquare { a, out, kernel });
    }
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
                    run(simd, ZonalSum { zonal, directions, out, kernel: PhantomData::<K> })
                });
            }
            #[inline(never)]
            fn pack(simd: Simd, order: usize, vectors: &[$t], blocks: &mut [Block<$t>]) {
                with_kernel!(order, K => run(simd, Pack { vectors, blocks, kernel: PhantomData::<K> }));
            }
            #[inline(never)]
            fn unpack(simd: Simd, order: usize, blocks: &[Block<$t>], vectors: &mut [$t]) {
                with_kernel!(order, K => run(simd, Unpack { blocks, vectors, kernel: PhantomData::<K> }));
            }
            #[inline(never)]
            fn product_vectors(simd: Simd, order: usize, a: &[$t], b: &[$t], out: &mut [$t]) {
                with_kernel!(order, K => {
                    let [mut left, mut right, mut result] = [(); 3].map(|()| K::rows::<$t>());
                    let group = LANES * K::SIZE;
                    for ((a, b), out) in a.chunks(group).zip(b.chunks(group)).zip(out.chunks_mut(group)) {
                        run(simd, Pack { vectors: a, blocks: left.as_mut(), kernel: PhantomData::<K> });
                        run(simd, Pack { vectors: b, blocks: right.as_mut(), kernel: PhantomData::<K> });
                        Self::products(simd, order, left.as_mut(), right.as_mut(), result.as_mut());
                        run(simd, Unpack { blocks: result.as_mut(), vectors: out, kernel: PhantomData::<K> });
                    }
                });
            }
            fn product(simd: Simd, order: usize, a: &[$t], b: &[$t], out: &mut [$t]) {
                with_kernel!(order, K => product::<$t, K>(simd, a, b, out));
            }
            fn square(simd: Simd, order: usize, a: &[$t], out: &mut [$t]) {
                with_kernel!(order, K => square::<$t, K>(simd, a, out));
            }
        }
    };
}

kernels!(f32);
kernels!(f64);
