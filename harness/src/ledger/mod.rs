//! The reproduction ledger: a paper's claims, each with its figure, ours, and a verdict.
//!
//! A [`Row`] is one claim: what the paper says and prints (data), how it is measured (`Row::measure`), and the rule that makes
//! figures a verdict (`Row::judge`). What was measured is in a store, as [`Measured`] lines;
//! [`page()`] renders it, and measures nothing. Figures of a row count together only if they were taken together.

mod asking;
mod bench;
mod ground;
mod page;
mod plain;
mod row;
mod rows;
mod shadows;

use crate::{Error, environment};
use halflight_results::{Key, Measured, Record, Store};
use row::Judgement;
use std::time::{SystemTime, UNIX_EPOCH};

pub(crate) use asking::direct;
pub use bench::Terms;
pub(crate) use bench::{Bench, Figure as Ours, Setting, silent};
pub(crate) use ground::Ground;
pub use page::page;
pub(crate) use page::value;
pub use row::Row;
pub(crate) use row::number;
pub use rows::{ROWS, chosen};
pub(crate) use rows::{Seams, swaying};
pub(crate) use shadows::{SHADOW, in_shadow, mean_change};

/// Measures a row and appends its figures to a store; returns how many there are.
///
/// # Errors
/// What the row needs is not there, a method fails, or the store cannot be written.
pub fn measure(row: &Row, terms: &Terms, store: &mut Store) -> Result<usize, Error> {
    let figures = (row.measure)(&Bench::new(terms))?;
    let (count, lines) = (figures.len(), lines(row, figures));
    lines.into_iter().try_for_each(|line| store.append(Record::Measured(Box::new(line))))?;
    Ok(count)
}

/// Measures a row and judges what it found, and keeps nothing.
pub(crate) fn take(row: &Row, bench: &Bench) -> Result<(Vec<Ours>, Judgement), Error> {
    let figures = (row.measure)(bench)?;
    let lines = lines(row, figures.clone());
    Ok((figures, page::judgement(row, &lines.iter().collect::<Vec<_>>())))
}

/// Figures that were taken now, as lines of a store.
fn lines(row: &Row, figures: Vec<Ours>) -> Vec<Measured> {
    let taken = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
    let (revision, environment) = (revision(), environment());
    let line = |figure: Ours| Measured {
        row: row.id.to_owned(),
        quantity: figure.quantity,
        unit: figure.unit.to_owned(),
        value: figure.value,
        interval: figure.interval,
        samples: figure.samples,
        command: row.command(),
        revision: revision.clone(),
        taken,
        environment: environment.clone(),
    };
    figures.into_iter().map(line).collect()
}

/// One hash for the sources of all families.
fn revision() -> String {
    let families: Vec<&str> = halflight_registry::methods().iter().map(|method| method.info().family()).collect();
    let revisions: String = families.iter().filter_map(|family| halflight_registry::revision(family)).collect();
    Key::of_bytes(revisions.as_bytes()).short().to_string()
}
