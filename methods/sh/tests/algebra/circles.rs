//! Circles: visibility and log against quadrature, the tables, and the figures of Ren 2006's algebra.

use crate::common::{circle, distance, irradiance, norm, scaled};
use halflight_sh::{
    CircleTable, ExpWorkspace, Real, circle_log, circle_visibility, evaluate, exp_exact, gamma, gauss_legendre, index,
    log_eigen, project_binary_bound,
};
use proptest::prelude::*;

const UP: [f64; 3] = [0.0, 0.0, 1.0];

fn eigen_exp(order: usize, f: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; f.len()];
    ExpWorkspace::new(order).eigen(f, &mut out);
    out
}

fn largest_difference<T: Real>(a: &[f64], b: &[T]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y.to_f64()).abs()))
}

/// The value printed with `digits` after the point.
fn prints_as(value: f64, printed: f64, digits: i32) -> bool {
    (value - printed).abs() <= 0.5001 * 10f64.powi(-digits)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Gauss quadrature over the open part, where the integrand is a polynomial in z.
    #[test]
    fn visibility_is_the_projection(order in 1usize..=8, cos in -1.0f64..=1.0) {
        let mut zonal = vec![f64::NAN; order];
        circle_visibility(order, cos, &mut zonal);
        let (nodes, weights) = gauss_legendre(5);
        let half = 0.5 * (cos + 1.0);
        for (l, got) in zonal.iter().enumerate() {
            let integral: f64 = nodes.iter().zip(&weights).map(|(x, w)| {
                let z = (half * (x + 1.0) - 1.0).clamp(-1.0, 1.0);
                let mut y = vec![0.0; order * order];
                evaluate(order, [(1.0 - z * z).sqrt(), 0.0, z], &mut y);
                std::f64::consts::TAU * half * w * y[index(l, 0)]
            }).sum();
            prop_assert!((got - integral).abs() < 1e-13, "band {}: {} instead of {}", l, got, integral);
        }
    }

    #[test]
    fn log_from_blocks_is_the_log_of_the_whole_matrix(order in 1usize..=8, degrees in 0.0f64..=90.0) {
        let (g, f) = circle(order, degrees, UP);
        let mut whole = vec![f64::NAN; g.len()];
        log_eigen(order, &g, &mut whole);
        prop_assert!(distance(&f, &whole) < 1e-9);
    }

    #[test]
    fn circles_satisfy_the_binary_bound(order in 1usize..=8, degrees in 0.0f64..=180.0, axis in crate::common::unit_vector()) {
        let mut zonal = vec![0.0; order];
        let mut g = vec![0.0; order * order];
        circle_visibility(order, degrees.to_radians().cos(), &mut zonal);
        halflight_sh::rotate_zonal(order, &zonal, axis, &mut g);
        prop_assert!(!project_binary_bound(order, &mut g.clone()));
        let mut single = crate::common::convert::<f32>(&g);
        prop_assert!(!project_binary_bound(order, &mut single));
    }
}

/// The tables' stated errors, in both precisions; single precision is judged at the sine that it was given.
#[test]
fn tables_keep_their_stated_errors() {
    for order in 1..=8 {
        let (mut exact, mut from_double, mut from_single) = (vec![0.0; order], vec![0.0; order], vec![0.0f32; order]);
        let mut worst = [0.0f64; 4];
        for step in 0..=1500 {
            let single = (f64::from(step) * 0.06).to_radians().sin() as f32;
            let double = f64::from(single);
            let cos = ((1.0 - double) * (1.0 + double)).sqrt();
            for (log, table) in [(0, CircleTable::visibility(order)), (1, CircleTable::log(order))] {
                if log == 0 {
                    circle_visibility(order, cos, &mut exact)
                } else {
                    circle_log(order, cos, &mut exact)
                }
                table.lookup(double, &mut from_double);
                table.lookup(single, &mut from_single);
                worst[log] = worst[log].max(largest_difference(&exact, &from_double));
                worst[2 + log] = worst[2 + log].max(largest_difference(&exact, &from_single));
            }
        }
        let stated = [2.5e-7, 6e-7, 1e-6, 4e-6];
        assert!(worst.iter().zip(stated).all(|(w, s)| *w < s), "order {order}: {worst:?} over {stated:?}");
    }
}

