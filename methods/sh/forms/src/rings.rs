//! Rings of constant height.

use std::f64::consts::PI;

use halflight_sh::index;

use crate::latitude::Latitude;
use crate::level::{Level, Loop, Scalar, run};
use crate::{Form, assert_order, assert_vectors};

/// Rings that are handled side by side, a power of two.
const WIDTH: usize = 8;

/// The product on rings at Gauss–Lobatto heights: vectors become Fourier series in azimuth on every ring, series are
/// convolved, and quadrature brings them back. Eight rings lie side by side.
#[derive(Clone, Debug)]
pub struct Rings<T> {
    order: usize,
    /// For each eight rings: by m, then l, the factors to the rings and back.
    groups: Vec<Group<T>>,
    /// What each coefficient gets from the rings.
    sums: Vec<[T; WIDTH]>,
}

#[derive(Clone, Debug)]
struct Group<T> {
    forward: Vec<[T; WIDTH]>,
    backward: Vec<[T; WIDTH]>,
}

/// The Gauss–Lobatto heights and weights that are exact to degree `2·count - 3`.
fn lobatto(count: usize) -> Vec<(f64, f64)> {
    let degree = count - 1;
    let weight = |z: f64| 2.0 / ((count * degree) as f64 * legendre(degree, z).0.powi(2));
    let inner = (1..degree).map(|k| {
        let mut z = (PI * k as f64 / degree as f64).cos();
        for _ in 0..50 {
            // Newton on P', with P'' from Legendre's equation
            let (value, slope) = legendre(degree, z);
            let curvature = (2.0 * z * slope - (degree * (degree + 1)) as f64 * value) / (1.0 - z * z);
            z -= slope / curvature;
        }
        (z, weight(z))
    });
    [(1.0, weight(1.0)), (-1.0, weight(-1.0))].into_iter().chain(inner).collect()
}

/// `P_n` and its derivative; at ±1 the value alone is meant.
fn legendre(n: usize, z: f64) -> (f64, f64) {
    let (mut below, mut p) = (0.0, 1.0);
    for l in 1..=n {
        let l = l as f64;
        (below, p) = (p, ((2.0 * l - 1.0) * z * p - (l - 1.0) * below) / l);
    }
    (p, n as f64 * (below - z * p) / (1.0 - z * z))
}

impl<T: Scalar> Rings<T> {
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
    pub fn new(order: usize) -> Self {
        assert_order(order);
        let nodes = lobatto((3 * order).div_ceil(2).max(2));
        let groups = nodes
            .chunks(WIDTH)
            .map(|nodes| {
                let rings: Vec<Latitude> =
                    nodes.iter().map(|(z, _)| Latitude::new(order, (1.0 - z * z).max(0.0).sqrt(), *z)).collect();
                let table = |factor: &dyn Fn(usize, usize) -> f64| -> Vec<[T; WIDTH]> {
                    let entry = |l: usize, m: usize| {
                        std::array::from_fn(|r| T::of(rings.get(r).map_or(0.0, |ring| factor(r, m) * ring.at(l, m))))
                    };
                    (0..order).flat_map(|m| (m..order).map(move |l| entry(l, m))).collect()
                };
                // Series are complex: half of cosine and sine each.
                let forward = table(&|_, m| if m == 0 { 1.0 } else { 0.5 });
                let backward = table(&|r, _| 2.0 * PI * nodes[r].1);
                Group { forward, backward }
            })
            .collect();
        Self { order, groups, sums: vec![[T::ZERO; WIDTH]; order * order] }
    }
}

/// A Fourier series on eight rings: cosines and sines by m.
type Series<T> = [[[T; WIDTH]; 2]; crate::MAX_ORDER];

struct Convolution<'a, T> {
    order: usize,
    groups: &'a [Group<T>],
    sums: &'a mut [[T; WIDTH]],
    a: &'a [T],
    b: &'a [T],
    out: &'a mut [T],
}

#[inline(always)]
fn add<L: Level, T: Scalar>(sum: &mut [T; WIDTH], x: &[T; WIDTH], y: &[T; WIDTH]) {
    for r in 0..WIDTH {
        sum[r] = L::mul_add(x[r], y[r], sum[r]);
    }
}

