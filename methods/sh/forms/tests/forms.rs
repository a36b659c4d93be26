//! The forms against one another, against the algebra of `halflight-sh`, and against pointwise products by a published crate.

use halflight_sh::{coefficients, gamma};
use halflight_sh_forms::{Form, Fourier, MAX_ORDER, Rings, Scalar, Sparse};
use sphrs::{Coordinates, RealSH, SHEval};

fn vector(order: usize, phase: f64) -> Vec<f64> {
    (0..coefficients(order)).map(|i| (1.7 * i as f64 + phase).sin()).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    norm(&a.iter().zip(b).map(|(x, y)| x - y).collect::<Vec<_>>())
}

fn run<T: Scalar>(mut form: impl Form<T>, a: &[f64], b: &[f64]) -> Vec<f64> {
    let [a, b] = [a, b].map(|v| v.iter().map(|&x| T::of(x)).collect::<Vec<T>>());
    let mut out = vec![T::of(f64::NAN); a.len()];
    // twice: scratch memory of the first time must not show
    form.product(&b, &b, &mut out);
    form.product(&a, &b, &mut out);
    out.iter().map(|x| x.wide()).collect()
}

fn all<T: Scalar>(order: usize, a: &[f64], b: &[f64]) -> [(&'static str, Vec<f64>); 3] {
    [
        ("sparse", run::<T>(Sparse::new(order), a, b)),
        ("rings", run::<T>(Rings::new(order), a, b)),
        ("fourier", run::<T>(Fourier::new(order), a, b)),
    ]
}

#[test]
fn forms_are_the_product_of_the_algebra() {
    for order in 1..=8 {
        let (a, b) = (vector(order, 0.3), vector(order, 1.1));
        let mut want = a.clone();
        gamma(order).product(&a, &b, &mut want);
        assert_eq!(Sparse::<f64>::new(order).entries(), gamma(order).triples().len());
        let scale = norm(&a) * norm(&b);
        for (name, got) in all::<f64>(order, &a, &b) {
            assert!(distance(&got, &want) < 1e-14 * scale, "{name}, order {order}: {}", distance(&got, &want) / scale);
        }
        for (name, got) in all::<f32>(order, &a, &b) {
            assert!(distance(&got, &want) < 5e-7 * scale, "{name}, order {order}: {}", distance(&got, &want) / scale);
        }
    }
}

/// The product of two functions of half the order is not truncated: it is the pointwise product. `sphrs` evaluates bands up to
/// 10; beyond, its factorials overflow.
#[test]
fn products_hold_pointwise() {
    for order in 1..=12 {
        let low = |phase: f64| {
            let mut v = vector(order, phase);
            v[coefficients(order.div_ceil(2))..].fill(0.0);
            v
        };
        let (a, b) = (low(0.3), low(1.1));
        let products = all::<f64>(order, &a, &b);
        for [x, y, z] in [[0.48, 0.6, 0.64], [-0.6, 0.0, -0.8], [0.36, -0.48, 0.8]] {
            let s = Coordinates::cartesian(x, y, z);
            let value = |v: &[f64]| -> f64 {
                let functions = (0..order as i64).flat_map(|l| (-l..=l).map(move |m| (l, m)));
                functions.zip(v).map(|((l, m), c)| c * RealSH::Spherical.eval(l, m, &s)).sum()
            };
            let want = value(&a) * value(&b);
            for (name, product) in &products {
                let error = (value(product) - want).abs();
                assert!(error < 1e-13 * norm(&a) * norm(&b) * order as f64, "{name}, order {order}: off by {error:e}");
            }
        }
    }
}

/// Where products are truncated: three forms, three ways to the same.
#[test]
fn forms_agree_at_every_order() {
    for order in 1..=MAX_ORDER {
        let (a, b) = (vector(order, 2.3), vector(order, -0.4));
        let [(_, sparse), rest @ ..] = all::<f64>(order, &a, &b);
        for (name, got) in rest {
            let error = distance(&got, &sparse) / (norm(&a) * norm(&b));
            assert!(error < 2e-14, "{name}, order {order}: {error:e}");
        }
    }
}

#[test]
#[should_panic(expected = "order 17: expected 1 to 16")]
fn other_orders_are_refused() {
    let _ = Fourier::<f32>::new(17);
}
