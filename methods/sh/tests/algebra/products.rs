//! Identities of evaluation, projection and the SH product, for every order in both precisions.

use crate::common::{constant, convert, distance, dot, norm, unit_vector, vectors};
use halflight_sh::{MAX_ORDER, Quadrature, Real, coefficients, evaluate, gamma, project};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

fn value(order: usize, v: &[f64], s: [f64; 3]) -> f64 {
    let mut basis = constant(order, 0.0);
    evaluate(order, s, &mut basis);
    dot(&basis, v)
}

/// Rounding allowed in a result of this magnitude.
fn tolerance<T: Real>(scale: f64) -> f64 {
    64.0 * T::EPSILON.to_f64() * scale
}

fn product<T: Real>(order: usize, a: &[f64], b: &[f64]) -> Vec<T> {
    let mut out = vec![T::from_f64(f64::NAN); coefficients(order)];
    gamma(order).product::<T>(&convert(a), &convert(b), &mut out);
    out
}

fn product_identities<T: Real>(order: usize, [a, b, c]: [&[f64]; 3]) -> Result<(), TestCaseError> {
    let tensor = gamma(order);
    let scale = norm(a) * norm(b) * order as f64 + f64::MIN_POSITIVE;
    let ab = product::<T>(order, a, b);

    // commutes, is linear, has 1 as its unit
    prop_assert!(distance(&ab, &product::<T>(order, b, a)) <= tolerance::<T>(scale));
    let shifted: Vec<f64> = b.iter().zip(c).map(|(b, c)| 2.0 * b - c).collect();
    let ac = product::<T>(order, a, c);
    let combined: Vec<f64> = ab.iter().zip(&ac).map(|(x, y)| 2.0 * x.to_f64() - y.to_f64()).collect();
    let wide = scale + norm(a) * norm(c) * order as f64;
    prop_assert!(distance(&product::<T>(order, a, &shifted), &combined) <= 4.0 * tolerance::<T>(wide));
    prop_assert!(distance(&product::<T>(order, a, &constant(order, 1.0)), a) <= tolerance::<T>(norm(a)));

    // is the projection of the pointwise product
    let rule = Quadrature::exact(3 * (order - 1));
    let projected = project(order, &rule, |s| value(order, a, s) * value(order, b, s));
    prop_assert!(distance(&ab, &projected) <= tolerance::<T>(scale));

    // agrees with the square, the triple product and the product matrix
    let mut square = vec![T::from_f64(f64::NAN); a.len()];
    tensor.square::<T>(&convert(a), &mut square);
    prop_assert!(distance(&square, &product::<T>(order, a, a)) <= tolerance::<T>(norm(a).powi(2) * order as f64));

    let triple = tensor.triple_product::<T>(&convert(a), &convert(b), &convert(c)).to_f64();
    let integral = rule.integrate(|s| value(order, a, s) * value(order, b, s) * value(order, c, s));
    prop_assert!((triple - integral).abs() <= tolerance::<T>(scale * norm(c)), "{triple} instead of {integral}");

    let mut matrix = vec![T::from_f64(f64::NAN); a.len() * a.len()];
    tensor.product_matrix::<T>(&convert(a), &mut matrix);
    let rows: Vec<f64> =
        matrix.chunks_exact(a.len()).map(|row| row.iter().zip(b).map(|(m, b)| m.to_f64() * b).sum()).collect();
    prop_assert!(distance(&ab, &rows) <= tolerance::<T>(scale));
    for i in 0..a.len() {
        for j in 0..i {
            prop_assert_eq!(matrix[i * a.len() + j], matrix[j * a.len() + i]);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn products_obey_their_identities((order, v) in vectors(3)) {
        product_identities::<f32>(order, [&v[0], &v[1], &v[2]])?;
        product_identities::<f64>(order, [&v[0], &v[1], &v[2]])?;
    }

    #[test]
    fn projection_returns_the_coefficients((order, v) in vectors(1)) {
        let back = project(order, &Quadrature::exact(2 * (order - 1)), |s| value(order, &v[0], s));
        prop_assert!(distance(&back, &v[0]) < 1e-13);
    }

    #[test]
    fn precisions_agree(order in 1usize..=8, s in unit_vector()) {
        let (mut single, mut double) = (constant::<f32>(order, 0.0), constant::<f64>(order, 0.0));
        evaluate(order, s.map(|x| x as f32), &mut single);
        evaluate(order, s, &mut double);
        prop_assert!(distance(&single, &double) < 1e-5);
    }
}

#[test]
fn basis_is_orthonormal() {
    let rule = Quadrature::exact(2 * (MAX_ORDER - 1));
    let size = coefficients(MAX_ORDER);
    for i in 0..size {
        let column = project(MAX_ORDER, &rule, |s| {
            let mut basis = constant(MAX_ORDER, 0.0);
            evaluate(MAX_ORDER, s, &mut basis);
            basis[i]
        });
        let unit: Vec<f64> = (0..size).map(|j| f64::from(u8::from(i == j))).collect();
        assert!(distance(&column, &unit) < 1e-13, "function {i}");
    }
}

/// A lower order is the leading part of a higher one.
#[test]
fn orders_nest() {
    let mut high = constant(MAX_ORDER, 0.0);
    evaluate(MAX_ORDER, [0.36, 0.48, -0.8], &mut high);
    for order in 1..MAX_ORDER {
        let mut low = constant(order, 0.0);
        evaluate(order, [0.36, 0.48, -0.8], &mut low);
        assert_eq!(low, high[..coefficients(order)]);
        let nested = gamma(MAX_ORDER).triples().iter().filter(|t| usize::from(t.k) < coefficients(order)).count();
        assert_eq!(nested, gamma(order).triples().len());
    }
}