#[inline(always)]
fn subtract<L: Level, T: Scalar>(sum: &mut [T; WIDTH], x: &[T; WIDTH], y: &[T; WIDTH]) {
    for r in 0..WIDTH {
        sum[r] = L::mul_add(T::ZERO - x[r], y[r], sum[r]);
    }
}

impl<T: Scalar> Convolution<'_, T> {
    #[inline(always)]
    fn to_rings<L: Level>(order: usize, forward: &[[T; WIDTH]], v: &[T]) -> Series<T> {
        let mut series = [[[T::ZERO; WIDTH]; 2]; crate::MAX_ORDER];
        let mut factors = forward.iter();
        for m in 0..order {
            let [mut cosine, mut sine] = [[T::ZERO; WIDTH]; 2];
            for (l, factor) in (m..order).zip(&mut factors) {
                add::<L, T>(&mut cosine, factor, &[v[index(l, m as isize)]; WIDTH]);
                if m > 0 {
                    add::<L, T>(&mut sine, factor, &[v[index(l, -(m as isize))]; WIDTH]);
                }
            }
            series[m] = [cosine, sine];
        }
        series
    }

    /// The product of two series, truncated; with sums over both signs of m.
    #[inline(always)]
    fn convolve<L: Level>(order: usize, a: &Series<T>, b: &Series<T>) -> Series<T> {
        let mut out = [[[T::ZERO; WIDTH]; 2]; crate::MAX_ORDER];
        for m in 0..order {
            let [mut cosine, mut sine] = [[T::ZERO; WIDTH]; 2];
            for k in 0..=m {
                let ([ac, a_s], [bc, bs]) = (&a[k], &b[m - k]);
                add::<L, T>(&mut cosine, ac, bc);
                subtract::<L, T>(&mut cosine, a_s, bs);
                add::<L, T>(&mut sine, ac, bs);
                add::<L, T>(&mut sine, a_s, bc);
            }
            for k in 1..order - m {
                let ([ac, a_s], [bc, bs]) = (&a[k], &b[m + k]);
                add::<L, T>(&mut cosine, ac, bc);
                add::<L, T>(&mut cosine, a_s, bs);
                add::<L, T>(&mut sine, ac, bs);
                subtract::<L, T>(&mut sine, a_s, bc);
                let ([ac, a_s], [bc, bs]) = (&a[m + k], &b[k]);
                add::<L, T>(&mut cosine, ac, bc);
                add::<L, T>(&mut cosine, a_s, bs);
                add::<L, T>(&mut sine, a_s, bc);
                subtract::<L, T>(&mut sine, ac, bs);
            }
            out[m] = [cosine, sine];
        }
        out
    }
}

impl<T: Scalar> Loop for Convolution<'_, T> {
    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { order, groups, sums, a, b, out } = self;
        sums.fill([T::ZERO; WIDTH]);
        for group in groups {
            let a = Self::to_rings::<L>(order, &group.forward, a);
            let b = Self::to_rings::<L>(order, &group.forward, b);
            let series = Self::convolve::<L>(order, &a, &b);
            let mut factors = group.backward.iter();
            for (m, [cosine, sine]) in series[..order].iter().enumerate() {
                for (l, factor) in (m..order).zip(&mut factors) {
                    add::<L, T>(&mut sums[index(l, m as isize)], factor, cosine);
                    if m > 0 {
                        add::<L, T>(&mut sums[index(l, -(m as isize))], factor, sine);
                    }
                }
            }
        }
        for (out, sum) in out.iter_mut().zip(sums) {
            *out = sum.iter().fold(T::ZERO, |total, &x| total + x);
        }
    }
}

impl<T: Scalar> Form<T> for Rings<T> {
    fn product(&mut self, a: &[T], b: &[T], out: &mut [T]) {
        assert_vectors(self.order, [a.len(), b.len(), out.len()]);
        let Self { order, groups, sums } = self;
        run(Convolution { order: *order, groups, sums, a, b, out });
    }
}
