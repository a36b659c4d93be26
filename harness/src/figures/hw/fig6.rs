//! Fig. 6: the swath.

use super::cone::{SWATHS, shadows};
use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::ledger::Bench;
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/fig6",
    place: "Snyder and Nowrouzezahrai 2008, Fig. 6",
    shows: "the shadow of a cone through swaths ΔΦ of 90° to 11.25°; k = 4, o = 2, nφ = 32, unit maximum unshadowed shading",
    look: "Narrower swaths sharpen the shadow's edges, each by less than the one before: what is left is the light's own lobe over elevation.",
    make,
};

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    shadows(bench, sheet, SWATHS)?;
    claim(bench, sheet, "H6")
}
