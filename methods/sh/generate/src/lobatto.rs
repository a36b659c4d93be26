//! The product in θ-separable form: values on rings of constant z, where the product of two functions is a convolution of
//! their short Fourier series in azimuth, and back by Gauss–Lobatto quadrature.
//!
//! The rule is exact for the degree `3(n - 1)` of two factors and a basis function. Rings at ±z share their sums over bands of
//! equal parity; at the poles only m = 0 is left, at the equator only even `l + m`.

use std::f64::consts::PI;

use halflight_sh::{coefficients, evaluate, index};

use crate::program::{Factor, Id, Op, Program, Sum};
use crate::triples::Kind;

/// The Fourier series on a ring, `c_0 + 2 Σ_m (c_m cos mφ + s_m sin mφ)`; `None` is 0.
#[derive(Clone)]
pub(crate) struct Ring {
    pub(crate) cos: Vec<Option<Id>>,
    pub(crate) sin: Vec<Option<Id>>,
}

impl Ring {
    /// The series of 0.
    pub(crate) fn empty(order: usize) -> Self {
        Self { cos: vec![None; order], sin: vec![None; order] }
    }
}

/// Which rings a program handles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Both poles.
    Poles,
    /// The ring at z = 0.
    Equator,
    /// The rings at ±z; the programs of all pairs differ in their tables alone.
    Pair,
}

/// The programs of an order, to be run one after the other on outputs that begin as 0: each adds to those that it reaches,
/// which are its last input. Lobes are often highest at the poles, so these come last: large terms round small sums least.
pub fn build(order: usize, kind: Kind) -> Vec<(Place, Program)> {
    upper_nodes(order).into_iter().map(|(z, weight)| (place(z), ring(order, kind, z, weight))).collect()
}

fn place(z: f64) -> Place {
    match z {
        0.0 => Place::Equator,
        1.0 => Place::Poles,
        _ => Place::Pair,
    }
}

fn ring(order: usize, kind: Kind, z: f64, weight: f64) -> Program {
    let mut program = Program::default();
    let p = &mut program;
    let inputs = if kind == Kind::Product { 2 } else { 1 };
    // Values on rings are in units of y_00, so that the mean is taken as it is.
    let (latitude, unit) = (latitude(order, z), latitude(order, z)(0, 0));
    let forward = table(p, order, z, |l, m| if m == 0 { latitude(l, m) } else { 0.5 * latitude(l, m) } / unit);
    let factors: Vec<[Ring; 2]> = (0..inputs).map(|vector| to_rings(p, order, vector, z, &forward)).collect();
    let sides = if z == 0.0 { 1 } else { 2 };
    let products: Vec<Ring> = (0..sides)
        .map(|side| match &factors[..] {
            [a, b] => convolve(p, &a[side], &b[side]),
            [a, ..] => convolve_self(p, &a[side]),
            [] => unreachable!("one or two factors"),
        })
        .collect();
    let backward = table(p, order, z, |l, m| 2.0 * PI * weight * unit * unit * latitude(l, m));
    let mut out = vec![Sum::default(); coefficients(order)];
    for l in 0..order {
        for m in -(l as isize)..=l as isize {
            let reached = match place(z) {
                Place::Poles => m == 0,
                Place::Equator => (l + m.unsigned_abs()) % 2 == 0,
                Place::Pair => true,
            };
            if reached {
                out[index(l, m)] = Sum::from(p.input(inputs, index(l, m)));
            }
        }
    }
    from_rings(p, order, z, &backward, &products, &mut out);
    let written = out.iter().enumerate().filter_map(|(i, sum)| Some((i, sum.value()?)));
    written.for_each(|(i, value)| p.output(i, value));
    program
}

/// Constants by l and m: entries of the table for a pair of rings, else literals.
fn table(p: &mut Program, order: usize, z: f64, value: impl Fn(usize, usize) -> f64) -> Vec<Vec<Factor>> {
    let mut factor =
        |value: f64| if place(z) == Place::Pair && value != 1.0 { p.slot(value) } else { Factor::Literal(value) };
    (0..order).map(|l| (0..=l).map(|m| factor(value(l, m))).collect()).collect()
}

/// The Gauss–Lobatto nodes `z ≥ 0` with their weights, the pole last.
fn upper_nodes(order: usize) -> Vec<(f64, f64)> {
    let count = (3 * order).div_ceil(2);
    let degree = count - 1;
    let weight = |z: f64| 2.0 / ((count * degree) as f64 * legendre(degree, z).0.powi(2));
    let mut nodes: Vec<(f64, f64)> = Vec::new();
    if count % 2 == 1 {
        nodes.push((0.0, weight(0.0)));
    }
    for k in (1..count / 2).rev() {
        let mut z = (PI * k as f64 / degree as f64).cos();
        for _ in 0..50 {
            // Newton on P', with P'' from Legendre's equation
            let (value, slope) = legendre(degree, z);
            let curvature = (2.0 * z * slope - (degree * (degree + 1)) as f64 * value) / (1.0 - z * z);
            z -= slope / curvature;
        }
        nodes.push((z, weight(z)));
    }
    nodes.push((1.0, weight(1.0)));
    nodes
}

