//! The exponentials against each other, closed forms and their stated limits.

use crate::common::{blockers, circle, constant, convert, distance, dot, norm, scaled, sum, vectors};
use halflight_sh::{
    ExpWorkspace, Real, SquaringRule, SymmetricEigen, Work, exp_exact, gamma, log_eigen, log_naive,
    project_binary_bound,
};
use proptest::prelude::*;

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Every variant that runs per receiver, by name.
const VARIANTS: [&str; 6] = ["ps-8", "ps*-2", "ps*-5", "ol", "hyb", "eigen"];

fn run<T: Real>(name: &str, order: usize, f: &[f64]) -> Vec<T> {
    let f = convert::<T>(f);
    let mut out = vec![T::from_f64(f64::NAN); f.len()];
    let mut exp = ExpWorkspace::<T>::new(order);
    let rule = SquaringRule::default();
    match name {
        "ps-8" => exp.product_series(8, &f, &mut out),
        "ps*-2" => exp.scaled_series(2, rule, &f, &mut out),
        "ps*-5" => exp.scaled_series(5, rule, &f, &mut out),
        "ol" => exp.optimal_linear(&f, &mut out),
        "hyb" => exp.hybrid(rule, &f, &mut out),
        "eigen" => exp.eigen(&f, &mut out),
        other => unreachable!("no variant {other}"),
    };
    out
}

#[test]
fn exponential_of_a_constant_is_its_exponential() {
    for order in 1..=8 {
        for mean in [0.0, -0.5, -20.0, 1.0] {
            let (f, want) = (constant::<f64>(order, mean), constant::<f64>(order, mean.exp()));
            for name in VARIANTS.into_iter().filter(|&name| name != "ps-8" || mean == 0.0) {
                assert!(distance(&run::<f64>(name, order, &f), &want) < 1e-12, "{name}, order {order}, {mean}");
                assert!(
                    distance(&run::<f32>(name, order, &f), &want) < 4e-6 * mean.exp(),
                    "{name}, order {order}, {mean}"
                );
            }
            let mut out = want.clone();
            exp_exact(order, &f, &mut out);
            assert!(distance(&out, &want) < 1e-11);
        }
    }
}

