//! Fig. 9: reconstruction.

use super::panels::{Panels, level, planned, roughness};
use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::ledger::{Bench, number};
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/fig9",
    place: "Snyder and Nowrouzezahrai 2008, Fig. 9",
    shows: "reconstruction linear or by B-splines between scales, bilinear or by B-splines in the plane; k = 4, o = 1, a swath of 20°",
    look: "B-splines in the plane give the smoothest shadows, those between scales add little, and what is smoother is no nearer to the traced \
           picture. Most of the terrain's roughness is of its normals, which all have; the ledger's row is about horizons alone.",
    make,
};

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let plan = planned("paper/hw-fig9")?;
    for (index, stage) in plan.scenes.iter().enumerate() {
        let name = |group: &crate::plan::Group| {
            format!("{} in scale, {} in the plane", group.params.choice("scale"), group.params.choice("plane"))
        };
        let mut panels = Panels::new(bench, &plan, index, &stage.scene, name)?;
        // The paper's order: its choice comes last.
        panels.cells.reverse();
        sheet.heading(&stage.scene.name);
        panels.show(sheet)?;
        let mut rows = vec![vec!["ray traced".into(), number(roughness(&panels.truth) / level(&panels.truth))]];
        for ([name, rmse, bias], rough) in panels.errors(&panels.truth)?.into_iter().zip(panels.roughness()) {
            rows.push(vec![name, rough, rmse, bias]);
        }
        sheet.table(&["", "roughness / level", "RMSE / level", "bias / level"], &rows);
    }
    sheet.note("Roughness: root mean square second difference along rows of the picture. All over the traced picture's mean level.");
    claim(bench, sheet, "H5")
}
