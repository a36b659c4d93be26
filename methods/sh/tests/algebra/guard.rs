//! The overlap guard.

use halflight_sh::{Real, evaluate, project_binary_bound};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use crate::common::{SQRT_4_PI, blockers, constant, convert, dot, norm, unit_vector, vectors};

/// After the guard a vector is admissible, and stays as it is if guarded again.
fn becomes_admissible<T: Real>(order: usize, v: &[f64], s: [f64; 3]) -> Result<(), TestCaseError> {
    let mut g = convert::<T>(v);
    let before = g.clone();
    if !project_binary_bound(order, &mut g) {
        prop_assert_eq!(&g, &before);
    }
    let slack = 100.0 * T::EPSILON.to_f64();
    let mean = g[0].to_f64();
    prop_assert!(mean >= -slack && mean <= SQRT_4_PI + slack);
    prop_assert!(norm(&g).powi(2) <= SQRT_4_PI * mean + 10.0 * slack);
    let mut basis = constant(order, 0.0);
    evaluate(order, s, &mut basis);
    let value = dot(&basis, &g.iter().map(|v| v.to_f64()).collect::<Vec<_>>());
    prop_assert!(value.abs() <= order as f64 * (1.0 + 10.0 * slack), "|g(s)| = {} at order {}", value, order);
    let once = g.clone();
    prop_assert!(!project_binary_bound(order, &mut g));
    prop_assert_eq!(g, once);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn any_vector_becomes_admissible((order, v) in vectors(1), e in -6.0f64..37.0, s in unit_vector()) {
        let large: Vec<f64> = v[0].iter().map(|x| x * 10f64.powf(e)).collect();
        becomes_admissible::<f32>(order, &large, s)?;
        becomes_admissible::<f64>(order, &large, s)?;
        let huge: Vec<f64> = v[0].iter().map(|x| x * 10f64.powf(8.0 * e)).collect();
        becomes_admissible::<f64>(order, &huge, s)?;
    }

    #[test]
    fn what_is_not_finite_is_repaired((order, v) in vectors(1), place in 0usize..64, kind in 0usize..3, s in unit_vector()) {
        let mut broken = v[0].clone();
        let place = place % broken.len();
        broken[place] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][kind];
        becomes_admissible::<f32>(order, &broken, s)?;
        becomes_admissible::<f64>(order, &broken, s)?;
        prop_assert!(project_binary_bound(order, &mut broken));
    }

    /// The first of two blockers, that is a true projection, passes; so do the open and the closed sky.
    #[test]
    fn projections_of_visibility_pass((order, set) in blockers()) {
        for v in [set[0].0.clone(), constant(order, 1.0), constant(order, 0.0)] {
            let (mut single, mut double) = (convert::<f32>(&v), v.clone());
            prop_assert!(!project_binary_bound(order, &mut single) && !project_binary_bound(order, &mut double));
        }
    }
}

#[test]
fn bands_are_shrunk_by_one_factor_and_no_more_than_needed() {
    let mut g = [0.5 * SQRT_4_PI, 3.0, 0.0, 4.0];
    assert!(project_binary_bound(2, &mut g));
    let limit = 0.5 * SQRT_4_PI; // √(g0(√4π - g0))
    assert!((g[1] - 0.6 * limit).abs() < 1e-14 && g[2] == 0.0 && (g[3] - 0.8 * limit).abs() < 1e-14);
    assert_eq!(g[0], 0.5 * SQRT_4_PI);

    let mut dark = [-2.0f32, 1.0, 1.0, 1.0];
    assert!(project_binary_bound(2, &mut dark));
    assert_eq!(dark, [0.0; 4]);
    let mut bright = [f32::INFINITY, 0.5, f32::NAN, 0.5];
    assert!(project_binary_bound(2, &mut bright));
    assert_eq!(bright, [SQRT_4_PI as f32, 0.0, 0.0, 0.0]);
}
