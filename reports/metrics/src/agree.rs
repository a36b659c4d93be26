//! The comparator of the gates: does a picture agree with a reference?

use crate::Scores;

/// How much disagreement passes, in units of the reference's [`Scores::level`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Limit of the RMSE, to which the reference's standard error is added.
    pub rmse: f64,
    /// Limit of the bias' size, to which the reference's standard error is added.
    pub bias: f64,
    /// Limit of the largest absolute error at any receiver. The reference's noise is *not* added: allow for it.
    pub max: f64,
}

/// Why a picture does not agree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Disagreement {
    /// A measure is over its limit.
    #[error("{measure} is {value:.3e}, over its limit of {limit:.3e} (radiance)")]
    Over {
        /// Which measure.
        measure: &'static str,
        /// Its size.
        value: f64,
        /// Its limit.
        limit: f64,
    },
    /// The reference is black: agreement with it would say nothing.
    #[error("the reference is black at every receiver: it cannot judge a picture")]
    BlackReference,
    /// A limit or a score is not a finite number (limits may not be negative either).
    #[error("{0} is not a number that can be compared")]
    NotComparable(&'static str),
}

/// Passes exactly when every measure is within its limit.
///
/// # Errors
/// The first measure that is over its limit, or why nothing can be said. What cannot be judged does not pass.
pub fn agrees(scores: &Scores, tolerance: &Tolerance) -> Result<(), Disagreement> {
    let level = scores.level;
    let noise = scores.reference_standard_error;
    if !level.is_finite() || !noise.is_finite() {
        return Err(Disagreement::NotComparable("the reference's level or standard error"));
    }
    if level <= 0.0 {
        return Err(Disagreement::BlackReference);
    }
    for (measure, value, share, allowance) in [
        ("RMSE", scores.rmse, tolerance.rmse, noise),
        ("bias", scores.bias.abs(), tolerance.bias, noise),
        ("largest error", scores.max, tolerance.max, 0.0),
    ] {
        let limit = share * level + allowance;
        if !value.is_finite() || !limit.is_finite() || share < 0.0 {
            return Err(Disagreement::NotComparable(measure));
        }
        if value > limit {
            return Err(Disagreement::Over { measure, value, limit });
        }
    }
    Ok(())
}
