//! Products and squares of 16 vectors at a time, by the generated kernels.

mod basis;
#[rustfmt::skip] // as the generator prints them
mod generated;
mod single;

pub(crate) use basis::{Evaluate, Zonal, ZonalSum};
pub(crate) use single::{MAX_TRIPLES_SIZE, SingleProduct, SingleSquare, SoleProduct, SoleSquare, suited};

use std::marker::PhantomData;

use crate::LANES;
use crate::block::Block;
use crate::real::Real;
use crate::simd::{Lanes, Task};

/// Where a kernel reads the coefficients of a vector.
pub(crate) trait Source<V> {
    /// Coefficient `i`.
    fn get(&self, i: usize) -> V;
}

/// Where a kernel writes the coefficients of a vector.
pub(crate) trait Sink<V> {
    /// Sets coefficient `i`.
    fn set(&mut self, i: usize, value: V);
}

/// The lanes of one register within blocks.
pub(crate) struct Part<B> {
    pub(crate) blocks: B,
    pub(crate) part: usize,
}

impl<V: Lanes> Source<V> for Part<&[Block<V::Scalar>]> {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        V::load(&self.blocks[i].0, self.part)
    }
}

impl<V: Lanes> Sink<V> for Part<&mut [Block<V::Scalar>]> {
    #[inline(always)]
    fn set(&mut self, i: usize, value: V) {
        value.store(&mut self.blocks[i].0, self.part);
    }
}

impl<V: Lanes> Source<V> for Part<&mut [Block<V::Scalar>]> {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        V::load(&self.blocks[i].0, self.part)
    }
}

/// A table on cache lines.
#[repr(align(64))]
pub(crate) struct Aligned<T>(pub(crate) T);

/// Tables in single precision.
const fn narrow<const K: usize, const P: usize>(tables: &[[f64; K]; P]) -> [[f32; K]; P] {
    let mut single = [[0.0; K]; P];
    let mut p = 0;
    while p < P {
        let mut k = 0;
        while k < K {
            single[p][k] = tables[p][k] as f32;
            k += 1;
        }
        p += 1;
    }
    single
}

/// The generated code of one order.
pub(crate) trait Kernel {
    /// The number of coefficients.
    const SIZE: usize;
    /// Rings of the product of a single pair.
    const RINGS: usize;

