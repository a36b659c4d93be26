//! Differences that may be chance, because a reference was estimated anew.

use halflight_references::statistics::student_survival;

/// Probability that honest references, estimated anew, are rejected by any check of a comparison (Bonferroni: each check has an
/// equal share, whatever they have to do with each other).
pub const LEVEL: f64 = 1e-4;

/// Degrees of freedom of one receiver's variance, at least: those of the fewest batches that a reference may have.
const DEGREES: f64 = 7.0;

/// A value with its standard error, and how well that is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimated {
    pub(super) value: f64,
    pub(super) error: f64,
    /// Receivers of equal variance that would know the error as well.
    pub(super) effective: f64,
}

/// Two independent estimates of what should be one value.
#[derive(Debug)]
pub(super) struct Chance {
    /// Cell or reference.
    pub(super) subject: String,
    /// What is estimated.
    pub(super) what: String,
    pub(super) expected: Estimated,
    pub(super) found: Estimated,
    /// How far they may be apart by rounding.
    pub(super) slack: f64,
    /// Whether a value nearer to zero is better, rather than wrong.
    pub(super) error_measure: bool,
}

impl Chance {
    /// Probability of as much by chance, by Welch's test; 0 for what is not finite.
    pub(super) fn p(&self) -> f64 {
        let apart = (self.found.value - self.expected.value).abs() - self.slack;
        if apart <= 0.0 {
            return 1.0;
        }
        let (a, b) = (self.expected.error * self.expected.error, self.found.error * self.found.error);
        let doubt = |variance: f64, of: &Estimated| variance * variance / (DEGREES * of.effective.max(1.0));
        let degrees = (a + b) * (a + b) / (doubt(a, &self.expected) + doubt(b, &self.found));
        let score = apart / (a + b).sqrt();
        if score.is_finite() { 2.0 * student_survival(score, degrees) } else { 0.0 }
    }

    /// Expected and found, with their errors.
    pub(super) fn told(&self) -> String {
        let Chance { what, expected, found, .. } = self;
        let (e, f) = (expected.error, found.error);
        format!("{what}: expected {:.4e} ± {e:.1e}, found {:.4e} ± {f:.1e}", expected.value, found.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(expected: f64, found: f64, error: f64, slack: f64) -> f64 {
        let of = |value| Estimated { value, error, effective: 1e6 };
        let (subject, what) = Default::default();
        Chance { subject, what, expected: of(expected), found: of(found), slack, error_measure: false }.p()
    }

    #[test]
    fn chance_is_that_of_two_normal_numbers() {
        // Two-sided 5% is at 1.96 standard errors of the difference.
        assert!((p(1.0, 1.0 + 1.959_964 * 0.1 * 2f64.sqrt(), 0.1, 0.0) - 0.05).abs() < 1e-4);
        assert_eq!(p(1.0, 1.1, 0.1, 0.1), 1.0);
        assert!(p(1.0, 1.1, 0.01, 0.0) < 1e-9 && p(1.0, 1.1, 0.01, 0.09) > 0.1);
        assert_eq!([p(1.0, 1.1, 0.0, 0.01), p(1.0, f64::NAN, 0.1, 0.0), p(1.0, 2.0, f64::NAN, 0.0)], [0.0; 3]);
        assert_eq!(p(1.0, 1.0, 0.0, 0.0), 1.0);
    }
}
