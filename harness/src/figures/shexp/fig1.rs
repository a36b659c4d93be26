//! Fig. 1: SHEXP and ambient occlusion beside the ray-traced picture.

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::figures::seeing::{alone, beside, direct};
use crate::ledger::Bench;
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig1",
    place: "Ren et al. 2006, Fig. 1",
    shows: "ray traced, SHEXP accumulated at orders 4 and 6, ambient occlusion; light of order 4",
    look: "Ambient occlusion darkens alike on all sides of what touches the ground; the directed shadows of the traced picture are in both \
           SHEXP pictures, and sharper at order 6.",
    make,
};

const SCENES: [&str; 2] = ["spheres-60", "dino-elephant-courtyard"];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    for name in SCENES {
        let scene = halflight_scenes::find(name)?;
        let question = direct(&scene, 0);
        let asked = bench.ask(&question)?;
        let traced = asked.traced("sh-light:4")?;
        let four = asked.shaded("shexp/hyb", &[("order", "4")])?;
        let six = asked.shaded("shexp/hyb", &[("order", "4"), ("extra-bands", "2")])?;
        let ambient = asked.shaded("ambient-occlusion/elements", &[])?;
        sheet.heading(name);
        sheet.pictures(&[
            alone("ray traced", &traced),
            beside("SHEXP, n = 4", &four, &traced)?,
            beside("SHEXP, n = 6", &six, &traced)?,
            beside("ambient occlusion", &ambient, &traced)?,
        ])?;
    }
    claim(bench, sheet, "S11")
}
