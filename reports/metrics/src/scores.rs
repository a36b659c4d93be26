//! Every error measure at once.

use crate::perceptual::Pair;
use crate::picture::common;
use crate::{CompareError, Exposure, Layout, Picture, percentile};
use glam::Vec3;

/// Version of the error measures: scores of another version are not comparable and are made again.
pub const VERSION: u32 = 2;

/// The error of a picture against a reference; definitions in the [crate's documentation](crate).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores {
    /// Root mean square error, radiance.
    pub rmse: f64,
    /// Standard error of `rmse` by the reference's noise, to first order; channels of a receiver may share their noise.
    pub rmse_standard_error: f64,
    /// Relative mean square error.
    pub rel_mse: f64,
    /// Mean absolute error, radiance.
    pub mae: f64,
    /// Mean signed error, radiance; negative is too dark.
    pub bias: f64,
    /// Largest absolute error, radiance.
    pub max: f64,
    /// 99th percentile of the absolute error, radiance.
    pub p99: f64,
    /// Structural similarity of the displayed pictures, 1 for equal ones; images of at least 11 × 11 only.
    pub ssim: Option<f64>,
    /// FLIP of the displayed pictures, 0 for equal ones, at most 1; images only.
    pub flip: Option<f64>,
    /// Root mean square of the reference over the compared receivers, radiance: what an error is large or small to.
    pub level: f64,
    /// Root mean square of the reference's own standard error, radiance.
    pub reference_standard_error: f64,
    /// Whether the error exceeds the reference's standard error `σ`. The reference's noise is part of the RMSE, so what is
    /// held against `σ` is `√(RMSE² − σ²)`. If not, the picture's error is not known, only that it is small.
    pub resolved: bool,
    /// Receivers compared.
    pub receivers: usize,
}

impl Scores {
    /// The figures by name, as they stand in results: measures that do not apply are left out.
    pub fn measures(&self) -> impl Iterator<Item = (&'static str, f64)> {
        [
            ("rmse", Some(self.rmse)),
            ("rmse_standard_error", Some(self.rmse_standard_error)),
            ("rel_mse", Some(self.rel_mse)),
            ("mae", Some(self.mae)),
            ("bias", Some(self.bias)),
            ("max", Some(self.max)),
            ("p99", Some(self.p99)),
            ("ssim", self.ssim),
            ("flip", self.flip),
            ("level", Some(self.level)),
            ("reference_standard_error", Some(self.reference_standard_error)),
        ]
        .into_iter()
        .filter_map(|(name, value)| Some((name, value?)))
    }
}

/// Measures a picture against a reference whose mean has this standard error at every receiver (zeros for a reference
/// without noise).
///
/// # Errors
/// Lengths or layouts differ, no receiver is valid in both, or a value that counts is not finite.
pub fn compare(x: &Picture, reference: &Picture, reference_standard_error: &[Vec3]) -> Result<Scores, CompareError> {
    let receivers = common(x, reference, reference_standard_error)?;
    let mut sums = Sums::default();
    let mut absolute = Vec::with_capacity(3 * receivers.len());
    for &i in &receivers {
        let (x, r, e) = (x.radiance[i], reference.radiance[i], reference_standard_error[i]);
        for ((x, r), e) in x.to_array().into_iter().zip(r.to_array()).zip(e.to_array()) {
            let difference = f64::from(x) - f64::from(r);
            sums.add(difference, f64::from(r), f64::from(e));
            absolute.push(difference.abs());
        }
    }
    absolute.sort_by(f64::total_cmp);
    let count = absolute.len() as f64;
    let rmse = (sums.square / count).sqrt();
    let standard_error = (sums.variance / count).sqrt();
    let (ssim, flip) = perceptual(x, reference, &receivers);
    Ok(Scores {
        rmse,
        rmse_standard_error: if rmse > 0.0 { sums.square_error() / (2.0 * rmse * count) } else { 0.0 },
        rel_mse: sums.relative / count,
        mae: sums.absolute / count,
        bias: sums.signed / count,
        max: absolute.last().copied().unwrap_or(0.0),
        p99: percentile(&absolute, 99.0).unwrap_or(0.0),
        ssim,
        flip,
        level: (sums.level / count).sqrt(),
        reference_standard_error: standard_error,
        resolved: rmse * rmse > 2.0 * standard_error * standard_error,
        receivers: receivers.len(),
    })
}

#[derive(Default)]
struct Sums {
    square: f64,
    relative: f64,
    absolute: f64,
    signed: f64,
    level: f64,
    variance: f64,
    doubt: f64,
    least_doubt: f64,
}

impl Sums {
    fn add(&mut self, d: f64, r: f64, standard_error: f64) {
        self.square += d * d;
        self.relative += d * d / (r * r + 0.01);
        self.absolute += d.abs();
        self.signed += d;
        self.level += r * r;
        let variance = standard_error * standard_error;
        self.variance += variance;
        // As in `difference`: the variance of d² for a normal d of mean δ is 4δ²σ² + 2σ⁴, and the mean of d² is δ² + σ².
        self.doubt += 4.0 * d * d * variance - 2.0 * variance * variance;
        self.least_doubt += 2.0 * variance * variance;
    }

    /// Standard error of the sum of squares, if the three channels of a receiver have the same noise.
    fn square_error(&self) -> f64 {
        (3.0 * f64::max(self.doubt, self.least_doubt)).sqrt()
    }
}

fn perceptual(x: &Picture, reference: &Picture, receivers: &[usize]) -> (Option<f64>, Option<f64>) {
    let Layout::Image { width, height } = x.layout else { return (None, None) };
    let mut counts = vec![false; x.radiance.len()];
    receivers.iter().for_each(|&i| counts[i] = true);
    let exposure = Exposure::of_reference(reference.radiance, &counts);
    let pair = Pair { width, height, x: x.radiance, reference: reference.radiance, counts: &counts, exposure };
    (pair.ssim(), pair.flip())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of twelve uniform numbers (PCG's multiplier) are all but normal.
    fn normal(state: &mut u64) -> f32 {
        let mut uniform = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 40) as f32 / (1u64 << 24) as f32
        };
        (0..12).map(|_| uniform()).sum::<f32>() - 6.0
    }

    #[test]
    fn the_standard_error_of_rmse_is_its_scatter() {
        const RECEIVERS: usize = 300;
        const TRIALS: usize = 400;
        let (x, valid) = ([Vec3::ONE; RECEIVERS], [true; RECEIVERS]);
        let mut state = 11;
        // From errors far above the noise to none at all; all channels of a receiver have the same noise.
        for (error, noise) in [(0.5, 0.02), (0.05, 0.05), (0.0, 0.05)] {
            let (mut rmse, mut stated) = (Vec::new(), 0.0);
            for _ in 0..TRIALS {
                let reference: Vec<Vec3> =
                    (0..RECEIVERS).map(|_| Vec3::splat(1.0 - error + noise * normal(&mut state))).collect();
                let picture = |radiance| Picture { radiance, valid: &valid, layout: Layout::List };
                let scores =
                    compare(&picture(&x), &picture(&reference), &[Vec3::splat(noise); RECEIVERS]).expect("finite");
                rmse.push(scores.rmse);
                stated += scores.rmse_standard_error / TRIALS as f64;
            }
            let mean = rmse.iter().sum::<f64>() / TRIALS as f64;
            let scatter = (rmse.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / (TRIALS - 1) as f64).sqrt();
            // The scatter of so many trials is known to 3.5%, one standard error.
            assert!((stated / scatter - 1.0).abs() < 0.12, "{error} {noise}: {stated} stated, {scatter} found");
        }
    }
}
