//! The comparator must refuse what is wrong: the negative controls.

use glam::Vec3;
use halflight_metrics::{CompareError, Disagreement, Layout, Picture, Scores, Tolerance, agrees, compare};
use proptest::prelude::*;

const WIDTH: usize = 32;
const HEIGHT: usize = 24;
const COUNT: usize = WIDTH * HEIGHT;
const LAYOUT: Layout = Layout::Image { width: WIDTH, height: HEIGHT };
/// The reference's standard error at every receiver and channel.
const NOISE: f32 = 1e-3;
const TOLERANCE: Tolerance = Tolerance { rmse: 2e-3, bias: 1e-3, max: 2e-2 };

/// A smooth, coloured, softly shadowed plane.
fn plane() -> Vec<Vec3> {
    let at = |i: usize| {
        let (x, y) = ((i % WIDTH) as f32 / WIDTH as f32 - 0.4, (i / WIDTH) as f32 / HEIGHT as f32 - 0.5);
        let shadow = 1.0 - 0.8 * (-(x * x + y * y) * 12.0).exp();
        Vec3::new(0.6, 0.5, 0.35) * shadow + Vec3::new(0.0, 0.02, 0.1) * (x + 0.5)
    };
    (0..COUNT).map(at).collect()
}

fn score(x: &[Vec3]) -> Result<Scores, CompareError> {
    let (reference, valid) = (plane(), vec![true; COUNT]);
    let reference = Picture { radiance: &reference, valid: &valid, layout: LAYOUT };
    compare(&Picture { radiance: x, ..reference }, &reference, &vec![Vec3::splat(NOISE); COUNT])
}

fn verdict(x: &[Vec3]) -> Result<(), Disagreement> {
    agrees(&score(x).unwrap(), &TOLERANCE)
}

fn map(change: impl Fn(usize, Vec3) -> Vec3) -> Vec<Vec3> {
    plane().into_iter().enumerate().map(|(i, v)| change(i, v)).collect()
}

#[test]
fn an_equal_and_a_slightly_noisy_picture_pass() {
    assert_eq!(verdict(&plane()), Ok(()));
    assert_eq!(verdict(&map(|i, v| v + if i % 2 == 0 { 1e-3 } else { -1e-3 })), Ok(()));
}

#[test]
fn a_shifted_picture_fails() {
    let original = plane();
    assert!(verdict(&map(|i, _| original[i - usize::from(i % WIDTH > 0)])).is_err(), "one pixel to the right");
    assert!(verdict(&map(|i, _| original[if i < WIDTH { i } else { i - WIDTH }])).is_err(), "one pixel down");
    assert!(verdict(&map(|i, _| original[(i + 1) % COUNT])).is_err(), "rolled by one receiver");
}

#[test]
fn a_scaled_picture_fails() {
    for scale in [0.99, 1.01, 2.0, std::f32::consts::PI, -1.0] {
        assert!(verdict(&map(|_, v| v * scale)).is_err(), "{scale}");
    }
}

#[test]
fn a_brightened_picture_fails() {
    assert!(verdict(&map(|_, v| v + 0.005)).is_err());
}

#[test]
fn each_limit_binds_by_itself_and_in_both_directions() {
    let loose = Tolerance { rmse: 1.0, bias: 1.0, max: 1.0 };
    for shift in [-0.005, 0.005] {
        let scores = score(&map(|_, v| v + shift)).unwrap();
        assert_eq!(agrees(&scores, &loose), Ok(()));
        for (name, tolerance) in [
            ("RMSE", Tolerance { rmse: 1e-3, ..loose }),
            ("bias", Tolerance { bias: 1e-3, ..loose }),
            ("largest error", Tolerance { max: 1e-3, ..loose }),
        ] {
            let over = agrees(&scores, &tolerance);
            assert!(matches!(over, Err(Disagreement::Over { measure, .. }) if measure == name), "{over:?}");
        }
    }
}

#[test]
fn a_channel_swapped_picture_fails() {
    for swapped in [map(|_, v| Vec3::new(v.z, v.y, v.x)), map(|_, v| Vec3::new(v.y, v.x, v.z))] {
        assert!(verdict(&swapped).is_err());
    }
}

#[test]
fn a_mirrored_picture_fails() {
    let original = plane();
    assert!(verdict(&map(|i, _| original[i / WIDTH * WIDTH + WIDTH - 1 - i % WIDTH])).is_err());
}

#[test]
fn one_wrong_receiver_fails() {
    assert!(verdict(&map(|i, v| if i == 77 { v + 0.05 } else { v })).is_err());
}

#[test]
fn nan_and_infinity_fail() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let x = map(|i, v| if i == 5 { Vec3::new(v.x, v.y, bad) } else { v });
        assert_eq!(score(&x), Err(CompareError::NotFinite { what: "the picture's radiance", receiver: 5 }));
    }
    assert!(score(&vec![Vec3::NAN; COUNT]).is_err());
}

#[test]
fn a_blank_picture_scores_badly_and_fails() {
    for blank in [0.0, 0.4, 1.0] {
        let scores = score(&vec![Vec3::splat(blank); COUNT]).unwrap();
        assert!(agrees(&scores, &TOLERANCE).is_err());
        assert!(scores.resolved && scores.rmse > 0.1 * scores.level, "{scores:?}");
    }
}