/// `P_n` and its derivative at `z` in (-1, 1); at 1 the value alone is meant.
fn legendre(n: usize, z: f64) -> (f64, f64) {
    let (mut below, mut p) = (0.0, 1.0);
    for l in 1..=n {
        let l = l as f64;
        (below, p) = (p, ((2.0 * l - 1.0) * z * p - (l - 1.0) * below) / l);
    }
    (p, n as f64 * (below - z * p) / (1.0 - z * z))
}

/// The factor of `cos mφ` or `sin mφ` in `y_lm` at height z.
pub(crate) fn latitude(order: usize, z: f64) -> impl Fn(usize, usize) -> f64 {
    let mut basis = vec![0.0; coefficients(order)];
    evaluate(order, [(1.0 - z * z).max(0.0).sqrt(), 0.0, z], &mut basis);
    move |l, m| basis[index(l, m as isize)]
}

/// The highest azimuthal frequency at height z, plus one.
fn frequencies(order: usize, z: f64) -> usize {
    if z == 1.0 { 1 } else { order }
}

/// A vector's series on the rings at z and -z.
fn to_rings(p: &mut Program, order: usize, vector: usize, z: f64, k: &[Vec<Factor>]) -> [Ring; 2] {
    let mut rings = [Ring::empty(order), Ring::empty(order)];
    for m in 0..frequencies(order, z) {
        let k = |l: usize| k[l][m];
        for sine in [false, true].into_iter().take(1 + usize::from(m > 0)) {
            let mut parity = |odd: usize| {
                let mut sum = Sum::default();
                for l in (m + odd..order).step_by(2) {
                    let x = p.input(vector, index(l, if sine { -(m as isize) } else { m as isize }));
                    sum.scaled(p, k(l), x);
                }
                sum.value()
            };
            let even = parity(0).expect("l = m is even");
            let odd = if z == 0.0 { None } else { parity(1) };
            for (at, ring) in rings.iter_mut().enumerate() {
                let value =
                    odd.map_or(even, |odd| p.push(if at == 0 { Op::Add(even, odd) } else { Op::Sub(even, odd) }));
                *(if sine { &mut ring.sin[m] } else { &mut ring.cos[m] }) = Some(value);
            }
        }
    }
    rings
}

/// The series of a product of two functions on a ring, truncated.
pub(crate) fn convolve(p: &mut Program, a: &Ring, b: &Ring) -> Ring {
    let n = a.cos.len();
    let (mut cos, mut sin) = (vec![Sum::default(); n], vec![Sum::default(); n]);
    let top = (0..n).rev().find(|&m| a.cos[m].is_some()).expect("m = 0 is there");
    let part = |ring: &Ring, m: usize| (ring.cos[m].expect("present"), ring.sin[m]);
    let (a0, b0) = (part(a, 0).0, part(b, 0).0);
    let sines = |(cos, sin): (Id, Option<Id>)| (cos, sin.expect("present"));
    let mut square = Sum::default();
    for m in 1..=top {
        let ((ac, a_s), (bc, bs)) = (sines(part(a, m)), sines(part(b, m)));
        if 2 * m < n {
            let [cc, ss] = [(ac, bc), (a_s, bs)].map(|(x, y)| p.push(Op::Mul(x, y)));
            plus_minus(p, (cc, ss), &mut square, &mut cos[2 * m]);
            sin[2 * m].product(p, ac, bs);
            sin[2 * m].product(p, a_s, bc);
        } else {
            square.product(p, ac, bc);
            square.product(p, a_s, bs);
        }
        cos[m].product(p, a0, bc);
        cos[m].product(p, ac, b0);
        sin[m].product(p, a0, bs);
        sin[m].product(p, a_s, b0);
    }
    if let Some(twice) = square.value() {
        cos[0].scaled(p, Factor::Literal(2.0), twice);
    }
    cos[0].product(p, a0, b0);
    for k in 1..=top {
        for m in 1..k {
            let ((acm, asm), (bcm, bsm)) = (sines(part(a, m)), sines(part(b, m)));
            let ((ack, ask), (bck, bsk)) = (sines(part(a, k)), sines(part(b, k)));
            if m + k < n {
                // Both m + k and k - m take the same products: multiplied once, added twice, which costs other units' time.
                let [cc, ss, sc, cs] = [
                    [(acm, bck), (ack, bcm)],
                    [(asm, bsk), (ask, bsm)],
                    [(ask, bcm), (acm, bsk)],
                    [(ack, bsm), (asm, bck)],
                ]
                .map(|products| sum_of(p, &products));
                let (low, high) = cos.split_at_mut(m + k);
                plus_minus(p, (cc, ss), &mut low[k - m], &mut high[0]);
                let (low, high) = sin.split_at_mut(m + k);
                plus_minus(p, (sc, cs), &mut high[0], &mut low[k - m]);
            } else {
                for (x, y) in [(acm, bck), (ack, bcm), (asm, bsk), (ask, bsm)] {
                    cos[k - m].product(p, x, y);
                }
                for (x, y) in [(ask, bcm), (acm, bsk)] {
                    sin[k - m].product(p, x, y);
                }
                for (x, y) in [(ack, bsm), (asm, bck)] {
                    sin[k - m].minus_product(p, x, y);
                }
            }
        }
    }
    finish(&cos, &sin)
}

