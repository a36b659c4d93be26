//! Holding an estimate against known values.

use halflight_scenes::Rgb;

use super::{normal_quantile_above, normal_survival, student_survival};
use crate::Estimate;

/// What a z-test finds over receivers and colour channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZSummary {
    /// Mean z, over receivers and channels.
    pub mean: f64,
    /// Largest |z| of any receiver and channel; infinite where an estimate differs and claims no error.
    pub largest: f64,
    /// Receivers tested.
    pub count: usize,
}

impl ZSummary {
    /// Three standard deviations of the mean of `count` independent z. Channels of a receiver share their samples, so they
    /// are not counted apart; where they are less than wholly correlated the limit is generous by at most √3.
    pub fn mean_limit(&self) -> f64 {
        3.0 / (self.count as f64).sqrt()
    }

    /// What the largest |z| of this many receivers and channels stays below with probability `1 − level` at least.
    pub fn bonferroni_limit(&self, level: f64) -> f64 {
        normal_quantile_above(level / (2.0 * 3.0 * self.count.max(1) as f64))
    }

    /// Whether the mean is within [`Self::mean_limit`] and the largest within [`Self::bonferroni_limit`].
    pub fn passes(&self, level: f64) -> bool {
        self.count > 0 && self.mean.abs() <= self.mean_limit() && self.largest < self.bonferroni_limit(level)
    }
}

/// z-scores of an estimate against expected radiance over the receivers with `valid`. The error's spread is itself estimated
/// from few batches, so each score is a Student t and is turned into the normal z of equal probability.
///
/// # Panics
/// If the lengths differ.
pub fn z_test(estimate: &Estimate, expected: &[Rgb], valid: &[bool]) -> ZSummary {
    assert_eq!((estimate.mean.len(), valid.len()), (expected.len(), expected.len()), "one value a receiver");
    let degrees = f64::from(estimate.batches.max(2) - 1);
    let (mut sum, mut largest, mut count) = (0.0, 0.0f64, 0);
    for (i, expected) in expected.iter().enumerate().filter(|(i, _)| valid[*i]) {
        for channel in 0..3 {
            let difference = f64::from(estimate.mean[i][channel]) - f64::from(expected[channel]);
            let z = equivalent_z(difference, f64::from(estimate.variance[i][channel]).sqrt(), degrees);
            sum += z;
            // `max` would drop a NaN, which must fail.
            largest = if z.is_nan() { f64::INFINITY } else { largest.max(z.abs()) };
        }
        count += 1;
    }
    ZSummary { mean: sum / (3 * count.max(1)) as f64, largest, count }
}

/// The standard normal z as improbable as a difference over its standard error, when the latter is estimated with so many
/// degrees of freedom.
pub fn equivalent_z(difference: f64, standard_error: f64, degrees: f64) -> f64 {
    if difference == 0.0 {
        return 0.0;
    }
    if standard_error == 0.0 {
        return difference.signum() * f64::INFINITY;
    }
    let t = difference / standard_error;
    // Beyond the range of `normal_survival` the tail underflows.
    let z = normal_quantile_above(student_survival(t.abs(), degrees).max(normal_survival(37.0)));
    z.copysign(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equivalent_z_agrees_with_scipy() {
        for (degrees, t, expected) in [
            (7.0, 3.0, 2.3274349741046803),
            (7.0, -12.0, -4.514110356694569),
            (15.0, 2.5, 2.249105208714594),
            (31.0, 6.0, 4.851211477349142),
            (1000.0, 4.0, 3.983142599167518),
        ] {
            assert!((equivalent_z(t * 0.1, 0.1, degrees) - expected).abs() < 1e-9, "t {t} with {degrees}");
        }
        assert_eq!(equivalent_z(0.0, 0.0, 7.0), 0.0);
        assert_eq!(equivalent_z(-1.0, 0.0, 7.0), f64::NEG_INFINITY);
        assert!((equivalent_z(1e9, 1.0, 1000.0) - 37.0).abs() < 1e-6);
    }

    #[test]
    fn nan_and_unfounded_certainty_fail() {
        let one = |mean: f32, variance: f32| Estimate {
            mean: vec![Rgb::splat(mean)],
            variance: vec![Rgb::splat(variance)],
            samples: vec![16],
            batches: 16,
        };
        let summary = |estimate| z_test(&estimate, &[Rgb::ONE], &[true]);
        assert!(summary(one(1.01, 1e-4)).passes(0.01));
        assert!(!summary(one(f32::NAN, 1e-4)).passes(0.01));
        assert!(!summary(one(1.001, 0.0)).passes(0.01));
        assert!(!z_test(&one(1.0, 1.0), &[Rgb::ONE], &[false]).passes(0.01), "nothing tested is no pass");
    }
}
