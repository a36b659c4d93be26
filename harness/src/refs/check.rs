//! What there is of the references that are needed, and whether what is kept is right.

use super::Need;
use crate::Error;
use halflight_contract::{Cache, NoMeter};
use halflight_references::statistics::{self, Comparison};
use halflight_references::{Estimate, Provenance, Quality, ReferenceStore, Request, State, estimate};
use halflight_scenes::Frame;
use std::sync::Arc;

/// What there is of a reference.
pub struct Checked {
    /// Its key.
    pub key: String,
    /// What there is; `None` if there is nothing.
    pub state: Option<State>,
}

impl Checked {
    /// Its provenance if all of it is there.
    pub fn whole(&self) -> Option<&Provenance> {
        match &self.state {
            Some(State::Whole(provenance)) => Some(provenance),
            _ => None,
        }
    }

    /// In words: `present`, `missing`, `damaged`, `begun: 300 of 4000 receivers`.
    pub fn told(&self) -> String {
        match &self.state {
            Some(State::Whole(_)) => "present".to_owned(),
            Some(State::Begun { provenance, done, in_use }) => {
                let now = if *in_use { ", being made" } else { "" };
                format!("begun: {done} of {} receivers{now}", provenance.receivers)
            }
            Some(State::Damaged | State::Unplaced) => "damaged".to_owned(),
            None => "missing".to_owned(),
        }
    }
}

/// Looks up one.
pub fn check(need: &Need<'_>, store: &ReferenceStore) -> Checked {
    let key = need.request().key();
    Checked { state: store.state(&key), key }
}

/// That every one is there: a gate without its reference must not pass.
///
/// # Errors
/// Some are missing, begun only, or damaged; the message names them.
pub fn require(needs: &[Need<'_>], store: &ReferenceStore) -> Result<(), Error> {
    let absent = needs.iter().map(|need| (need, check(need, store))).filter(|(_, checked)| checked.whole().is_none());
    let absent: Vec<String> = absent.map(|(need, checked)| format!("{}: {}", need.label(), checked.told())).collect();
    if absent.is_empty() {
        return Ok(());
    }
    Err(Error::MissingReferences { count: absent.len(), of: needs.len(), which: absent.join("; ") })
}

/// A kept reference beside some of its receivers estimated again.
pub struct Retake {
    /// The test between the two; the kept one comes first.
    pub comparison: Comparison,
    /// Whether single receivers are judged too, rather than their mean alone: below 4096 samples, or in fewer than 64 batches, a
    /// receiver's errors have longer tails than the test knows.
    pub telling: bool,
}

/// Receivers that are estimated again.
const RECEIVERS: usize = 256;

/// Samples that each of them takes, from which on single errors are all but normal.
const TELLING: u32 = 4096;

/// Probability that an honest reference is rejected.
const LEVEL: f64 = 1e-4;

impl Retake {
    /// Estimates some receivers of a kept reference again, with another seed; `None` if it is not there.
    ///
    /// # Errors
    /// They cannot be estimated.
    pub fn of(need: &Need<'_>, store: &ReferenceStore, derived: &Cache) -> Result<Option<Self>, Error> {
        let request = need.request();
        let Some(kept) = store.get(&request.key()) else { return Ok(None) };
        let frame = &some(need.frame, RECEIVERS);
        // Any other than that of the kept one.
        let seed = request.seed ^ 0x5245_5441_4b45;
        let again = Request { frame, seed, quality: &Quality::fixed(TELLING), ..request };
        let again = estimate(&again, derived, &mut NoMeter)?;
        Ok(Some(Retake::between(&kept, &again)))
    }

    fn between(kept: &Estimate, again: &Estimate) -> Self {
        let least =
            kept.samples.iter().zip(&again.samples).filter(|(_, again)| **again > 0).map(|(kept, _)| *kept).min();
        let telling = kept.batches >= Quality::fixed(TELLING).batches && least.is_some_and(|least| least >= TELLING);
        Retake { comparison: statistics::compare(kept, again), telling }
    }

    /// Probability of such a difference between honest estimates.
    pub fn p(&self) -> f64 {
        if self.telling { self.comparison.p() } else { self.comparison.bias_p }
    }

    /// Whether it may be chance. Nothing tested is no pass.
    pub fn passes(&self) -> bool {
        self.comparison.receivers > 0 && self.p() > LEVEL
    }
}

/// The frame with about so many of its valid receivers, evenly spread; the others are not valid.
fn some(frame: &Frame, count: usize) -> Frame {
    let mut receivers = (*frame.receivers).clone();
    let valid: Vec<usize> = (0..receivers.len()).filter(|i| receivers.valid[*i]).collect();
    receivers.valid.fill(false);
    let taken = (0..count.min(valid.len())).map(|i| valid[i * valid.len() / count.min(valid.len())]);
    taken.for_each(|i| receivers.valid[i] = true);
    Frame { receivers: Arc::new(receivers), ..frame.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_receivers_are_spread_over_all() {
        let frame = halflight_scenes::find("bunny-studio").unwrap().frame(0);
        let all = |frame: &Frame| frame.receivers.valid.iter().filter(|valid| **valid).count();
        let few = some(&frame, 100);
        assert_eq!(all(&few), 100);
        assert!(few.receivers.valid.iter().zip(&frame.receivers.valid).all(|(few, all)| *all || !few));
        let last = few.receivers.valid.iter().rposition(|valid| *valid).unwrap();
        assert!(last > frame.receivers.len() * 9 / 10);
        assert_eq!(all(&some(&frame, 1 << 30)), all(&frame));
    }
}