/// `exp f = Σ M_f^k 1/k!`, summed here in f64 to convergence.
fn series_of_matrix(order: usize, f: &[f64]) -> Vec<f64> {
    let mut term = constant::<f64>(order, 1.0);
    let mut total = term.clone();
    let mut next = term.clone();
    for k in 1..200 {
        gamma(order).product(f, &term, &mut next);
        term = scaled(&next, 1.0 / f64::from(k));
        total.iter_mut().zip(&term).for_each(|(t, x)| *t += x);
    }
    total
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn eigen_is_the_whole_series((order, v) in vectors(1), length in 0.0f64..4.0) {
        let f = scaled(&v[0], length / norm(&v[0]).max(1e-9));
        let want = series_of_matrix(order, &f);
        prop_assert!(distance(&run::<f64>("eigen", order, &f), &want) < 1e-11 * norm(&want));
        prop_assert!(distance(&run::<f32>("eigen", order, &f), &want) < 1e-5 * norm(&want));
    }

    /// PS-p with many terms is the same series.
    #[test]
    fn plain_series_converges((order, v) in vectors(1), length in 0.0f64..3.0) {
        let f = scaled(&v[0], length / norm(&v[0]).max(1e-9));
        let mut out = f.clone();
        let work = ExpWorkspace::new(order).product_series(60, &f, &mut out);
        prop_assert_eq!(work, Work { products: 58, squares: 1 });
        prop_assert!(distance(&out, &series_of_matrix(order, &f)) < 1e-11 * norm(&out));
    }

    /// For a small vector every variant is within its own truncation of the exact exponential. `x` bounds |f(s)| and the
    /// eigenvalues: PS*-2 scales to ‖f̂‖ < 1/4; products truncate from the third-order term on.
    #[test]
    fn small_vectors_are_exponentiated((order, v) in vectors(1), exponent in -8.0f64..-1.3) {
        let length = 10f64.powf(exponent);
        let f = scaled(&v[0], length / norm(&v[0]).max(1e-9));
        let x = length * order as f64 / crate::common::SQRT_4_PI;
        let mut exact = f.clone();
        exp_exact(order, &f, &mut exact);
        for (name, bound) in [("ps-8", x.powi(3)), ("ps*-2", x.powi(3)), ("ps*-5", x.powi(3)), ("eigen", x.powi(3))] {
            let error = distance(&run::<f64>(name, order, &f), &exact);
            prop_assert!(error < 4.0 * bound + 1e-12, "{} at order {}: {} for x = {}", name, order, error, x);
        }
        // first-order methods, fitted to circles: a relative error of f̂ and a square
        for name in ["ol", "hyb"] {
            let error = distance(&run::<f64>(name, order, &f), &exact);
            prop_assert!(error < 0.2 * length + 4.0 * x * x, "{} at order {}: {} for x = {}", name, order, error, x);
        }
    }

    /// `exp f * exp(-f) = 1` up to the truncation of products, of third order in f.
    #[test]
    fn opposite_vectors_cancel((order, v) in vectors(1), length in 1e-4f64..0.05) {
        let f = scaled(&v[0], length / norm(&v[0]).max(1e-9));
        let x = length * order as f64 / crate::common::SQRT_4_PI;
        for name in ["ps-8", "ps*-2", "ps*-5", "eigen"] {
            let (a, b) = (run::<f64>(name, order, &f), run::<f64>(name, order, &scaled(&f, -1.0)));
            let mut product = a.clone();
            gamma(order).product(&a, &b, &mut product);
            let error = distance(&product, &constant::<f64>(order, 1.0));
            prop_assert!(error < 4.0 * x.powi(3) + 1e-12, "{} at order {}: {} for x = {}", name, order, error, x);
        }
    }

    /// The eigen log inverts the eigen exponential where no eigenvalue is clipped.
    #[test]
    fn log_inverts_exp((order, v) in vectors(1), length in 0.0f64..0.5) {
        let f = scaled(&v[0], length / norm(&v[0]).max(1e-9));
        let g = run::<f64>("eigen", order, &f);
        let mut back = f.clone();
        log_eigen(order, &g, &mut back);
        // M_exp f is exp M_f up to third order in f (Ren 2006, eq. 18)
        let x = length * order as f64 / crate::common::SQRT_4_PI;
        prop_assert!(distance(&back, &f) < 4.0 * x.powi(2) * length + 1e-10);
        let mut naive = f.clone();
        log_naive(order, &g, 1e-3, &mut naive);
        prop_assert!(distance(&naive, &f) < 8.0 * x * x + 1e-9);
    }

    /// Both precisions tell the same story for real blocker sums.
    #[test]
    fn precisions_agree_on_blockers((order, set) in blockers()) {
        let f = sum(order, set.iter().map(|(_, f)| f));
        for name in ["ps*-2", "ps*-5", "ol", "hyb", "eigen"] {
            let (single, double) = (run::<f32>(name, order, &f), run::<f64>(name, order, &f));
            prop_assert!(
                distance(&single, &double) < 2e-3 * norm(&double).max(1.0),
                "{} at order {}: {}", name, order, distance(&single, &double)
            );
        }
    }

    /// Nothing but finite numbers, whatever the finite input, and the guard makes them visibilities.
    #[test]
    fn results_are_finite((order, v) in vectors(1), exponent in -45.0f64..37.0, degree in 1usize..=20, offset in -50.0f64..8.0) {
        let f = convert::<f32>(&scaled(&v[0], 10f64.powf(exponent)));
        let mut exp = ExpWorkspace::<f32>::new(order);
        let mut out = vec![f32::NAN; f.len()];
        for variant in 0..5 {
            let rule = SquaringRule { offset };
            match variant {
                0 => exp.product_series(3 * degree, &f, &mut out),
                1 => exp.scaled_series(degree, rule, &f, &mut out),
                2 => exp.optimal_linear(&f, &mut out),
                3 => exp.hybrid(rule, &f, &mut out),
                _ => exp.eigen(&f, &mut out),
            };
            prop_assert!(out.iter().all(|v| v.is_finite() && v.abs() < 1.1e30), "variant {} of {:?}: {:?}", variant, f, out);
            project_binary_bound(order, &mut out);
            prop_assert!(norm(&out) <= crate::common::SQRT_4_PI * 1.00001);
        }
    }
}

