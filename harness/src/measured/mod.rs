//! Results of whole devices, kept in the repository: `reports/measured/<device>.jsonl`, and the page that compares them.
//!
//! A file is what a run on one machine found: its conditions on the first line, then a line a cell (`file.rs`). The page is made of the
//! files alone ([`page()`]), the fractions of a device's peak of the work that methods state (`passes.rs`).

mod conditions;
mod file;
mod page;
mod passes;

pub(crate) use conditions::PeakOf;
pub use conditions::{Conditions, Peak, conditions};
pub use file::{Cell, Difference, Measured, read_all};
pub use page::page;

use crate::Error;
use halflight_reports::twins;
use halflight_results::{Record, Run, Store};
use std::collections::HashSet;

/// The folder of the files, and the page beside it, seen from the repository's root.
pub const FOLDER: &str = "reports/measured";

/// What a store holds of these cells, with the conditions under which they were taken; no times where the adapter is one in software.
///
/// # Errors
/// The store has none of them.
pub fn collect(
    store: &Store,
    keys: &HashSet<halflight_results::Key>,
    conditions: Conditions,
) -> Result<Measured, Error> {
    let twins = twins(store);
    // Beside an adapter in software nothing is worth timing: its work is the processor's.
    let planned = || store.outcomes().filter_map(Record::cell).filter(|cell| keys.contains(&cell.key()));
    let software = planned().any(halflight_results::Cell::is_software);
    let cells: Vec<Cell> = store
        .outcomes()
        .filter_map(|record| {
            let key = record.cell().map(halflight_results::Cell::key).filter(|key| keys.contains(key))?;
            Some(Cell {
                outcome: without_picture(record),
                times: store.times(&key).filter(|_| !software).cloned(),
                scores: store.scores(&key).into_iter().cloned().collect(),
                twin: twins.iter().find(|twins| twins.gpu == key).map(Difference::of),
            })
        })
        .collect();
    if cells.is_empty() {
        return Err(Error::Other(format!("{}: expected results of what was to be measured", store.path().display())));
    }
    Ok(Measured { conditions, cells })
}

/// Pictures are not kept here, so none is named.
fn without_picture(record: &Record) -> Record {
    match record {
        Record::Run(run) => Record::Run(Box::new(Run { image: None, ..(**run).clone() })),
        other => other.clone(),
    }
}
