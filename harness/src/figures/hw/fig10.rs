//! Fig. 10: the pyramid against its ground truth.

use super::panels::{Panels, planned};
use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::ledger::Bench;
use crate::plan::Group;
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/fig10",
    place: "Snyder and Nowrouzezahrai 2008, Fig. 10",
    shows: "(k, o) = (1, 1), (2, 2), (4, 4), (8, 8) on 512 × 512 vertices beside the march of 145 samples, the exact sweep and the traced picture",
    look: "As k and o grow, the picture becomes that of exact horizons. It comes no nearer to the traced one: what is left there is of the light of \
           order 4, which is broader than the key light.",
    make,
};

fn name(group: &Group) -> String {
    match group.method.info().id {
        "horizon-wedges/march" => "march of 145 samples".into(),
        "horizon-wedges/sweep" => "exact sweep".into(),
        _ => format!("(k, o) = ({}, {})", group.params.int("levels"), group.params.float("offset")),
    }
}

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let plan = planned("paper/hw-fig10")?;
    let panels = Panels::new(bench, &plan, 0, &plan.scenes[0].scene, name)?;
    panels.show(sheet)?;
    let missing = || Error::Other("paper/hw-fig10: expected the exact sweep".into());
    let (_, sweep) = panels.cells.iter().find(|(name, _)| name == "exact sweep").ok_or_else(missing)?;
    let (truth, exact) = (panels.errors(&panels.truth)?, panels.errors(sweep)?);
    let rows = truth
        .into_iter()
        .zip(exact)
        .map(|([name, rmse, bias], [_, own, own_bias])| vec![name, rmse, bias, own, own_bias]);
    let columns = ["", "RMSE against the truth / level", "bias", "RMSE against the sweep / level", "bias"];
    sheet.table(&columns, &rows.collect::<Vec<_>>());
    sheet.note(
        "Against the truth all have in common what light and visibility of order 4 leave out; against the sweep, whose wedges are the same, \
         only horizons differ.",
    );
    claim(bench, sheet, "H4")
}