/// Many coincident circles overlap far outside the domain: finite, and admissible after the guard.
#[test]
fn heavy_overlap_stays_finite() {
    for order in 1..=8 {
        for degrees in [5.0, 15.0, 60.0, 90.0] {
            let f = scaled(&circle(order, degrees, UP).1, 200.0);
            for name in VARIANTS {
                let mut single = run::<f32>(name, order, &f);
                let mut double = run::<f64>(name, order, &f);
                assert!(single.iter().all(|v| v.is_finite()), "{name}, order {order}, {degrees}°");
                assert!(double.iter().all(|v| v.is_finite()), "{name}, order {order}, {degrees}°");
                project_binary_bound(order, &mut single);
                project_binary_bound(order, &mut double);
                assert!(norm(&single) < 3.545 && norm(&double) < 3.545);
            }
        }
    }
}

/// Six coincident circles of 45°, order 4: PS-p needs p well above |λmin|.
#[test]
fn plain_series_needs_more_terms_than_its_lowest_eigenvalue() {
    let log = circle(4, 45.0, UP).1;
    let mut matrix = vec![0.0; 256];
    gamma(4).product_matrix(&log, &mut matrix);
    let mut eigen = SymmetricEigen::new();
    eigen.decompose(16, &matrix);
    let lowest = eigen.values().iter().copied().fold(0.0, f64::min);
    let f = scaled(&log, -16.5 / lowest);
    let want = run::<f64>("eigen", 4, &f);
    let error = |degree, single: bool| {
        let mut out = vec![0.0; 16];
        if single {
            let mut rounded = vec![0.0f32; 16];
            ExpWorkspace::new(4).product_series(degree, &convert(&f), &mut rounded);
            out = rounded.iter().map(|&v| f64::from(v)).collect();
        } else {
            ExpWorkspace::new(4).product_series(degree, &f, &mut out);
        }
        distance(&out, &want) / norm(&want)
    };
    assert!((1850.0..2050.0).contains(&error(30, true)), "PS-30: {}", error(30, true));
    assert!((0.02..0.2).contains(&error(60, true)), "PS-60 in f32: {}", error(60, true));
    assert!(error(60, false) < 1e-9, "PS-60 in f64: {}", error(60, false));
}

/// PS*-p and HYB take the operations that the paper counts.
#[test]
fn operations_are_counted_as_in_the_paper() {
    let f = circle(4, 45.0, UP).1; // ‖f̂‖ = 3.05: ⌊1.61 + 3⌋ = 4 squarings
    let mut out = vec![0.0; 16];
    let mut exp = ExpWorkspace::new(4);
    let rule = SquaringRule::default();
    assert_eq!(exp.hybrid(rule, &f, &mut out), Work { products: 0, squares: 4 });
    assert_eq!(exp.optimal_linear(&f, &mut out), Work::default());
    assert_eq!(exp.product_series(21, &f, &mut out), Work { products: 19, squares: 1 });
    for degree in 1..=20 {
        let work = exp.scaled_series(degree, rule, &f, &mut out);
        let series = degree / 2 + usize::from(degree >= 3);
        assert_eq!(work.products + work.squares, 4 + series as u32, "PS*-{degree}");
    }
    assert_eq!(exp.scaled_series(2, rule, &f, &mut out), Work { products: 0, squares: 5 });
    assert_eq!(exp.scaled_series(2, SquaringRule { offset: -3.0 }, &f, &mut out), Work { products: 0, squares: 1 });
    assert_eq!(exp.hybrid(rule, &constant(4, -3.0), &mut out), Work::default());
}

