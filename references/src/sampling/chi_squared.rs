//! Chi² tests of samplers: directions of independent random points against the shares of bins that are known without the
//! sampler.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::mix;
use crate::statistics::chi_squared_survival;

/// Probability that a family of honest samplers fails.
const LEVEL: f64 = 1e-3;
/// Bins that expect fewer are pooled.
const LEAST_EXPECTED: f64 = 20.0;
const DRAWS: u64 = 200_000;

/// Independent uniform points: low-discrepancy ones are more even than the test allows for.
pub(crate) fn draws(seed: u64) -> impl Iterator<Item = [f32; 2]> {
    let unit = |word: u64| ((word & 0x7f_ffff) as f32 + 0.5) * (1.0 / (1 << 23) as f32);
    (0..DRAWS).map(move |i| mix(mix(0x5eed, seed), i)).map(move |bits| [unit(bits), unit(bits >> 32)])
}

/// Probability of counts at least so far from expectation, in bins with known shares; 0 if anything falls in none.
fn p_value(shares: &[f64], drawn: impl Iterator<Item = Option<usize>>) -> f64 {
    let (mut counts, mut total) = (vec![0.0; shares.len()], 0.0);
    for bin in drawn {
        let Some(bin) = bin.filter(|bin| shares[*bin] > 0.0) else { return 0.0 };
        counts[bin] += 1.0;
        total += 1.0;
    }
    let mut bins: Vec<(f64, f64)> = shares.iter().map(|share| share * total).zip(counts).collect();
    bins.retain(|(expected, _)| *expected > 0.0);
    bins.sort_by(|a, b| b.0.total_cmp(&a.0));
    while let [.., before, last] = &mut bins[..]
        && last.0 < LEAST_EXPECTED
    {
        *before = (before.0 + last.0, before.1 + last.1);
        bins.pop();
    }
    let chi: f64 = bins.iter().map(|(expected, count)| (count - expected).powi(2) / expected).sum();
    chi_squared_survival(chi, (bins.len() - 1) as f64)
}

/// Tests that are to hold together.
#[derive(Default)]
pub(crate) struct Family {
    tests: Vec<(String, f64)>,
}

impl Family {
    /// Adds the test of what was drawn against the shares of its bins.
    pub(crate) fn add(&mut self, name: &str, shares: &[f64], drawn: impl Iterator<Item = Option<usize>>) {
        let sum: f64 = shares.iter().sum();
        assert!((sum - 1.0).abs() < 1e-5, "{name}: shares sum to {sum}");
        self.tests.push((name.to_owned(), p_value(shares, drawn)));
    }

    fn level(&self) -> f64 {
        LEVEL / self.tests.len() as f64
    }

    pub(crate) fn assert_holds(&self) {
        assert!(!self.tests.is_empty());
        let failed: Vec<_> = self.tests.iter().filter(|(_, p)| *p <= self.level()).collect();
        assert!(failed.is_empty(), "{failed:?}");
    }

    /// For samplers with a planted bias.
    pub(crate) fn assert_fails_everywhere(&self) {
        assert!(!self.tests.is_empty());
        let passed: Vec<_> = self.tests.iter().filter(|(_, p)| *p > self.level()).collect();
        assert!(passed.is_empty(), "{passed:?}");
    }
}

const RINGS: usize = 12;
const SECTORS: usize = 12;

/// Bins of equal solid angle in a circle of directions: those up to `height = 1 − cos α` below their pole.
pub(crate) fn ring_and_sector(direction: Vec3, axis: DVec3, height: f64) -> Option<usize> {
    let direction = direction.as_dvec3().normalize();
    polar_bin(0.5 * direction.distance_squared(axis) / height, direction, axis)
}

/// The bin of a direction, given the share of the whole that is nearer to the axis; up to 1% beyond the rim for rounding.
pub(crate) fn polar_bin(within: f64, direction: DVec3, axis: DVec3) -> Option<usize> {
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    let turns = direction.dot(bitangent).atan2(direction.dot(tangent)) / TAU;
    let sector = ((turns - turns.floor()) * SECTORS as f64) as usize;
    let ring = (within * RINGS as f64) as usize;
    (within < 1.01).then(|| ring.min(RINGS - 1) * SECTORS + sector.min(SECTORS - 1))
}

/// Shares of the bins of [`ring_and_sector`].
pub(crate) fn ring_shares() -> Vec<f64> {
    vec![1.0 / (RINGS * SECTORS) as f64; RINGS * SECTORS]
}

#[test]
fn p_values_are_uniform_and_strays_fail() {
    // Shares from 1 in 10 to 1 in 10 million: the small ones must be pooled for chi² to hold.
    let shares: Vec<f64> = (0..60).map(|i| 0.7f64.powi(i)).collect();
    let total: f64 = shares.iter().sum();
    let shares: Vec<f64> = shares.iter().map(|share| share / total).collect();
    let invert = |u: f32| {
        let mut sum = 0.0;
        shares.iter().position(|share| {
            sum += share;
            f64::from(u) < sum
        })
    };
    let few = |seed: u64| draws(seed).take(4000).map(|[u, _]| Some(invert(u).unwrap_or(59)));
    let mut below_half = 0;
    for seed in 0..400 {
        let p = p_value(&shares, few(seed));
        assert!(p > 1e-5, "seed {seed}: {p}");
        below_half += u32::from(p < 0.5);
    }
    assert!((160..240).contains(&below_half), "{below_half} of 400");
    assert_eq!(p_value(&shares, few(1).chain([None])), 0.0);
    assert_eq!(p_value(&[1.0, 0.0], [Some(0), Some(1)].into_iter()), 0.0);
}
