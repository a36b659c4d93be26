//! Fig. 10: scenes of many moving blockers.

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::figures::seeing::{alone, direct};
use crate::ledger::{Bench, Setting, number};
use halflight_metrics::median;
use halflight_reports::{Sheet, Shown};

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig10",
    place: "Ren et al. 2006, Fig. 10",
    shows: "scenes of the sizes of battle and dino: HYB by cuts, order 4, windowed",
    look: "Soft shadows of characters on one another and on the ground, without ringing; seams between clusters are below what the eye \
           sees (row S10); the print shows its frames at 23.2 and 22.4 Hz of an NVidia 7800GTX.",
    make,
};

/// Scene, spheres an object, what to call it.
const SCENES: [(&str, &str, &str); 2] = [("battle", "61", "battle size"), ("herd", "32", "dino size")];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    for (name, spheres, called) in SCENES {
        let scene = halflight_scenes::find(name)?;
        let settings = [("spheres", spheres), ("cut", "25"), ("window-light", "true"), ("window-visibility", "true")];
        let setting = Setting::new("shexp/hyb", &settings)?;
        let question = direct(&scene, 0);
        let asked = bench.ask(&question)?;
        let seen = asked.shaded("shexp/hyb", &settings)?;
        let times = bench.interleaved(&mut [bench.framing(&scene, &asked.frame, &setting)?])?;
        let time = median(&times[0]).unwrap_or(f64::NAN);
        let caption = format!(
            "{} receivers, updated and shaded in {} ms ({} Hz) on {} threads",
            asked.frame.receivers.len(),
            number(1e-6 * time),
            number(1e9 / time),
            rayon::current_num_threads()
        );
        sheet.pictures(&[Shown { caption, ..alone(called, &seen) }])?;
    }
    claim(bench, sheet, "S9")
}
