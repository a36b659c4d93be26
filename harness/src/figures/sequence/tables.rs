//! Rows of the tables on the page.

use super::changes::{Bend, Change, pops};
use crate::Error;
use crate::budget::{Seen, apart};
use crate::ledger::number;
use halflight_metrics::Difference;
use halflight_reports::plus_minus;

/// How far each frame is from the truth's.
pub(in crate::figures) fn distances(run: &[Seen], truth: &[Seen]) -> Result<Vec<Difference>, Error> {
    run.iter().zip(truth).map(|(run, truth)| apart(run, truth)).collect()
}

/// A row of errors over all frames.
pub(in crate::figures) fn errors_of(name: &str, run: &[Seen], truth: &[Seen]) -> Result<Vec<String>, Error> {
    let apart = distances(run, truth)?;
    let count = apart.len() as f64;
    let mean = |of: fn(&Difference) -> f64| apart.iter().map(of).sum::<f64>() / count;
    let error = |of: fn(&Difference) -> f64| apart.iter().map(|d| of(d).powi(2)).sum::<f64>().sqrt() / count;
    let level = |seen: &Seen| f64::from(seen.picture.radiance.iter().map(|v| v.element_sum()).sum::<f32>()) / 3.0;
    let receivers = count * truth.first().map_or(1.0, |seen| seen.variance.len() as f64);
    let worst = apart.iter().max_by(|a, b| a.rmse.total_cmp(&b.rmse));
    Ok(vec![
        name.to_owned(),
        number(truth.iter().map(level).sum::<f64>() / receivers),
        plus_minus(mean(|d| d.rmse), error(|d| d.rmse_error)),
        worst.map_or("–".into(), |d| plus_minus(d.rmse, d.rmse_error)),
        plus_minus(mean(|d| d.bias), error(|d| d.bias_error)),
    ])
}

/// Columns of [`changes_of`].
pub(in crate::figures) const CHANGES: [&str; 7] = [
    "change of e from the frame before",
    "RMS, all frames",
    "of truth",
    "largest RMS of a frame",
    "of truth, there",
    "largest of a receiver",
    "of truth",
];

/// A row of changes from frame to frame, beside the truth's.
pub(in crate::figures) fn changes_of(name: &str, changes: &[Change]) -> Vec<String> {
    let rms =
        |of: fn(&Change) -> f64| (changes.iter().map(|c| of(c).powi(2)).sum::<f64>() / changes.len() as f64).sqrt();
    let most = |of: fn(&Change) -> f64| changes.iter().map(of).fold(0.0, f64::max);
    let largest = changes.iter().max_by(|a, b| a.error.total_cmp(&b.error)).copied().unwrap_or_default();
    let values =
        [rms(|c| c.error), rms(|c| c.truth), largest.error, largest.truth, most(|c| c.worst), most(|c| c.worst_truth)];
    [vec![name.to_owned()], values.map(number).to_vec()].concat()
}

/// A row of bends, and at which frames they are pops.
pub(in crate::figures) fn popping(name: &str, bends: &[Bend], truth: &[Bend]) -> Vec<String> {
    let sizes: Vec<f64> = bends.iter().map(|bend| bend.size).collect();
    let median = halflight_metrics::median(&sizes).unwrap_or(f64::NAN);
    let frames: Vec<String> = pops(bends, truth).iter().map(ToString::to_string).collect();
    let frames = if frames.is_empty() { "none".into() } else { frames.join(", ") };
    vec![name.to_owned(), number(median), number(sizes.iter().copied().fold(0.0, f64::max)), frames]
}
