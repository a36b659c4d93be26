use super::*;
use crate::statistics::random::normals;

const RECEIVERS: usize = 400;

/// A picture with slopes and an edge.
fn truth(receiver: usize) -> f64 {
    let t = receiver as f64 / RECEIVERS as f64;
    0.6 + 0.3 * (40.0 * t).sin() - if t > 0.5 { 0.2 } else { 0.0 }
}

/// Means of normal batches about the truth, errors from 0.5% to 3% of it; channels share their samples in part or wholly.
fn drawn(seed: u64, batches: u32, shared: f64) -> Estimate {
    let mut noise = normals(seed);
    let mut normal = || noise.next().expect("endless");
    let mut estimate = Estimate { mean: vec![], variance: vec![], samples: vec![64; RECEIVERS], batches };
    let count = f64::from(batches);
    for receiver in 0..RECEIVERS {
        let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
        for _ in 0..batches {
            let common = normal();
            for channel in 0..3 {
                let noise = shared.sqrt() * common + (1.0 - shared).sqrt() * normal();
                sum[channel] += noise;
                squares[channel] += noise * noise;
            }
        }
        let spread = truth(receiver) * (0.005 + 0.025 * (receiver % 7) as f64 / 6.0) * count.sqrt();
        let mean = sum.map(|sum| (truth(receiver) + spread * sum / count) as f32);
        let variance = [0, 1, 2]
            .map(|i| (spread * spread * (squares[i] - sum[i] * sum[i] / count) / (count * (count - 1.0))) as f32);
        estimate.mean.push(Rgb::from_array(mean));
        estimate.variance.push(Rgb::from_array(variance));
    }
    estimate
}

fn exact() -> Vec<Rgb> {
    (0..RECEIVERS).map(|receiver| Rgb::splat(truth(receiver) as f32)).collect()
}

#[test]
fn honest_estimates_are_rejected_at_the_stated_rate() {
    for (name, shared, least) in [("channels apart", 0.0, 8), ("one channel thrice", 1.0, 0)] {
        let mut rejected = [0; 4];
        for seed in 0..200 {
            let (a, b) = (drawn(2 * seed, 16, shared), drawn(2 * seed + 1, 8, shared));
            let (two, one) = (compare(&a, &b), compare_exact(&b, &exact()));
            for (count, p) in rejected.iter_mut().zip([two.family_p, two.bias_p, two.p(), one.p()]) {
                *count += usize::from(p <= 0.1);
            }
        }
        // 20 are expected of an exact test; more than 36 have probability 2e-4.
        assert!(rejected.iter().all(|count| (least..=36).contains(count)), "{name}: {rejected:?} of 200");
    }
}

#[test]
fn what_is_wrong_is_rejected_and_by_the_test_that_should() {
    let (a, b) = (drawn(1, 16, 0.5), drawn(2, 16, 0.5));
    assert!(compare(&a, &b).passes(0.01) && compare_exact(&a, &exact()).passes(0.01));
    let both = |wrong: &Estimate| [compare(wrong, &b), compare(&b, wrong), compare_exact(wrong, &exact())];

    for factor in [0.99f32, 1.01] {
        let scaled = Estimate { mean: a.mean.iter().map(|mean| *mean * factor).collect(), ..a.clone() };
        for comparison in both(&scaled) {
            assert!(comparison.bias_p < 1e-4 && !comparison.passes(1e-3), "{factor}: {comparison:?}");
        }
    }
    // One in green alone.
    let tinted = Estimate { mean: a.mean.iter().map(|m| *m * Rgb::new(1.0, 1.01, 1.0)).collect(), ..a.clone() };
    assert!(both(&tinted).iter().all(|comparison| comparison.bias_p < 1e-3));

    // Keeps the sum.
    let mut swapped = a.clone();
    swapped.mean.swap(20, 100);
    swapped.variance.swap(20, 100);
    let mut shifted = a.clone();
    shifted.mean.rotate_right(1);
    shifted.variance.rotate_right(1);
    for wrong in [swapped, shifted] {
        for comparison in both(&wrong) {
            let Comparison { family_p, bias_p, .. } = comparison;
            assert!(family_p < 1e-4 && bias_p > 0.01 && !comparison.passes(1e-3), "{family_p} {bias_p}");
        }
    }
}

