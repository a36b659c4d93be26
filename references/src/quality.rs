//! How good an estimate is to be, and how much work it may take.

use crate::{Error, Result};

/// When a receiver has enough samples.
///
/// Counts are rounded to what the sampler can do: powers of two a batch.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Quality {
    /// Target for a receiver's standard error: RMS over the colour channels, of what it would reflect with albedo 1, relative
    /// to the scene's mean level `1/4π ∫ L dω` (mean over the sphere and the channels). 0 takes `max_samples` everywhere.
    pub standard_error: f32,
    /// Least samples a receiver.
    pub min_samples: u32,
    /// Most samples a receiver, the pilot's not counted.
    pub max_samples: u32,
    /// Independent replicates that the samples are divided into, at least 8; degrees of freedom are one less.
    pub batches: u32,
}

impl Default for Quality {
    /// What pictures need: errors far below those of low-frequency methods, quick enough to wait for. Single z-scores of so few
    /// samples are skewed: tests of significance want [`Quality::fixed`].
    fn default() -> Self {
        Quality { standard_error: 0.015, min_samples: 64, max_samples: 4096, batches: 16 }
    }
}

impl Quality {
    /// The same number of samples at every receiver, in 64 batches: for a few points and for tests of significance, where the
    /// distribution of `(mean − truth)/error` should be all but normal; from 4096 samples on it is, also in its tails.
    pub fn fixed(samples: u32) -> Self {
        Quality { standard_error: 0.0, min_samples: samples, max_samples: samples, batches: 64 }
    }

    /// Whether every field is in its range.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn check(&self) -> Result<()> {
        let fail = |field, value, expected| Err(Error::Quality { field, value, expected });
        if !(self.standard_error.is_finite() && self.standard_error >= 0.0) {
            return fail("standard_error", self.standard_error.to_string(), "a finite number from 0");
        }
        if !(8..=1024).contains(&self.batches) {
            return fail("batches", self.batches.to_string(), "8 to 1024");
        }
        if self.min_samples == 0 || self.min_samples > self.max_samples {
            return fail("min_samples", self.min_samples.to_string(), "1 to max_samples");
        }
        if self.max_samples > 1 << 24 {
            return fail("max_samples", self.max_samples.to_string(), "at most 16777216");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_can_be_met_passes() {
        let good = Quality::default();
        assert!(good.check().is_ok() && Quality::fixed(4096).check().is_ok());
        for bad in [
            Quality { standard_error: f32::NAN, ..good },
            Quality { standard_error: -0.1, ..good },
            Quality { batches: 7, ..good },
            Quality { min_samples: 0, ..good },
            Quality { max_samples: 1, ..good },
            Quality { max_samples: u32::MAX, ..good },
        ] {
            assert!(bad.check().is_err(), "{bad:?}");
        }
    }
}
