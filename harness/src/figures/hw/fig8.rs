//! Fig. 8: a terrain of 1024 × 1024 vertices.

use super::panels::{Panels, from_south, planned};
use crate::Error;
use crate::budget::apart;
use crate::figures::Figure;
use crate::figures::seeing::{alone, beside, direct};
use crate::ledger::Bench;
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

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let plan = planned("paper/hw-fig8")?;
    let scene = from_south(SIZE, &plan.scenes[0].scene);
    let panels = Panels::new(bench, &plan, 0, &scene, |_| "pyramid, k = 4, o = 2".into())?;
    let question = direct(&scene, 0);
    let sweep = bench.ask(&question)?.shaded("horizon-wedges/sweep", &[])?;
    let [(name, pyramid)] = &panels.cells[..] else {
        return Err(Error::Other("paper/hw-fig8: expected one cell".into()));
    };
    sheet.pictures(&[
        alone("ray traced", &panels.truth),
        beside(name.clone(), pyramid, &panels.truth)?,
        beside("exact sweep", &sweep, &panels.truth)?,
    ])?;
    let between = apart(pyramid, &sweep)?;
    sheet.note(&format!(
        "The paper adds a colour by height, which has no part in shadows. Pyramid against sweep, wedges alike: RMSE {:.3}, bias {:.3}.",
        between.rmse, between.bias
    ));
    Ok(())
}
