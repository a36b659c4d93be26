//! Every measure against figures computed elsewhere: numpy 2, scikit-image 0.26 and flip-evaluator (the FLIP authors' own, at 67 pixels a degree).

use glam::Vec3;
use halflight_metrics::{Layout, Picture, compare};

const WIDTH: usize = 24;
const HEIGHT: usize = 17;
const LAYOUT: Layout = Layout::Image { width: WIDTH, height: HEIGHT };

/// The pair of pictures that the other programs were given, and a disc of valid pixels.
fn pair() -> (Vec<Vec3>, Vec<Vec3>, Vec<bool>) {
    let (mut tested, mut reference, mut disc) = (vec![], vec![], vec![]);
    for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
        let r = [0, 1, 2].map(|c| ((x * 7 + y * 13 + c * 29) % 64) as f64 / 64.0 + x as f64 / 24.0);
        let r = r.map(|v| v as f32);
        reference.push(Vec3::from(r));
        let t = [0, 1, 2].map(|c| 0.9 * f64::from(r[c]) + 0.05 * ((x * 5 + y * 3 + c) % 7) as f64);
        tested.push(Vec3::from(t.map(|v| v as f32)));
        disc.push((x as i32 - 12).pow(2) + (y as i32 - 8).pow(2) < 90);
    }
    (tested, reference, disc)
}

fn near(name: &str, actual: f64, expected: f64, tolerance: f64) {
    assert!((actual - expected).abs() <= tolerance, "{name}: {actual}, expected {expected}");
}

#[test]
fn whole_image() {
    let (x, r, _) = pair();
    let valid = vec![true; x.len()];
    let x = Picture { radiance: &x, valid: &valid, layout: LAYOUT };
    let r = Picture { radiance: &r, valid: &valid, layout: LAYOUT };
    let s = compare(&x, &r, &vec![Vec3::ZERO; valid.len()]).unwrap();
    near("rmse", s.rmse, 0.119_797_005_352_912_75, 1e-7);
    near("rel_mse", s.rel_mse, 0.061_930_804_593_947_79, 1e-7);
    near("mae", s.mae, 0.098_818_762_392_243_92, 1e-7);
    near("bias", s.bias, 0.053_007_558_359_478_42, 1e-7);
    near("max", s.max, 0.287_499_994_039_535_5, 1e-7);
    near("p99", s.p99, 0.267_109_368_443_489_04, 1e-7);
    near("level", s.level, 1.052_469_641_465_773, 1e-7);
    near("ssim", s.ssim.unwrap(), 0.906_916_636_337_765_5, 1e-6);
    near("flip", s.flip.unwrap(), 0.131_839_886_307_716_37, 1e-6);
    assert_eq!(s.receivers, WIDTH * HEIGHT);
}

#[test]
fn only_receivers_valid_in_both_count() {
    let (mut x, mut r, disc) = pair();
    // What does not count may be anything.
    for (i, counts) in disc.iter().enumerate().filter(|(_, counts)| !**counts) {
        assert!(!counts);
        (x[i], r[i]) = (Vec3::NAN, Vec3::splat(1e30));
    }
    // Each picture masks a part of what the other allows.
    let left: Vec<bool> = disc.iter().enumerate().map(|(i, d)| *d || i % WIDTH < 12).collect();
    let right: Vec<bool> = disc.iter().enumerate().map(|(i, d)| *d || i % WIDTH >= 12).collect();
    let x = Picture { radiance: &x, valid: &left, layout: LAYOUT };
    let r = Picture { radiance: &r, valid: &right, layout: LAYOUT };
    let s = compare(&x, &r, &vec![Vec3::ZERO; disc.len()]).unwrap();
    near("rmse", s.rmse, 0.118_506_374_861_584_29, 1e-7);
    near("rel_mse", s.rel_mse, 0.036_020_259_074_105_52, 1e-7);
    near("mae", s.mae, 0.098_469_065_301_346_05, 1e-7);
    near("bias", s.bias, 0.051_482_956_210_772_195, 1e-7);
    near("p99", s.p99, 0.258_999_981_880_187_97, 1e-7);
    near("level", s.level, 1.055_559_392_812_659_2, 1e-7);
    near("ssim", s.ssim.unwrap(), 0.905_219_854_449_598_5, 1e-6);
    near("flip", s.flip.unwrap(), 0.129_692_33, 1e-6);
    assert_eq!(s.receivers, 275);
}

#[test]
fn lists_and_small_images_have_no_perceptual_measures() {
    let (x, r, _) = pair();
    let (x, r, valid, zero) = (&x[..40], &r[..40], [true; 40], [Vec3::ZERO; 40]);
    let with = |layout| {
        let x = Picture { radiance: x, valid: &valid, layout };
        compare(&x, &Picture { radiance: r, ..x }, &zero).unwrap()
    };
    let list = with(Layout::List);
    assert_eq!((list.ssim, list.flip), (None, None));
    assert!(list.measures().all(|(name, value)| name != "ssim" && name != "flip" && value.is_finite()));
    let small = with(Layout::Image { width: 10, height: 4 });
    assert!(small.ssim.is_none() && small.flip.is_some());
    assert_eq!(small.rmse, list.rmse);
}

#[test]
fn equal_pictures_have_no_error() {
    let (_, r, disc) = pair();
    let copy = r.clone();
    let x = Picture { radiance: &copy, valid: &disc, layout: LAYOUT };
    let s = compare(&x, &Picture { radiance: &r, ..x }, &vec![Vec3::ZERO; r.len()]).unwrap();
    assert_eq!((s.rmse, s.rel_mse, s.mae, s.bias, s.max, s.p99), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
    near("ssim", s.ssim.unwrap(), 1.0, 1e-12);
    near("flip", s.flip.unwrap(), 0.0, 1e-6);
    assert!(!s.resolved);
}
