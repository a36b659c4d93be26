//! Rows of the ledger on a figure's page.

use crate::Error;
use crate::ledger::{Bench, Ours, ROWS, number, value};
use halflight_reports::Sheet;

/// Measures a row of the ledger and puts its claim, the verdict on what was measured now, and the figures on the page.
pub(super) fn claim(bench: &Bench, sheet: &mut Sheet, id: &str) -> Result<(), Error> {
    let row = ROWS.iter().find(|row| row.id == id).ok_or_else(|| Error::Other(format!("no row {id} in the ledger")))?;
    let (figures, judgement) = crate::ledger::take(row, bench)?;
    sheet.heading(&format!("{} of the ledger: {}", row.id, judgement.verdict.name()));
    sheet.note(&format!("{} ({}).", row.claim, row.place));
    sheet.note(&judgement.why);
    let cells = |figure: &Ours| {
        let printed = row.printed(&figure.quantity).unwrap_or("–").to_owned();
        let interval =
            figure.interval.map_or("–".into(), |[low, high]| format!("{} to {}", number(low), number(high)));
        let ours = value(figure.value, figure.unit);
        vec![figure.quantity.clone(), printed, ours, interval, figure.samples.to_string()]
    };
    let rows: Vec<Vec<String>> = figures.iter().map(cells).collect();
    sheet.table(&["quantity", "paper", "ours", "95% interval", "of"], &rows);
    Ok(())
}
