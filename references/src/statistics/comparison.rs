//! Holding an estimate against another or against exact values, over many receivers at once.

use std::ops::Add;

use halflight_scenes::Rgb;

use super::{normal_quantile_above, student_survival};
use crate::Estimate;

/// What two tests find: one asks whether any receiver is off, the other whether all are on average.
///
/// Channels of a receiver share their samples, so that nothing is known about how they hang together; Bonferroni's correction
/// holds whatever it is. Scores follow Student's t where batches' means are all but normal, as with [`crate::Quality::fixed`];
/// with few samples they have longer tails, and only `bias_p` holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Receivers tested: those with samples.
    pub receivers: usize,
    /// Largest |z| of any receiver and channel: each Student t as the normal z of equal probability. Infinite where values
    /// differ and claim no error, or are not finite.
    pub largest: f64,
    /// Probability that honest receivers have such an outlier: the smallest p times receivers and channels.
    pub family_p: f64,
    /// Mean difference over receivers, a channel: the first estimate's excess.
    pub bias: [f64; 3],
    /// Standard error of `bias`.
    pub bias_error: [f64; 3],
    /// Probability that `bias` is so far from zero in any channel: the smallest p of the three times three.
    pub bias_p: f64,
    /// Probability of differences at least as large in any channel of a receiver, for a map; `None` where it was not tested.
    pub receiver_p: Vec<Option<f64>>,
}

impl Comparison {
    /// Probability that either test finds as much in honest estimates: the smaller of `family_p` and `bias_p`, twice.
    pub fn p(&self) -> f64 {
        (2.0 * self.family_p.min(self.bias_p)).min(1.0)
    }

    /// Whether [`Self::p`] is above a level, the probability that an honest comparison is rejected. Nothing tested is no pass.
    pub fn passes(&self, level: f64) -> bool {
        self.receivers > 0 && self.p() > level
    }
}

/// Compares two estimates with independent errors (other seeds, other programs) at receivers that both have sampled, by
/// Welch's test.
///
/// # Panics
/// If they differ in their number of receivers.
pub fn compare(a: &Estimate, b: &Estimate) -> Comparison {
    assert_eq!(a.mean.len(), b.mean.len(), "estimates of the same receivers");
    tests((0..a.mean.len()).map(|i| {
        (a.samples[i] > 0 && b.samples[i] > 0).then(|| {
            [0, 1, 2].map(|channel| Difference {
                value: f64::from(a.mean[i][channel]) - f64::from(b.mean[i][channel]),
                error: Uncertainty::of(a, i, channel) + Uncertainty::of(b, i, channel),
            })
        })
    }))
}

/// Compares an estimate with exact values at receivers that it has sampled.
///
/// # Panics
/// If they differ in their number of receivers.
pub fn compare_exact(estimate: &Estimate, exact: &[Rgb]) -> Comparison {
    assert_eq!(estimate.mean.len(), exact.len(), "one exact value a receiver");
    tests(exact.iter().enumerate().map(|(i, exact)| {
        (estimate.samples[i] > 0).then(|| {
            [0, 1, 2].map(|channel| Difference {
                value: f64::from(estimate.mean[i][channel]) - f64::from(exact[channel]),
                error: Uncertainty::of(estimate, i, channel),
            })
        })
    }))
}

/// A variance and how well it is known.
#[derive(Clone, Copy, Debug, Default)]
struct Uncertainty {
    variance: f64,
    /// Sum of `variance²/degrees of freedom` over its independent parts.
    doubt: f64,
}

impl Uncertainty {
    fn of(estimate: &Estimate, receiver: usize, channel: usize) -> Self {
        let variance = f64::from(estimate.variance[receiver][channel]);
        let degrees = f64::from(estimate.batches.max(2) - 1);
        Uncertainty { variance, doubt: variance * variance / degrees }
    }

    /// Degrees of freedom (Satterthwaite 1946, Welch 1947).
    fn degrees(self) -> f64 {
        self.variance * self.variance / self.doubt
    }
}

impl Add for Uncertainty {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Uncertainty { variance: self.variance + other.variance, doubt: self.doubt + other.doubt }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Difference {
    value: f64,
    error: Uncertainty,
}

impl Difference {
    /// Probability of one at least as large by chance. 0 where it claims no error, and for what is not finite.
    fn p(self) -> f64 {
        if self.value == 0.0 && self.error.variance >= 0.0 {
            return 1.0;
        }
        let score = self.value.abs() / self.error.variance.sqrt();
        if !score.is_finite() {
            return 0.0;
        }
        // Never 0 by underflow: that is kept for what chance cannot do.
        (2.0 * student_survival(score, self.error.degrees())).max(f64::MIN_POSITIVE)
    }
}

impl Add for Difference {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Difference { value: self.value + other.value, error: self.error + other.error }
    }
}

fn tests(differences: impl Iterator<Item = Option<[Difference; 3]>>) -> Comparison {
    let (mut receivers, mut smallest, mut sums) = (0, 1.0, [Difference::default(); 3]);
    let mut receiver_p = Vec::new();
    for channels in differences {
        receiver_p.push(channels.map(|channels| {
            let p = smallest_p(channels);
            receivers += 1;
            smallest = p.min(smallest);
            sums = [0, 1, 2].map(|i| sums[i] + channels[i]);
            (3.0 * p).min(1.0)
        }));
    }
    let count = receivers.max(1) as f64;
    Comparison {
        receivers,
        largest: normal_quantile_above(0.5 * smallest),
        family_p: (3.0 * count * smallest).min(1.0),
        bias: sums.map(|sum| sum.value / count),
        bias_error: sums.map(|sum| sum.error.variance.sqrt() / count),
        bias_p: (3.0 * smallest_p(sums)).min(1.0),
        receiver_p,
    }
}

fn smallest_p(channels: [Difference; 3]) -> f64 {
    channels.into_iter().map(Difference::p).fold(1.0, f64::min)
}

#[cfg(test)]
mod tests;
