//! Where an estimate comes from and how good it turned out, as its file tells.

use halflight_scenes::Frame;
use serde::{Deserialize, Serialize};

use crate::{Estimate, Quality, REVISION, Request};

/// How an estimate was asked for, and what came of it. Equal requests have equal provenance: no clock, no machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// [`Request::key`].
    pub key: String,
    /// [`REVISION`] that it was made by.
    pub revision: String,
    /// Id of the reference.
    pub reference: String,
    /// Which light: `direct`, `indirect-2`, `total`.
    pub quantity: String,
    /// The scene's name.
    pub scene: String,
    /// The frame's index.
    pub frame: usize,
    /// The frame's receivers, valid or not.
    pub receivers: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// How good it was to be.
    pub quality: Quality,
    /// How good it is; none while it is being made.
    pub achieved: Option<Achieved>,
}

/// How good an estimate is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Achieved {
    /// The scene's mean level that errors are relative to, as of [`Quality::standard_error`]; radiance.
    pub level: f64,
    /// Root mean square over sampled receivers and channels of the standard error for albedo 1, relative to `level`.
    pub standard_error: f64,
    /// Sampled receivers whose standard error, as of [`Quality::standard_error`], is above the target.
    pub above_target: usize,
    /// Receivers sampled.
    pub sampled: usize,
    /// Samples taken.
    pub samples: u64,
}

impl Provenance {
    /// What a request asks for.
    pub(crate) fn of(request: &Request<'_>) -> Self {
        Provenance {
            key: request.key(),
            revision: REVISION.to_owned(),
            reference: request.reference.id(),
            quantity: request.quantity.to_string(),
            scene: request.scene.name.clone(),
            frame: request.frame.index,
            receivers: request.frame.receivers.len(),
            seed: request.seed,
            quality: *request.quality,
            achieved: None,
        }
    }

    /// As JSON on one line of ASCII.
    pub(crate) fn to_ascii(&self) -> String {
        let json = serde_json::to_string(self).unwrap_or_default();
        json.chars().fold(String::new(), |mut ascii, c| {
            if c.is_ascii() {
                ascii.push(c);
            } else {
                c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| ascii += &format!("\\u{unit:04x}"));
            }
            ascii
        })
    }

    /// Reads it back.
    pub(crate) fn read(json: &str) -> Option<Self> {
        serde_json::from_str(json).ok()
    }
}

impl Achieved {
    /// Measures an estimate at a frame's receivers. Where the albedo is 0, so is the error.
    pub(crate) fn of(estimate: &Estimate, frame: &Frame, quality: &Quality, level: f64) -> Self {
        let variance = |i: usize| {
            let (albedo, variance) = (frame.receivers.albedo[i].as_dvec3(), estimate.variance[i].as_dvec3());
            let unscaled = [0, 1, 2].map(|c| if albedo[c] > 0.0 { variance[c] / (albedo[c] * albedo[c]) } else { 0.0 });
            unscaled.iter().sum::<f64>() / 3.0
        };
        let variances: Vec<f64> =
            (0..estimate.samples.len()).filter(|i| estimate.samples[*i] > 0).map(variance).collect();
        let sampled = variances.len();
        let relative = |variance: f64| if variance > 0.0 { variance.sqrt() / level } else { 0.0 };
        // What is at the target in double precision must not be above it for its rounding.
        let target = f64::from(quality.standard_error) * (1.0 + 1e-6);
        Achieved {
            level,
            standard_error: relative(variances.iter().sum::<f64>() / sampled.max(1) as f64),
            above_target: variances.iter().filter(|variance| relative(**variance) > target).count(),
            sampled,
            samples: estimate.samples.iter().map(|samples| u64::from(*samples)).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_ascii_and_reads_back() {
        let provenance = Provenance {
            key: "k".into(),
            revision: "r".into(),
            reference: "without:été".into(),
            quantity: "direct".into(),
            scene: "夜 \"\\\n😀".into(),
            frame: 3,
            receivers: 12,
            seed: u64::MAX,
            quality: Quality { standard_error: 0.1, ..Quality::default() },
            achieved: Some(Achieved { level: 0.1, standard_error: 1e-300, above_target: 1, sampled: 2, samples: 3 }),
        };
        let ascii = provenance.to_ascii();
        assert!(ascii.bytes().all(|byte| (b' '..=b'~').contains(&byte)), "{ascii}");
        assert_eq!(Provenance::read(&ascii), Some(provenance));
    }
}