fn sum_of(p: &mut Program, products: &[(Id, Id)]) -> Id {
    let mut sum = Sum::default();
    products.iter().for_each(|&(x, y)| sum.product(p, x, y));
    sum.value().expect("not empty")
}

/// Adds `x + y` to one sum and `x - y` to another.
fn plus_minus(p: &mut Program, (x, y): (Id, Id), plus: &mut Sum, minus: &mut Sum) {
    plus.scaled(p, Factor::Literal(1.0), x);
    plus.scaled(p, Factor::Literal(1.0), y);
    minus.scaled(p, Factor::Literal(1.0), x);
    minus.scaled(p, Factor::Literal(-1.0), y);
}

/// The series of a function's square on a ring, truncated.
pub(crate) fn convolve_self(p: &mut Program, a: &Ring) -> Ring {
    let n = a.cos.len();
    let (mut cos, mut sin) = (vec![Sum::default(); n], vec![Sum::default(); n]);
    let top = (0..n).rev().find(|&m| a.cos[m].is_some()).expect("m = 0 is there");
    let c = |m: usize| a.cos[m].expect("present");
    let s = |m: usize| a.sin[m].expect("present");
    let double: Vec<(Id, Id)> = (1..=top).map(|m| (p.push(Op::Add(c(m), c(m))), p.push(Op::Add(s(m), s(m))))).collect();
    let (twice_c, twice_s) = (|m: usize| double[m - 1].0, |m: usize| double[m - 1].1);
    cos[0].product(p, c(0), c(0));
    for m in 1..=top {
        cos[0].product(p, twice_c(m), c(m));
        cos[0].product(p, twice_s(m), s(m));
        cos[m].product(p, twice_c(m), c(0));
        sin[m].product(p, twice_s(m), c(0));
        if 2 * m < n {
            cos[2 * m].product(p, c(m), c(m));
            cos[2 * m].minus_product(p, s(m), s(m));
            sin[2 * m].product(p, twice_s(m), c(m));
        }
        for k in 1..m {
            if m + k < n {
                cos[m + k].product(p, twice_c(m), c(k));
                cos[m + k].minus_product(p, twice_s(m), s(k));
                sin[m + k].product(p, twice_s(m), c(k));
                sin[m + k].product(p, twice_c(m), s(k));
            }
            cos[m - k].product(p, twice_c(m), c(k));
            cos[m - k].product(p, twice_s(m), s(k));
            sin[m - k].product(p, twice_s(m), c(k));
            sin[m - k].minus_product(p, twice_c(m), s(k));
        }
    }
    finish(&cos, &sin)
}

fn finish(cos: &[Sum], sin: &[Sum]) -> Ring {
    Ring { cos: cos.iter().map(Sum::value).collect(), sin: sin.iter().map(Sum::value).collect() }
}

/// Adds what the rings at ±z contribute to the coefficients.
fn from_rings(p: &mut Program, order: usize, z: f64, k: &[Vec<Factor>], rings: &[Ring], out: &mut [Sum]) {
    for m in 0..frequencies(order, z) {
        let k = |l: usize| k[l][m];
        for sine in [false, true].into_iter().take(1 + usize::from(m > 0)) {
            let at = |ring: &Ring| if sine { ring.sin[m] } else { ring.cos[m] }.expect("present");
            let parts: Vec<Id> = match rings {
                [ring] => vec![at(ring)],
                [up, down, ..] if m + 1 < order => {
                    vec![p.push(Op::Add(at(up), at(down))), p.push(Op::Sub(at(up), at(down)))]
                }
                [up, down, ..] => vec![p.push(Op::Add(at(up), at(down)))],
                [] => unreachable!("one or two rings"),
            };
            for (odd, &part) in parts.iter().enumerate() {
                for l in (m + odd..order).step_by(2) {
                    let i = index(l, if sine { -(m as isize) } else { m as isize });
                    out[i].scaled(p, k(l), part);
                }
            }
        }
    }
}
