//! Generates the product kernels of `halflight-sh`: straight-line code for each order.
//!
//! Two exact forms compete: factored triples ([`triples`]) and the θ-separable form ([`lobatto`]). [`files`] prints for each
//! order and operation the form that is fastest; `cargo run -p halflight-sh-generate` writes them, and a test holds what is
//! checked in against what would be written.

pub mod basis;
pub mod linear;
pub mod lobatto;
mod print;
pub mod program;
pub mod single;
pub mod sums;
pub mod triples;

pub use print::files;

use lobatto::Place;
use program::Program;
use triples::Kind;

/// A form of the product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Factored triples.
    Triples,
    /// Rings of constant z at Gauss–Lobatto nodes.
    Lobatto,
}

impl Form {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Triples, Self::Lobatto];

    /// The form that was measured to be the faster one. At order 4 triples have fewer instructions, yet a product of them
    /// spills the 16 registers of AVX2.
    pub fn fastest(order: usize, kind: Kind) -> Self {
        let triples_up_to = if kind == Kind::Product { 3 } else { 4 };
        if order <= triples_up_to { Self::Triples } else { Self::Lobatto }
    }

    /// The programs of an order, to be run one after the other on outputs that begin as 0.
    pub fn build(self, order: usize, kind: Kind) -> Vec<(Place, Program)> {
        match self {
            Self::Triples => vec![(Place::Poles, triples::build(order, kind))],
            Self::Lobatto => lobatto::build(order, kind),
        }
    }

    /// Instructions of all programs.
    pub fn count(self, order: usize, kind: Kind) -> usize {
        self.build(order, kind).iter().map(|(_, program)| program.count()).sum()
    }

    /// Those among them that multiply.
    pub fn count_multiplications(self, order: usize, kind: Kind) -> usize {
        self.build(order, kind).iter().map(|(_, program)| program.count_multiplications()).sum()
    }

    fn name(self) -> &'static str {
        match self {
            Self::Triples => "factored triples",
            Self::Lobatto => "Gauss–Lobatto rings",
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use halflight_sh::{MAX_ORDER, coefficients, gamma};

    use super::*;

    fn vector(order: usize, phase: f64) -> Vec<f64> {
        (0..coefficients(order)).map(|i| (2.3 * i as f64 + phase).sin()).collect()
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).fold(0.0, |largest, (x, y)| largest.max((x - y).abs()))
    }

    fn run(programs: &[(Place, Program)], inputs: &[&[f64]], size: usize) -> Vec<f64> {
        let mut out = vec![0.0; size];
        for (_, program) in programs {
            let before = out.clone();
            program.run(&[inputs, &[&before]].concat(), &mut out);
        }
        out
    }

    #[test]
    fn programs_compute_products_and_squares() {
        for order in 1..=MAX_ORDER {
            let (a, b) = (vector(order, 0.3), vector(order, 1.1));
            let (mut product, mut square) = (a.clone(), a.clone());
            gamma(order).product(&a, &b, &mut product);
            gamma(order).square(&a, &mut square);
            for form in Form::ALL {
                let made = run(&form.build(order, Kind::Product), &[&a, &b], a.len());
                assert!(largest_difference(&made, &product) < 3e-14, "{form:?}, order {order}: product");
                let made = run(&form.build(order, Kind::Square), &[&a], a.len());
                assert!(largest_difference(&made, &square) < 3e-14, "{form:?}, order {order}: square");
            }
            let plain = [(Place::Poles, triples::build_plain(order))];
            assert!(largest_difference(&run(&plain, &[&a, &b], a.len()), &product) < 3e-14, "plain, order {order}");
        }
    }

    #[test]
    fn basis_programs_evaluate_and_rotate() {
        use basis::Output;
        for order in 1..=MAX_ORDER {
            for direction in [[0.48, 0.6, 0.64], [0.0, 0.0, 1.0], [-0.6, 0.0, -0.8], [6.0 / 7.0, -2.0 / 7.0, 3.0 / 7.0]]
            {
                let zonal: Vec<f64> = (0..order).map(|l| (l as f64 + 0.4).sin()).collect();
                let [mut basis, mut lobe] = [0; 2].map(|_| vec![0.0; coefficients(order)]);
                halflight_sh::evaluate(order, direction, &mut basis);
                halflight_sh::rotate_zonal(order, &zonal, direction, &mut lobe);
                for (output, want) in [(Output::Basis, &basis), (Output::Lobe, &lobe)] {
                    let mut out = vec![f64::NAN; want.len()];
                    basis::build(order, output).run(&[&direction, &zonal], &mut out);
                    assert!(largest_difference(&out, want) < 1e-13, "{output:?}, order {order}");
                }
                let (scales, mut sum) = (sums::scales(order), vec![f64::NAN; lobe.len()]);
                let before: Vec<f64> = vector(order, 0.2).iter().zip(&scales).map(|(a, scale)| a / scale).collect();
                for columns in sums::groups(order) {
                    sums::build(order, columns).run(&[&direction, &zonal, &before], &mut sum);
                }
                let sum: Vec<f64> = sum.iter().zip(&scales).map(|(a, scale)| a * scale).collect();
                let want: Vec<f64> = vector(order, 0.2).iter().zip(&lobe).map(|(a, b)| a + b).collect();
                assert!(largest_difference(&sum, &want) < 1e-13, "sum, order {order}");
            }
        }
    }

    /// No more instructions than the best counts known to us; squares at most three quarters of products.
    #[test]
    fn programs_are_short() {
        for (order, triples, rings) in [(3, 120, 160), (4, 347, 404), (5, 1135, 968), (6, 2527, 1645)] {
            assert!(Form::Triples.count(order, Kind::Product) <= triples, "triples, order {order}");
            assert!(Form::Lobatto.count(order, Kind::Product) <= rings, "rings, order {order}");
            let [product, square] =
                [Kind::Product, Kind::Square].map(|kind| Form::fastest(order, kind).count(order, kind));
            assert!(4 * square <= 3 * product, "order {order}: {square} of {product}");
        }
    }

    #[test]
    fn checked_in_files_are_what_is_generated() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        for (path, text) in files() {
            let found = fs::read_to_string(root.join(&path)).unwrap_or_default();
            assert!(found == text, "methods/sh/{path} is stale: run `cargo run -p halflight-sh-generate`");
        }
    }
}