#[test]
fn a_black_reference_judges_nothing() {
    let (black, copy, valid) = (vec![Vec3::ZERO; COUNT], vec![Vec3::ZERO; COUNT], vec![true; COUNT]);
    let reference = Picture { radiance: &black, valid: &valid, layout: LAYOUT };
    let scores = compare(&Picture { radiance: &copy, ..reference }, &reference, &black).unwrap();
    assert_eq!(agrees(&scores, &TOLERANCE), Err(Disagreement::BlackReference));
}

#[test]
fn a_picture_is_not_its_own_reference() {
    let (r, valid) = (plane(), vec![true; COUNT]);
    let reference = Picture { radiance: &r, valid: &valid, layout: LAYOUT };
    let result = compare(&reference, &reference, &vec![Vec3::ZERO; COUNT]);
    assert_eq!(result, Err(CompareError::SamePicture));
}

#[test]
fn a_bad_reference_is_an_error() {
    let (x, valid, noise) = (plane(), vec![true; COUNT], vec![Vec3::splat(NOISE); COUNT]);
    let nan = map(|i, v| if i == 9 { Vec3::NAN } else { v });
    let x = Picture { radiance: &x, valid: &valid, layout: LAYOUT };
    let good = plane();
    let with = |radiance, noise: &[Vec3]| compare(&x, &Picture { radiance, ..x }, noise);
    assert_eq!(with(&nan, &noise), Err(CompareError::NotFinite { what: "the reference's radiance", receiver: 9 }));
    for bad in [f32::NAN, -1e-3] {
        let mut noise = noise.clone();
        noise[3].y = bad;
        let expected = CompareError::NotFinite { what: "the reference's standard error", receiver: 3 };
        assert_eq!(with(&good, &noise), Err(expected));
    }
}

#[test]
fn sizes_layouts_and_masks_must_fit() {
    let (x, r, valid, zero) = (plane(), plane(), vec![true; COUNT], vec![Vec3::ZERO; COUNT]);
    let x = Picture { radiance: &x, valid: &valid, layout: LAYOUT };
    let r = Picture { radiance: &r, ..x };
    let transposed = Layout::Image { width: HEIGHT, height: WIDTH };
    for reference in [Picture { layout: transposed, ..r }, Picture { layout: Layout::List, ..r }] {
        assert!(matches!(compare(&x, &reference, &zero), Err(CompareError::Layout { .. })));
    }
    for reference in [Picture { radiance: &r.radiance[1..], ..r }, Picture { valid: &valid[1..], ..r }] {
        assert!(matches!(compare(&x, &reference, &zero), Err(CompareError::Length { .. })));
    }
    assert!(matches!(compare(&x, &r, &[]), Err(CompareError::Length { .. })));
    let none = vec![false; COUNT];
    assert_eq!(compare(&Picture { valid: &none, ..x }, &r, &zero), Err(CompareError::NothingToCompare));
    let empty = Picture { radiance: &[], valid: &[], layout: Layout::List };
    assert_eq!(compare(&empty, &empty, &[]), Err(CompareError::NothingToCompare));
}

#[test]
fn a_difference_below_the_references_standard_error_is_not_resolved() {
    let off = |d: f32| score(&map(|i, v| v + if i % 2 == 0 { d } else { -d })).unwrap();
    assert!(!off(1.4 * NOISE).resolved);
    assert!(off(1.5 * NOISE).resolved);
    assert!((off(0.0).reference_standard_error - f64::from(NOISE)).abs() < 1e-9);
}

#[test]
fn scores_and_limits_that_are_no_numbers_do_not_pass() {
    let good = score(&plane()).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        for scores in [
            Scores { rmse: bad, ..good },
            Scores { bias: bad, ..good },
            Scores { max: bad, ..good },
            Scores { level: bad, ..good },
            Scores { reference_standard_error: bad, ..good },
        ] {
            assert!(matches!(agrees(&scores, &TOLERANCE), Err(Disagreement::NotComparable(_))));
        }
        for tolerance in [
            Tolerance { rmse: bad, ..TOLERANCE },
            Tolerance { bias: bad, ..TOLERANCE },
            Tolerance { max: bad, ..TOLERANCE },
            Tolerance { rmse: -1.0, ..TOLERANCE },
        ] {
            assert!(matches!(agrees(&good, &tolerance), Err(Disagreement::NotComparable(_))));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Relations that hold between the measures of any two lists.
    #[test]
    fn measures_are_ordered(values in prop::collection::vec((-10f32..10.0, -10f32..10.0), 1..40)) {
        let x: Vec<Vec3> = values.iter().map(|(a, b)| Vec3::new(*a, *b, a - b)).collect();
        let r: Vec<Vec3> = values.iter().map(|(a, b)| Vec3::new(*b, a * b, 1.0)).collect();
        let valid = vec![true; x.len()];
        let x = Picture { radiance: &x, valid: &valid, layout: Layout::List };
        let s = compare(&x, &Picture { radiance: &r, ..x }, &vec![Vec3::ZERO; valid.len()]).unwrap();
        prop_assert!(s.bias.abs() <= s.mae * (1.0 + 1e-12));
        prop_assert!(s.mae <= s.rmse * (1.0 + 1e-12));
        prop_assert!(s.rmse <= s.max * (1.0 + 1e-12));
        prop_assert!(s.p99 <= s.max);
        prop_assert!(s.rel_mse <= 100.0 * s.rmse * s.rmse * (1.0 + 1e-12));
    }
}
