//! Every error measure at once.

use crate::perceptual::Pair;
use crate::picture::common;
use crate::{CompareError, Exposure, Layout, Picture, percentile};
use glam::Vec3;

/// Version of the error measures: scores of another version are not comparable and are made again.
pub const VERSION: u32 = 1;

/// The error of a picture against a reference; definitions in the [crate's documentation](crate).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores {
    /// Root mean square error, radiance.
    pub rmse: f64,
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
}

impl Sums {
    fn add(&mut self, d: f64, r: f64, standard_error: f64) {
        self.square += d * d;
        self.relative += d * d / (r * r + 0.01);
        self.absolute += d.abs();
        self.signed += d;
        self.level += r * r;
        self.variance += standard_error * standard_error;
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
