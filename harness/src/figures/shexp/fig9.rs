//! Fig. 9: exponentials against the product.

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::figures::seeing::{alone, beside, direct, from_above};
use crate::ledger::Bench;
use glam::Vec3;
use halflight_reports::Sheet;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig9",
    place: "Ren et al. 2006, Fig. 9",
    shows: "the ground under a bunny of 63 spheres by product, PS-p, OL, HYB and PS*-2, order 4, no window",
    look: "PS-21 and PS-22 burst in the umbra to opposite sides (row S8 has from which p on PS-p holds there). OL blurs the \
           umbra; HYB and PS*-2 match the product. The dots under the belly are in all of them: spheres poke through the ground there, and a \
           receiver below the middle of one is wholly covered (`shexp/fig5`).",
    make,
};

/// Name, method, settings.
type Row = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

/// The guard would hide what series do in the umbra.
const BURSTING: [Row; 2] = [
    ("PS-21", "shexp/ps", &[("p", "21"), ("guard", "false")]),
    ("PS-22", "shexp/ps", &[("p", "22"), ("guard", "false")]),
];
const METHODS: [Row; 4] = [
    ("PS-21, guarded", "shexp/ps", &[("p", "21")]),
    ("OL", "shexp/ol", &[("guard", "false")]),
    ("HYB", "shexp/hyb", &[("guard", "false")]),
    ("PS*-2", "shexp/ps-star", &[("p", "2"), ("guard", "false")]),
];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let scene = from_above("bunny-studio", Vec3::ZERO, 4.0, 128)?;
    let question = direct(&scene, 0);
    let asked = bench.ask(&question)?;
    let shaded = |method, settings: &[_]| asked.shaded(method, &[settings, &[("spheres", "63")]].concat());
    let all =
        |rows: &[Row]| rows.iter().map(|(_, method, settings)| shaded(method, settings)).collect::<Result<Vec<_>, _>>();
    let product = shaded("sh-product/ordered", &[("guard", "false")])?;
    let (bursting, seen) = (all(&BURSTING)?, all(&METHODS)?);
    let mut shown = vec![alone("product", &product)];
    shown.extend(BURSTING.iter().zip(&bursting).map(|((name, ..), seen)| alone(*name, seen)));
    sheet.pictures(&shown)?;
    shown.truncate(1);
    for ((name, ..), seen) in METHODS.iter().zip(&seen) {
        shown.push(beside(*name, seen, &product)?);
    }
    sheet.pictures(&shown)?;
    claim(bench, sheet, "S4")?;
    claim(bench, sheet, "S8")
}