/// OL is the least-squares fit to its circles: what is left is orthogonal to 1 and to f̂ (Ren 2006, eq. 24).
#[test]
fn optimal_linear_is_optimal_for_circles() {
    for (order, top) in [(2, 90.0), (3, 75.0), (4, 90.0), (5, 80.0), (6, 72.0), (7, 60.0), (8, 50.0)] {
        for step in 1..=40 {
            let (g, mut f) = circle(order, top * f64::from(step) / 40.0, UP);
            let fitted = run::<f64>("ol", order, &f);
            let left: Vec<f64> = g.iter().zip(&fitted).map(|(x, y)| x - y).collect();
            f[0] = 0.0;
            assert!(left[0].abs() < 1e-5, "order {order}, step {step}: {}", left[0]);
            assert!(
                (dot(&left, &f) / norm(&f)).abs() < 1e-5,
                "order {order}, step {step}: {}",
                dot(&left, &f) / norm(&f)
            );
        }
    }
}

/// Within the unclipped domain the squared form keeps close to the circle, at every order.
#[test]
fn hybrid_reproduces_single_circles() {
    for order in 2..=8 {
        for degrees in [1.0, 5.0, 10.0, 15.0, 20.0] {
            let (g, f) = circle(order, degrees, UP);
            let error = distance(&run::<f64>("hyb", order, &f), &g) / norm(&g);
            assert!(error < 0.002, "order {order}, {degrees}°: {error}");
        }
    }
    // scaling is what keeps it accurate: OL alone at order 4
    let (g, f) = circle(4, 45.0, UP);
    let error = |name| distance(&run::<f64>(name, 4, &f), &g) / norm(&g);
    assert!(error("hyb") < 0.002 && error("ol") > 0.02);
}

/// Past the largest circle, OL stays where it is instead of extrapolating.
#[test]
fn optimal_linear_saturates() {
    for order in 2..=8 {
        let mut direction = vec![0.0; order * order];
        direction[2] = 1.0;
        let [a, b] = [20.0, 1e6].map(|length| run::<f64>("ol", order, &scaled(&direction, length)));
        assert!(distance(&a, &b) < 1e-9 * norm(&a), "order {order}");
    }
}

/// However few squarings the rule asks for, HYB squares until OL's table is used below the clip's onset only.
#[test]
fn hybrid_squares_into_the_domain_of_the_linear_table() {
    let squares = |order, degrees| {
        let f = circle(order, degrees, UP).1;
        let mut out = f.clone();
        ExpWorkspace::new(order).hybrid(SquaringRule { offset: -50.0 }, &f, &mut out).squares
    };
    for (order, below, above) in [(3, 64.0, 65.5), (4, 48.0, 49.5), (5, 39.0, 40.0), (6, 32.0, 33.5)] {
        assert_eq!((squares(order, below), squares(order, above)), (0, 1), "order {order}");
    }
}

/// A better squaring rule costs squares and buys accuracy: HYB approaches the eigen exponential.
#[test]
fn more_squarings_are_more_accurate() {
    let f = sum(4, [&circle(4, 30.0, UP).1, &circle(4, 40.0, [0.6, 0.0, 0.8]).1]);
    let want = run::<f64>("eigen", 4, &f);
    let mut last = f64::MAX;
    for offset in [1.0, 2.0, 3.0, 4.0, 5.0, 6.0] {
        let mut out = f.clone();
        ExpWorkspace::new(4).scaled_series(2, SquaringRule { offset }, &f, &mut out);
        let error = distance(&out, &want) / norm(&want);
        assert!(error < last, "offset {offset}: {error} after {last}");
        last = error;
    }
}

/// The default is the rule of orders 3 and 4; higher orders square oftener.
#[test]
fn rules_of_orders() {
    let offsets: Vec<f64> = (1..=8).map(|order| SquaringRule::for_order(order).offset).collect();
    assert_eq!(offsets, [2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 5.0, 5.0]);
    assert_eq!(SquaringRule::for_order(4), SquaringRule::default());
}