#[test]
fn one_receiver_follows_welch() {
    let one = |mean: f32, variance: f32, batches: u32| Estimate {
        mean: vec![Rgb::new(mean, 0.0, 0.0)],
        variance: vec![Rgb::splat(variance)],
        samples: vec![64],
        batches,
    };
    // SciPy: ttest_ind_from_stats(3, 4, 16, 1, 1, 64, equal_var=False), for errors of 4/√16 and 1/√64.
    let (a, b) = (one(3.0, 1.0, 16), one(1.0, 0.015_625, 64));
    let comparison = compare(&a, &b);
    let p = 0.06522157220355562;
    assert!((comparison.receiver_p[0].expect("tested") / (3.0 * p) - 1.0).abs() < 1e-9, "{comparison:?}");
    assert_eq!(comparison.family_p, comparison.receiver_p[0].expect("tested"));
    assert_eq!(comparison.bias_p, comparison.family_p, "of one receiver both tests are the same");
    assert!((comparison.largest - normal_quantile_above(0.5 * p)).abs() < 1e-9);
    assert_eq!((comparison.bias, comparison.bias_error[0]), ([2.0, 0.0, 0.0], 1.015_625f64.sqrt()));
}

#[test]
fn nan_false_certainty_and_nothing_at_all_fail() {
    let good = drawn(1, 16, 0.5);
    let with = |change: &dyn Fn(&mut Estimate)| {
        let mut wrong = good.clone();
        change(&mut wrong);
        wrong
    };
    let other = drawn(2, 16, 0.5);
    for (name, wrong) in [
        ("NaN", with(&|e| e.mean[3].y = f32::NAN)),
        ("infinite", with(&|e| e.mean[3].y = f32::INFINITY)),
        ("NaN variance", with(&|e| e.variance[3].y = f32::NAN)),
        ("negative variance", with(&|e| e.variance[3].y = -1.0)),
        ("NaN variance where equal", with(&|e| (e.mean[3], e.variance[3].y) = (other.mean[3], f32::NAN))),
    ] {
        for comparison in [compare(&wrong, &other), compare(&other, &wrong), compare_exact(&wrong, &exact())] {
            assert!(!comparison.passes(0.0) && comparison.largest == f64::INFINITY, "{name}: {comparison:?}");
            assert!(comparison.receiver_p.iter().flatten().all(|p| p.is_finite()), "{name}");
        }
    }
    let certain = with(&|e| e.variance[3] = Rgb::ZERO);
    assert!(!compare_exact(&certain, &exact()).passes(0.0));
    let blank = with(&|e| (e.mean.fill(Rgb::ZERO), e.variance.fill(Rgb::ZERO)).0);
    assert!(!compare(&blank, &other).passes(1e-12) && !compare_exact(&blank, &exact()).passes(0.0));
    // Far off in every channel by chance is not impossible, only improbable.
    let far = with(&|e| e.mean[3] = Rgb::splat(1e20));
    assert!(compare(&far, &other).largest.is_finite() && !compare(&far, &other).passes(1e-12));

    let unsampled = with(&|e| e.samples.fill(0));
    for nothing in [compare(&unsampled, &other), compare_exact(&unsampled, &exact())] {
        assert!(!nothing.passes(0.0) && nothing.receivers == 0 && nothing.receiver_p.iter().all(Option::is_none));
    }
    let mut partly = good.clone();
    partly.samples[7] = 0;
    partly.mean[7] = Rgb::splat(f32::NAN);
    let comparison = compare(&partly, &other);
    assert!(comparison.passes(0.01) && comparison.receivers == RECEIVERS - 1 && comparison.receiver_p[7].is_none());
}
