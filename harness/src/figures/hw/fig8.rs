//! Fig. 8: a terrain of 1024 × 1024 vertices.

use super::panels::{Panels, from_south, planned};
use crate::Error;
use crate::figures::Figure;
use crate::ledger::Bench;
use crate::plan::Group;
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/fig8",
    place: "Snyder and Nowrouzezahrai 2008, Fig. 8",
    shows: "a fractal terrain of 1024 × 1024 vertices under a key light and a sky",
    look: "Hills of all sizes throw soft shadows. What the traced picture has black, a light of order 4 leaves half lit, by the pyramid and by \
           exact horizons alike.",
    make,
};

const SIZE: [usize; 2] = [480, 240];

fn name(group: &Group) -> String {
    let exact = group.method.info().id == "horizon-wedges/sweep";
    if exact { "exact sweep" } else { "pyramid, k = 4, o = 2" }.into()
}

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let plan = planned("paper/hw-fig8")?;
    let panels = Panels::new(bench, &plan, 0, &from_south(SIZE, &plan.scenes[0].scene), name)?;
    panels.show(sheet)?;
    let rows: Vec<Vec<String>> = panels.errors(&panels.truth)?.into_iter().map(Vec::from).collect();
    sheet.table(&["", "RMSE / level", "bias / level"], &rows);
    sheet.note("The paper adds a colour by height, which has no part in shadows.");
    Ok(())
}
