//! Table 1: rates, and what decides them.

use super::panels::planned;
use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::figures::sequence::times::{times, told};
use crate::ledger::{Bench, Setting, swaying};
use halflight_reports::Sheet;
use std::sync::Arc;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/table1",
    place: "Snyder and Nowrouzezahrai 2008, Table 1",
    shows: "rates of terrains of 256 to 1024 vertices a side, key light alone and with a sky; sizes, wedge tables, azimuths",
    look: "The pyramid is built at once and looked up long; the sweep takes its time in `update`. Four times the vertices take four to five times \
           the time.",
    make,
};

/// Frames of each cell, after one that is not counted.
const FRAMES: usize = 4;

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let plan = planned("paper/hw-table1")?;
    let mut rows = Vec::new();
    for group in &plan.groups {
        let scene = &plan.scenes[group.scene].scene;
        let setting = Setting { method: group.method, params: group.params.clone() };
        let both = swaying(scene);
        let frames = both.iter().cycle().take(1 + FRAMES).map(Arc::as_ref);
        let [mut update, mut shade] = times(bench, scene, &setting, frames)?;
        for phase in [&mut update, &mut shade] {
            phase.remove(0);
        }
        let [update, _] = told(&update)?;
        let [shade, _] = told(&shade)?;
        rows.push(vec![format!("{}, {}", scene.name, group.method.info().id), update, shade]);
    }
    sheet.heading("Phases");
    sheet.table(&["", "update, ms", "shade, ms"], &rows);
    sheet.note(&format!(
        "Medians of {FRAMES} frames, all heights other in each, one after the other on {} threads: `update` builds the pyramid or sweeps, \
         `shade` finds horizons and sums wedges at every vertex. The rates below are taken in turns.",
        rayon::current_num_threads()
    ));
    ["H1", "H2", "H3", "H7"].iter().try_for_each(|id| claim(bench, sheet, id))
}
