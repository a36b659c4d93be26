//! The table of nonzero entries of Γ (§3).

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::ledger::Bench;
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/gamma",
    place: "Ren et al. 2006, table of §3",
    shows: "nonzero entries of the triple product tensor Γ",
    look: "The counts agree but at order 4, where the print has 369 for 359: it is a misprint.",
    make,
};

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    claim(bench, sheet, "S1")
}
