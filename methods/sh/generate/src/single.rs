//! The product of one pair of vectors: the θ-separable form with a ring in each lane, at Gauss–Legendre nodes.

use std::f64::consts::PI;

use halflight_sh::{coefficients, gauss_legendre, index};

use crate::lobatto::{Ring, convolve, convolve_self, latitude};
use crate::program::{Id, Program, Sum};
use crate::triples::Kind;

/// The most rings, and the lanes of a table's rows.
pub const ROW: usize = 16;

/// Constants of each ring: a row for each l and m of `0..=l`, a lane for each ring.
pub struct Tables {
    /// The number of rings; lanes beyond hold 0.
    pub rings: usize,
    /// From coefficients to the series on a ring.
    pub forward: Vec<[f64; ROW]>,
    /// Back, with the weights of the quadrature.
    pub backward: Vec<[f64; ROW]>,
}

/// The tables of an order: as many rings as are exact for the degree `3(n - 1)`.
pub fn tables(order: usize) -> Tables {
    let rings = (3 * order - 1) / 2;
    let (nodes, weights) = gauss_legendre(rings);
    let rows = order * (order + 1) / 2;
    let [mut forward, mut backward] = [0; 2].map(|_| vec![[0.0; ROW]; rows]);
    for (ring, (&z, &weight)) in nodes.iter().zip(&weights).enumerate() {
        let k = latitude(order, z);
        for l in 0..order {
            for m in 0..=l {
                forward[row(l, m)][ring] = if m == 0 { k(l, m) } else { 0.5 * k(l, m) };
                backward[row(l, m)][ring] = 2.0 * PI * weight * k(l, m);
            }
        }
    }
    Tables { rings, forward, backward }
}

fn row(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m
}

/// The program of all rings at once. Inputs: the vectors (each coefficient in all lanes), the forward and the backward
/// table; outputs: what each ring adds to a coefficient.
pub fn build(order: usize, kind: Kind) -> Program {
    let mut program = Program::default();
    let p = &mut program;
    let vectors = if kind == Kind::Product { 2 } else { 1 };
    let factors: Vec<Ring> = (0..vectors).map(|vector| to_ring(p, order, vector, vectors)).collect();
    let product = match &factors[..] {
        [a, b] => convolve(p, a, b),
        [a, ..] => convolve_self(p, a),
        [] => unreachable!("one or two factors"),
    };
    let mut outputs: Vec<Option<Id>> = vec![None; coefficients(order)];
    for l in 0..order {
        for m in 0..=l {
            let k = p.input(vectors + 1, row(l, m));
            for (values, i) in [(&product.sin, index(l, -(m as isize))), (&product.cos, index(l, m as isize))] {
                outputs[i] = values[m].map(|value| multiply(p, k, value)).or(outputs[i]);
            }
        }
    }
    outputs.into_iter().enumerate().for_each(|(i, value)| p.output(i, value.expect("every coefficient is reached")));
    program
}

fn multiply(p: &mut Program, x: Id, y: Id) -> Id {
    let mut sum = Sum::default();
    sum.product(p, x, y);
    sum.value().expect("just added")
}

fn to_ring(p: &mut Program, order: usize, vector: usize, table: usize) -> Ring {
    let mut ring = Ring::empty(order);
    for m in 0..order {
        let (mut cos, mut sin) = (Sum::default(), Sum::default());
        for l in m..order {
            let k = p.input(table, row(l, m));
            let x = p.input(vector, index(l, m as isize));
            cos.product(p, k, x);
            if m > 0 {
                let x = p.input(vector, index(l, -(m as isize)));
                sin.product(p, k, x);
            }
        }
        (ring.cos[m], ring.sin[m]) = (cos.value(), sin.value());
    }
    ring
}
