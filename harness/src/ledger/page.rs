//! The ledger as a page of Markdown, from stored figures alone.

use super::row::{Figures, Judgement, Row, Verdict, number};
use super::rows::ROWS;
use halflight_results::{Measured, Store};
use std::fmt::Write;

/// The page: a table of verdicts, then a section a row.
pub fn page(store: &Store) -> String {
    let judged: Vec<_> = ROWS.iter().map(|row| (row, store.measured(row.id))).collect();
    let mut page = String::from(
        "# Ledger: Ren et al. 2006\n\n\
         Written by `halflight ledger` from the lines in `reports/ledger`; do not edit. What the paper says, what it prints, what\n\
         `halflight ledger measure` found here, and what follows. Intervals hold the median of interleaved rounds, or an estimate\n\
         against ray-traced references, with 95%; a figure without one is counted or computed and has no spread.\n\n\
         | row | claim | verdict |\n|---|---|---|\n",
    );
    for (row, figures) in &judged {
        let verdict = judgement(row, figures).verdict.name();
        let _ = writeln!(page, "| {} | {} | {verdict} |", row.id, row.claim);
    }
    judged.iter().for_each(|(row, figures)| section(&mut page, row, figures));
    page
}

/// The verdict on a row, and why.
pub(crate) fn judgement(row: &Row, figures: &[&Measured]) -> Judgement {
    (row.judge)(&Figures(figures)).unwrap_or_else(|| {
        let needs = if row.needs.is_empty() { String::new() } else { format!("; it needs {}", row.needs) };
        Judgement { verdict: Verdict::NotMeasured, why: format!("The store has no such figures{needs}.") }
    })
}

fn section(page: &mut String, row: &Row, figures: &[&Measured]) {
    let Judgement { verdict, why } = judgement(row, figures);
    let _ = write!(page, "\n## {}: {}\n\n{} ({}).\n\n", row.id, verdict.name(), row.claim, row.place);
    let _ = writeln!(page, "**{}.** {why}\n", capital(verdict.name()));
    let _ = writeln!(page, "| quantity | paper | ours | 95% interval | of |\n|---|---|---|---|---|");
    for figure in figures {
        let printed = row.printed(&figure.quantity).unwrap_or("–");
        let interval = figure.interval.map_or("–".to_owned(), |[low, high]| {
            if low == high { "–".to_owned() } else { format!("{} to {}", number(low), number(high)) }
        });
        let (quantity, ours) = (&figure.quantity, with_unit(figure));
        let _ = writeln!(page, "| {quantity} | {printed} | {ours} | {interval} | {} |", figure.samples);
    }
    for (quantity, printed) in row.paper {
        if !figures.iter().any(|figure| figure.quantity == *quantity) {
            let _ = writeln!(page, "| {quantity} | {printed} | not measured | – | – |");
        }
    }
    let _ = write!(page, "\n`{}`", row.command());
    if let Some(figure) = figures.first() {
        let e = &figure.environment;
        let _ = write!(page, " on {}, {} threads, {}; sources {}.", e.cpu, e.threads, e.rustc, figure.revision);
    }
    page.push('\n');
}

fn with_unit(figure: &Measured) -> String {
    let value = number(figure.value);
    match figure.unit.as_str() {
        "" => value,
        unit @ ("%" | "×" | "°") => format!("{value}{unit}"),
        unit => format!("{value} {unit}"),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
