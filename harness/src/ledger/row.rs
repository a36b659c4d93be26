//! What a row of the ledger is made of.

use super::bench::{Bench, Figure};
use crate::Error;
use halflight_results::Measured;

/// A claim of a paper.
pub struct Row {
    /// Its id, such as `S1`.
    pub id: &'static str,
    /// Where the paper makes it.
    pub place: &'static str,
    /// What the paper says, in a sentence.
    pub claim: &'static str,
    /// The paper's figures: our name of the quantity, what the paper prints.
    pub paper: &'static [(&'static str, &'static str)],
    /// What measuring needs that may not be there yet; empty if nothing.
    pub needs: &'static str,
    /// Takes all figures of the row.
    pub(crate) measure: fn(&Bench) -> Result<Vec<Figure>, Error>,
    /// The verdict on figures; none where one that it needs is missing.
    pub(crate) judge: fn(&Figures<'_>) -> Option<Judgement>,
}

impl Row {
    /// The command that measures it again.
    pub fn command(&self) -> String {
        format!("halflight ledger measure {}", self.id)
    }

    /// What the paper prints for a quantity.
    pub(crate) fn printed(&self, quantity: &str) -> Option<&'static str> {
        self.paper.iter().find(|(name, _)| *name == quantity).map(|(_, printed)| *printed)
    }
}

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Confirmed,
    Partly,
    NotConfirmed,
    NotMeasured,
}

impl Verdict {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Verdict::Confirmed => "confirmed",
            Verdict::Partly => "partly",
            Verdict::NotConfirmed => "not confirmed",
            Verdict::NotMeasured => "not measured",
        }
    }

    /// Confirmed if all of the claim holds, partly if some of it.
    pub(crate) fn of(parts: &[bool]) -> Verdict {
        match parts.iter().filter(|holds| **holds).count() {
            0 => Verdict::NotConfirmed,
            count if count == parts.len() => Verdict::Confirmed,
            _ => Verdict::Partly,
        }
    }
}

/// A verdict and the sentence why.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Judgement {
    pub(crate) verdict: Verdict,
    pub(crate) why: String,
}

/// The figures of a row that were taken together.
pub(crate) struct Figures<'a>(pub(crate) &'a [&'a Measured]);

impl Figures<'_> {
    pub(crate) fn value(&self, quantity: &str) -> Option<f64> {
        self.find(quantity).map(|figure| figure.value)
    }

    /// The ends of a figure's interval, the figure itself where it has none.
    pub(crate) fn interval(&self, quantity: &str) -> Option<[f64; 2]> {
        self.find(quantity).map(|figure| figure.interval.unwrap_or([figure.value; 2]))
    }

    /// The values of these quantities; none if one is missing.
    pub(crate) fn values<const N: usize>(&self, quantities: [&str; N]) -> Option<[f64; N]> {
        let values: Option<Vec<f64>> = quantities.iter().map(|quantity| self.value(quantity)).collect();
        values?.try_into().ok()
    }

    fn find(&self, quantity: &str) -> Option<&Measured> {
        self.0.iter().find(|figure| figure.quantity == quantity).copied()
    }
}

/// A number as the ledger prints it: whole ones in full, others by three significant digits.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (value.fract() == 0.0 && value.abs() < 1e9) {
        return format!("{value:.0}");
    }
    let digits = 2 - value.abs().log10().floor() as i32;
    match digits {
        ..=0 if value.abs() < 1e9 => format!("{value:.0}"),
        1..=5 => format!("{value:.*}", digits as usize),
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let cases = [
            (0.0, "0"),
            (13018.0, "13018"),
            (1234.5, "1234"),
            (11.04, "11.0"),
            (0.0453, "0.0453"),
            (-0.00123, "-0.00123"),
            (1.5e-7, "1.50e-7"),
        ];
        cases.iter().for_each(|(value, text)| assert_eq!(number(*value), *text));
    }

    #[test]
    fn a_claim_holds_in_all_parts_in_some_or_in_none() {
        assert_eq!(Verdict::of(&[true, true]), Verdict::Confirmed);
        assert_eq!(Verdict::of(&[true, false]), Verdict::Partly);
        assert_eq!(Verdict::of(&[false, false]), Verdict::NotConfirmed);
    }
}
