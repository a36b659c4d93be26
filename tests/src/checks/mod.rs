//! What every method must hold, whatever it computes.
//!
//! A check takes a [`Case`] (a method on a scene, with parameters and a quantity) and answers with a [`Verdict`], or
//! with the [`Violation`] that it found. [`check_all`] makes every case that a method supports and runs every check.

mod altered;
mod cancelling;
mod case;
mod derived;
mod footprint;
mod frames;
mod light;
mod meters;
mod order;
mod output;
mod planted;
mod retuning;

use std::fmt;

use halflight_contract::{Backend, Method};
use halflight_scenes::Scene;

pub use cancelling::{MAX_CALLS_AFTER_CANCEL, cancellation};
pub use case::Case;
pub use derived::shared_derived_data;
pub use footprint::footprint_counts_results;
pub use frames::fresh_equals_updated;
pub use light::{linear_in_light, turning_light};
pub use meters::meter_balanced;
pub use order::permuted_receivers;
pub use output::{dirty_output, finite_output, repeated_evaluation};
pub use planted::{Fault, planted};
pub use retuning::retuned_equals_fresh;

/// Where a method breaks the contract.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{method} breaks {check}: {detail}")]
pub struct Violation {
    /// The check's name.
    pub check: &'static str,
    /// The method's id.
    pub method: &'static str,
    /// Scene, quantity and what was found.
    pub detail: String,
}

/// What a check says of a method that it does not reject.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The check ran and the contract holds.
    Held,
    /// The check does not apply, and why.
    Exempt(&'static str),
}

/// A contract check.
pub type Check = fn(&Case<'_>) -> Result<Verdict, Violation>;

/// Every check by name.
pub const CHECKS: &[(&str, Check)] = &[
    ("dirty_output", dirty_output),
    ("repeated_evaluation", repeated_evaluation),
    ("finite_output", finite_output),
    ("permuted_receivers", permuted_receivers),
    ("fresh_equals_updated", fresh_equals_updated),
    ("retuned_equals_fresh", retuned_equals_fresh),
    ("cancellation", cancellation),
    ("shared_derived_data", shared_derived_data),
    ("linear_in_light", linear_in_light),
    ("turning_light", turning_light),
    ("meter_balanced", meter_balanced),
    ("footprint_counts_results", footprint_counts_results),
];

/// Runs every check on every quantity that the method supports with default parameters on these scenes, on the CPU.
///
/// A method that supports nothing on any of them is a violation too: nothing would have been checked.
pub fn check_all(method: &dyn Method, scenes: &[Scene]) -> Vec<Violation> {
    let cases: Vec<Case<'_>> = scenes.iter().flat_map(|scene| Case::all(method, scene, Backend::Cpu)).collect();
    if cases.is_empty() {
        let detail = format!("it supports no quantity on any of the {} scenes: nothing was checked", scenes.len());
        return vec![Violation { check: "check_all", method: method.info().id, detail }];
    }
    let run = |case| CHECKS.iter().filter_map(move |(_, check)| check(case).err());
    cases.iter().flat_map(run).collect()
}

/// Why a check fails: an error where none was due, or something observed.
struct Breach(String);

type Outcome = Result<Verdict, Breach>;

impl From<halflight_contract::Error> for Breach {
    fn from(error: halflight_contract::Error) -> Self {
        Breach(format!("unexpected error: {error}"))
    }
}

/// Refuses with a message unless the condition holds.
fn ensure(condition: bool, message: impl FnOnce() -> String) -> Result<(), Breach> {
    if condition { Ok(()) } else { Err(Breach(message())) }
}

/// Refuses values that are not the same bits.
fn same_bits(what: impl fmt::Display, expected: &[f32], found: &[f32]) -> Result<(), Breach> {
    close(what, expected, found, |e, f| e.to_bits() == f.to_bits())
}

/// Refuses values for which `agree(expected, found)` does not hold, naming the first and how many there are.
fn close(
    what: impl fmt::Display,
    expected: &[f32],
    found: &[f32],
    agree: impl Fn(f32, f32) -> bool,
) -> Result<(), Breach> {
    ensure(expected.len() == found.len(), || format!("{what}: {} values for {}", found.len(), expected.len()))?;
    let differ: Vec<usize> = (0..expected.len()).filter(|&i| !agree(expected[i], found[i])).collect();
    match differ.first() {
        None => Ok(()),
        Some(&i) => Err(Breach(format!(
            "{what}: value {i} is {:e}, expected {:e}; {} of {} differ",
            found[i],
            expected[i],
            differ.len(),
            expected.len()
        ))),
    }
}
