//! The ledger as a page of Markdown, from stored figures alone.

use super::row::{Figures, Judgement, Row, Verdict, number};
use super::rows::ROWS;
use halflight_results::{Measured, Store};
use std::fmt::Write;

/// Papers, by the letter that their rows' ids begin with.
const PAPERS: [(&str, &str); 2] = [
    ("S", "Ren et al. 2006: soft shadows by spherical harmonic exponentiation"),
    ("H", "Snyder and Nowrouzezahrai 2008: fast soft self-shadowing on dynamic height fields"),
];

/// The page: for each paper a table of verdicts, then a section a row.
pub fn page(store: &Store) -> String {
    let mut page = String::from(
        "# Ledger\n\n\
         Written by `halflight ledger` from the lines in `reports/ledger`; do not edit. What papers say, what they print, what\n\
         `halflight ledger measure` found here, and what follows. Intervals hold the median of interleaved rounds, or an estimate\n\
         against ray-traced references, with 95%; a figure without one is counted or computed and has no spread.\n",
    );
    for (letter, paper) in PAPERS {
        let rows = ROWS.iter().filter(|row| row.id.starts_with(letter));
        let judged: Vec<_> = rows.map(|row| (row, store.measured(row.id))).collect();
        let _ = write!(page, "\n## {paper}\n\n| row | claim | verdict |\n|---|---|---|\n");
        for (row, figures) in &judged {
            let verdict = judgement(row, figures).verdict.name();
            let _ = writeln!(page, "| {} | {} | {verdict} |", row.id, row.claim);
        }
        judged.iter().for_each(|(row, figures)| section(&mut page, row, figures));
    }
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
    let _ = write!(page, "\n### {}: {}\n\n{} ({}).\n\n", row.id, verdict.name(), row.claim, row.place);
    let _ = writeln!(page, "**{}.** {why}\n", capital(verdict.name()));
    let _ = writeln!(page, "| quantity | paper | ours | 95% interval | of |\n|---|---|---|---|---|");
    for figure in figures {
        let printed = row.printed(&figure.quantity).unwrap_or("–");
        let interval = figure.interval.map_or("–".to_owned(), |[low, high]| {
            if low == high { "–".to_owned() } else { format!("{} to {}", number(low), number(high)) }
        });
        let (quantity, ours) = (&figure.quantity, value(figure.value, &figure.unit));
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

/// A number with its unit.
pub(crate) fn value(value: f64, unit: &str) -> String {
    let value = number(value);
    match unit {
        "" => value,
        unit @ ("%" | "×" | "°") => format!("{value}{unit}"),
        unit => format!("{value} {unit}"),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::Record;
    use std::path::Path;

    fn reports() -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports")
    }

    /// A copy of the shipped figures, each changed by the function.
    fn changed(change: impl Fn(&mut Measured)) -> String {
        let dir = tempfile::tempdir().unwrap();
        let shipped = Store::open(reports().join("ledger")).unwrap();
        let mut store = Store::open(dir.path()).unwrap();
        for figure in ROWS.iter().flat_map(|row| shipped.measured(row.id)) {
            let mut figure = figure.clone();
            change(&mut figure);
            store.append(Record::Measured(Box::new(figure))).unwrap();
        }
        page(&store)
    }

    #[test]
    fn the_shipped_page_is_what_the_shipped_figures_say() {
        let shipped = std::fs::read_to_string(reports().join("ledger.md")).unwrap();
        assert!(changed(|_| {}) == shipped, "reports/ledger.md: `halflight ledger` writes it");
    }

    #[test]
    fn another_figure_is_another_page() {
        let page = changed(|figure| {
            if figure.quantity == "entries that selection rules allow, order 4" {
                figure.value = 369.0;
            }
        });
        assert!(page.contains("| entries that selection rules allow, order 4 | 369 | 369 | – | 4096 |"), "{page}");
        assert!(page.contains("### S1: confirmed"), "{page}");
        assert_ne!(page, changed(|_| {}));
    }

    #[test]
    fn figures_of_two_measurements_are_not_mixed() {
        let page = changed(|figure| {
            if figure.row == "S1" && figure.quantity.ends_with("order 8") {
                figure.taken += 1;
            }
        });
        assert!(page.contains("### S1: not measured"), "the later figures are not all");
    }

    #[test]
    fn every_row_is_of_a_paper() {
        for row in ROWS {
            assert_eq!(PAPERS.iter().filter(|(letter, _)| row.id.starts_with(letter)).count(), 1, "{}", row.id);
        }
    }

    /// A paper's figure stands beside a quantity of ours, not beside a name that nothing has.
    #[test]
    fn printed_figures_are_of_quantities_that_are_measured() {
        let shipped = Store::open(reports().join("ledger")).unwrap();
        for row in ROWS {
            let figures = shipped.measured(row.id);
            for (quantity, _) in row.paper.iter().filter(|_| !figures.is_empty()) {
                assert!(figures.iter().any(|figure| figure.quantity == *quantity), "{}: {quantity}", row.id);
            }
            assert_eq!(judgement(row, &figures).verdict == Verdict::NotMeasured, figures.is_empty(), "{}", row.id);
        }
    }
}