#[test]
fn tables_end_in_the_empty_and_the_half_covered_sky() {
    for order in 1..=8 {
        let mut out = vec![f32::NAN; order];
        for (sin, mean) in [(0.0, 1.0), (-1.0, 1.0), (f32::NAN, 1.0), (1.0, 0.5), (1.1, 0.5), (f32::INFINITY, 0.5)] {
            CircleTable::visibility(order).lookup(sin, &mut out);
            assert!((f64::from(out[0]) - mean * crate::common::SQRT_4_PI).abs() < 1e-6);
            CircleTable::log(order).lookup(sin, &mut out);
            assert!(out.iter().all(|v| v.is_finite()));
            assert!(mean < 1.0 || out.iter().all(|v| v.abs() < 1e-12));
        }
    }
}

/// `‖exp(log g) - g‖/‖g‖` of one circle at order 4, by the eigen exponential and by the exact one of the same log.
#[test]
fn reproduction_of_one_circle() {
    for (degrees, eigen, digits, exact) in [
        (30.0, 2.4e-5, 6, Some(0.0041)),
        (45.0, 0.0011, 4, Some(0.0458)),
        (48.0, 0.0033, 4, None),
        (60.0, 0.0455, 4, Some(0.0755)),
        (75.0, 0.0432, 4, Some(0.0348)),
        (90.0, 0.0182, 4, Some(0.1039)),
    ] {
        let (g, f) = circle(4, degrees, UP);
        let error = distance(&eigen_exp(4, &f), &g) / norm(&g);
        assert!(prints_as(error, eigen, digits), "{degrees}°, eigen: {error} instead of {eigen}");
        if let Some(want) = exact {
            let mut out = vec![f64::NAN; 16];
            exp_exact(4, &f, &mut out);
            let error = distance(&out, &g) / norm(&g);
            assert!(prints_as(error, want, 4), "{degrees}°, exact: {error} instead of {want}");
        }
    }
}

/// The norms that key the optimal linear coefficients at order 4, and where they stop growing.
#[test]
fn norms_of_circle_logs() {
    let hat = |order, degrees| norm(&circle(order, degrees, UP).1[1..]);
    for (degrees, want, digits) in
        [(30.0, 1.009, 3), (45.0, 3.05, 2), (50.0, 4.90, 2), (60.0, 5.36, 2), (90.0, 6.47, 2)]
    {
        assert!(prints_as(hat(4, degrees), want, digits), "{degrees}°: {} instead of {want}", hat(4, degrees));
    }
    let falls_within = |order, from: f64, to: f64| hat(order, from) > hat(order, to);
    for order in [2, 4] {
        assert!((0..90).all(|d| !falls_within(order, f64::from(d), f64::from(d + 1))), "order {order} is monotone");
    }
    assert!(falls_within(3, 80.0, 90.0) && falls_within(5, 85.0, 90.0) && falls_within(6, 73.0, 80.0));
}

/// N coincident circles of 15° overhead at order 4: the truth is 0.933 for every N. The printed figures are those of the
/// exponential of N times the log (by eigenanalysis); the ordered product has 0.929, 0.703, 0.765, 1.42, 8.91.
#[test]
fn coincident_circles() {
    let (g, f) = circle(4, 15.0, UP);
    let product_of = |count: usize| {
        let mut total = g.clone();
        let mut next = vec![f64::NAN; 16];
        for _ in 1..count {
            gamma(4).product(&total, &g, &mut next);
            std::mem::swap(&mut total, &mut next);
        }
        irradiance(4, &total)
    };
    let table =
        [(1, 0.929, 0.929, 3), (10, 0.703, 0.703, 3), (20, 0.764, 0.765, 3), (60, 1.40, 1.42, 2), (200, 8.35, 8.91, 2)];
    for (count, exponential, product, digits) in table {
        let by_log = irradiance(4, &eigen_exp(4, &scaled(&f, count as f64)));
        assert!(prints_as(by_log, exponential, digits), "{count} circles, exponential: {by_log}");
        assert!(prints_as(product_of(count), product, digits), "{count} circles, product: {}", product_of(count));
    }
    // what a black circle about the zenith leaves of the irradiance, 1 - sin² 15°, up to the truncation
    assert!((irradiance(4, &g) - 15f64.to_radians().cos().powi(2)).abs() < 0.004);
}
