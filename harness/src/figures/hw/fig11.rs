//! Fig. 11: kinds of light.

use super::panels::{Panels, from_south, planned};
use crate::Error;
use crate::figures::Figure;
use crate::ledger::Bench;
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/fig11",
    place: "Snyder and Nowrouzezahrai 2008, Fig. 11",
    shows: "a fractal terrain of 512 × 512 vertices under a key light, a sky, and both",
    look: "The key light draws the forms, the sky darkens hollows, and both together have the sky in the key light's shadows. A light of order 4 is \
           broader over elevation than this key light, so that it reaches into shadows; under the sky the method is all but the traced picture.",
    make,
};

const SIZE: [usize; 2] = [400, 200];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let plan = planned("paper/hw-fig11")?;
    for (index, stage) in plan.scenes.iter().enumerate() {
        let panels =
            Panels::new(bench, &plan, index, &from_south(SIZE, &stage.scene), |_| "pyramid, k = 4, o = 2".into())?;
        sheet.heading(match &stage.scene.name[..] {
            "fractal-512-key" => "Key light",
            "fractal-512-sky" => "Sky",
            _ => "Key light and sky",
        });
        panels.show(sheet)?;
        let rows: Vec<Vec<String>> = panels.errors(&panels.truth)?.into_iter().map(Vec::from).collect();
        sheet.table(&["", "RMSE / level", "bias / level"], &rows);
    }
    Ok(())
}
