//! The product as factored triples: all entries `Γ_ijk` of one pair (i, j) share three sums (Sloan 2008).
//!
//! For the pair: `A = Σ_k Γ_ijk a_k`, `B = Σ_k Γ_ijk b_k`, `t = a_i b_j + a_j b_i`; then `out_i += A b_j + B a_j`,
//! `out_j += A b_i + B a_i` and `out_k += Γ_ijk t`: `3c + 6` instructions for `c` entries, `3c + 3` if `i = j`.
//! Pairs are taken greedily, the one with most entries left first; sums that pairs share are computed once.

use halflight_sh::{coefficients, gamma};

use crate::linear::{Forms, Transposed};
use crate::program::{Id, Program};

/// Which of two equally good pairs to take: tried in turn, the shortest program wins.
const TIES: u64 = 256;

/// Entries of Γ differ by at least 1e-6 or are equal up to the rounding of their quadrature.
const ROUNDING: f64 = 1e-12;

/// A pair (i, j) with its entries (k, Γ_ijk).
#[derive(Clone, Debug)]
struct Pair {
    i: usize,
    j: usize,
    entries: Vec<(usize, f64)>,
}

/// What a program does with its factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `a * b`.
    Product,
    /// `a * a`.
    Square,
}

/// How much pairs have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sharing {
    /// Every pair for itself.
    None,
    /// Common factors are taken out of sums.
    Factors,
    /// Also, parts that at least so many pairs' sums hold are computed once.
    Parts(usize),
}

/// The shortest program found.
pub fn build(order: usize, kind: Kind) -> Program {
    let ties = if order > 5 { 1 } else { TIES };
    let covers: Vec<_> = (0..ties).map(|tie| cover(order, tie)).collect();
    let sharing = [Sharing::Factors, Sharing::Parts(4), Sharing::Parts(3), Sharing::Parts(2)];
    let programs = covers.iter().flat_map(|pairs| sharing.map(|sharing| from_pairs(order, kind, pairs, sharing)));
    programs.min_by_key(Program::count).expect("at least one")
}

/// The product by the plain greedy choice, every pair for itself: what public generated code does, and the denominator of
/// speed-ups.
pub fn build_plain(order: usize) -> Program {
    from_pairs(order, Kind::Product, &cover(order, 0), Sharing::None)
}

/// Assigns each triple to one of its pairs, greedily; a triple with two equal indices can only go with these.
fn cover(order: usize, tie: u64) -> Vec<Pair> {
    let size = coefficients(order);
    let mut left = entries(order);
    let mut pairs = Vec::new();
    while !left.is_empty() {
        let mut counts = vec![0u64; size * size];
        for (triple, _) in &left {
            candidates(*triple).iter().for_each(|(i, j, _)| counts[i * size + j] += 1);
        }
        let best = (0..size * size).max_by_key(|&at| (counts[at], scatter(at as u64, tie))).expect("not empty");
        let (i, j) = (best / size, best % size);
        let mut entries = Vec::new();
        left.retain(|&(triple, value)| {
            let third = candidates(triple).into_iter().find(|&(p, q, _)| (p, q) == (i, j));
            entries.extend(third.map(|(_, _, k)| (k, value)));
            third.is_none()
        });
        pairs.push(Pair { i, j, entries });
    }
    pairs
}

/// The entries of Γ, those that differ by rounding alone made the same.
fn entries(order: usize) -> Vec<([usize; 3], f64)> {
    let mut known: Vec<f64> = Vec::new();
    let mut canonical = |value: f64| {
        let same = known.iter().copied().find(|k| (k - value.abs()).abs() < ROUNDING);
        same.unwrap_or_else(|| {
            known.push(value.abs());
            value.abs()
        })
        .copysign(value)
    };
    gamma(order).triples().iter().map(|t| ([t.i.into(), t.j.into(), t.k.into()], canonical(t.value))).collect()
}

/// The pairs that may hold a sorted triple, each with the index that is left.
fn candidates([i, j, k]: [usize; 3]) -> Vec<(usize, usize, usize)> {
    match (i == j, j == k) {
        (false, false) => vec![(i, j, k), (i, k, j), (j, k, i)],
        (true, _) => vec![(i, i, k)],
        (false, true) => vec![(j, j, i)],
    }
}

/// A fixed shuffle; the first one keeps the order.
fn scatter(at: u64, tie: u64) -> u64 {
    if tie == 0 { u64::MAX - at } else { (at + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15 ^ (tie << 17 | tie)) >> 20 }
}

fn from_pairs(order: usize, kind: Kind, pairs: &[Pair], sharing: Sharing) -> Program {
    // `A a_j + A a_j` of a square: the factor 2 goes into A.
    let scale = if kind == Kind::Square { 2.0 } else { 1.0 };
    // Γ_iii enters only once, at the end.
    let others = |pair: &Pair| {
        let entries = pair.entries.iter().filter(|entry| pair.i != pair.j || entry.0 != pair.i);
        entries.map(|&(k, value)| (k, scale * value)).collect()
    };
    let mut forms = Forms::new(coefficients(order), pairs.iter().map(others).collect());
    match sharing {
        Sharing::None => forms = forms.ungrouped(),
        Sharing::Factors => {}
        Sharing::Parts(uses) => forms.share(uses),
    }
    let mut program = if sharing == Sharing::None { Program::verbatim() } else { Program::default() };
    let p = &mut program;
    let mut out = forms.transposed();
    let (mut of_a, mut of_b) = (forms.of(0), forms.of(1));
    for (row, &Pair { i, j, ref entries }) in pairs.iter().enumerate() {
        let (ai, aj) = (p.input(0, i), p.input(0, j));
        let a = of_a.row(p, row);
        let (products, factor) = match kind {
            Kind::Product => {
                let (bi, bj) = (p.input(1, i), p.input(1, j));
                let b = of_b.row(p, row);
                add_pair(p, &mut out, (i, j), &[(a, bi, bj), (b, ai, aj)]);
                if i == j { (vec![(ai, bi)], 1.0) } else { (vec![(ai, bj), (aj, bi)], 1.0) }
            }
            Kind::Square => {
                add_pair(p, &mut out, (i, j), &[(a, ai, aj)]);
                (vec![(ai, aj)], if i == j { 0.5 } else { 1.0 })
            }
        };
        out.add(p, row, factor, &products);
        let cube = entries.iter().find(|entry| i == j && entry.0 == i);
        cube.into_iter().for_each(|&(_, value)| out.add_to_group(p, i, value, &products));
    }
    let outputs = out.finish(p);
    outputs.into_iter().enumerate().for_each(|(index, value)| program.output(index, value));
    program
}

/// Adds `sum·x_j` to `out_i` and, for two different indices, `sum·x_i` to `out_j`.
fn add_pair(p: &mut Program, out: &mut Transposed<'_>, (i, j): (usize, usize), terms: &[(Option<Id>, Id, Id)]) {
    for &(sum, xi, xj) in terms {
        let Some(sum) = sum else { continue };
        out.sum(i).product(p, sum, xj);
        if i != j {
            out.sum(j).product(p, sum, xi);
        }
    }
}