    /// A row of lanes for each coefficient.
    type Rows<T: Real>: AsMut<[Block<T>]>;
    /// Rows of 0.
    fn rows<T: Real>() -> Self::Rows<T>;
    /// Tables of the single product, to rings and back.
    fn tables<T: Real>() -> [&'static [[T; LANES]]; 2];
    /// The basis functions at a direction.
    fn evaluate<V: Lanes>(direction: &impl Source<V>, out: &mut impl Sink<V>);
    /// A zonal vector turned to a direction.
    fn rotate_zonal<V: Lanes>(direction: &impl Source<V>, zonal: &impl Source<V>, out: &mut impl Sink<V>);
    /// Zonal vectors turned to directions, all added to `out`, in the lanes of one register.
    fn sum_zonal<V: Lanes>(
        zonal: &[Block<V::Scalar>],
        directions: &[[Block<V::Scalar>; 3]],
        out: &mut [Block<V::Scalar>],
        part: usize,
    );
    /// What the rings in the lanes add to the coefficients of `a * b`.
    fn rings_product<V: Lanes>(
        a: &impl Source<V>,
        b: &impl Source<V>,
        forward: &impl Source<V>,
        backward: &impl Source<V>,
        out: &mut impl Sink<V>,
    );
    /// The same for `a * a`.
    fn rings_square<V: Lanes>(
        a: &impl Source<V>,
        forward: &impl Source<V>,
        backward: &impl Source<V>,
        out: &mut impl Sink<V>,
    );

    /// `out = a * b`.
    fn product<V: Lanes>(a: &impl Source<V>, b: &impl Source<V>, out: &mut (impl Source<V> + Sink<V>));
    /// `out = a * a`.
    fn square<V: Lanes>(a: &impl Source<V>, out: &mut (impl Source<V> + Sink<V>));
}

macro_rules! kernel {
    ($name:ident, $module:ident, $order:literal) => {
        #[doc = concat!("Order ", $order, ".")]
        pub(crate) struct $name;

        impl Kernel for $name {
            const SIZE: usize = $order * $order;
            const RINGS: usize = generated::$module::RINGS;
            type Rows<T: Real> = [Block<T>; $order * $order];

            #[inline(always)]
            fn rows<T: Real>() -> Self::Rows<T> {
                [Block::ZERO; $order * $order]
            }
            #[inline(always)]
            fn tables<T: Real>() -> [&'static [[T; LANES]]; 2] {
                use generated::$module::{BACKWARD, FORWARD, SINGLE_BACKWARD, SINGLE_FORWARD};
                [T::table(&SINGLE_FORWARD.0, &FORWARD.0), T::table(&SINGLE_BACKWARD.0, &BACKWARD.0)]
            }
            #[inline(always)]
            fn evaluate<V: Lanes>(direction: &impl Source<V>, out: &mut impl Sink<V>) {
                generated::$module::evaluate::<V>(direction, out);
            }
            #[inline(always)]
            fn rotate_zonal<V: Lanes>(direction: &impl Source<V>, zonal: &impl Source<V>, out: &mut impl Sink<V>) {
                generated::$module::rotate_zonal::<V>(direction, zonal, out);
            }
            #[inline(always)]
            fn sum_zonal<V: Lanes>(
                zonal: &[Block<V::Scalar>],
                directions: &[[Block<V::Scalar>; 3]],
                out: &mut [Block<V::Scalar>],
                part: usize,
            ) {
                generated::$module::sum_zonal::<V>(zonal, directions, out, part);
            }
            #[inline(always)]
            fn rings_product<V: Lanes>(
                a: &impl Source<V>,
                b: &impl Source<V>,
                forward: &impl Source<V>,
                backward: &impl Source<V>,
                out: &mut impl Sink<V>,
            ) {
                generated::$module::rings_product::<V>(a, b, forward, backward, out);
            }
            #[inline(always)]
            fn rings_square<V: Lanes>(
                a: &impl Source<V>,
                forward: &impl Source<V>,
                backward: &impl Source<V>,
                out: &mut impl Sink<V>,
            ) {
                generated::$module::rings_square::<V>(a, forward, backward, out);
            }

            #[inline(always)]
            fn product<V: Lanes>(a: &impl Source<V>, b: &impl Source<V>, out: &mut (impl Source<V> + Sink<V>)) {
                generated::$module::product::<V>(a, b, out);
            }
            #[inline(always)]
            fn square<V: Lanes>(a: &impl Source<V>, out: &mut (impl Source<V> + Sink<V>)) {
                generated::$module::square::<V>(a, out);
            }
        }
    };
}

kernel!(Order1, order_1, 1);
kernel!(Order2, order_2, 2);
kernel!(Order3, order_3, 3);
kernel!(Order4, order_4, 4);
kernel!(Order5, order_5, 5);
kernel!(Order6, order_6, 6);
kernel!(Order7, order_7, 7);
kernel!(Order8, order_8, 8);

/// Runs an expression with the [`Kernel`] of an order under a name.
macro_rules! with_kernel {
    ($order:expr, $kernel:ident => $run:expr) => {
        with_kernel!($order, $kernel => $run; 1 Order1, 2 Order2, 3 Order3, 4 Order4, 5 Order5, 6 Order6, 7 Order7, 8 Order8)
    };
    ($order:expr, $kernel:ident => $run:expr; $($literal:literal $name:ident),*) => {
        match $order {
            $($literal => {
                type $kernel = $crate::product::$name;
                $run
            })*
            other => panic!("order {other}: expected 1 to 8"),
        }
    };
}
pub(crate) use with_kernel;

/// Products of blocks, each of `K::SIZE` blocks.
pub(crate) struct Product<'a, T, K> {
    pub(crate) a: &'a [Block<T>],
    pub(crate) b: &'a [Block<T>],
    pub(crate) out: &'a mut [Block<T>],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for Product<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let factors = self.a.chunks_exact(K::SIZE).zip(self.b.chunks_exact(K::SIZE));
        for ((a, b), out) in factors.zip(self.out.chunks_exact_mut(K::SIZE)) {
            for part in 0..LANES / V::WIDTH {
                let (a, b) = (Part { blocks: a, part }, Part { blocks: b, part });
                K::product::<V>(&a, &b, &mut Part { blocks: &mut *out, part });
            }
        }
    }
}

/// Squares of blocks, each of `K::SIZE` blocks.
pub(crate) struct Square<'a, T, K> {
    pub(crate) a: &'a [Block<T>],
    pub(crate) out: &'a mut [Block<T>],
    pub(crate) kernel: PhantomData<K>,
}

impl<T: Real, K: Kernel> Task<T> for Square<'_, T, K> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for (a, out) in self.a.chunks_exact(K::SIZE).zip(self.out.chunks_exact_mut(K::SIZE)) {
            for part in 0..LANES / V::WIDTH {
                K::square::<V>(&Part { blocks: a, part }, &mut Part { blocks: &mut *out, part });
            }
        }
    }
}
