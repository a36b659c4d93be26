//! Characters in motion: error a frame, popping, and the time that a frame takes.

mod excess;
mod rates;
mod track;

use crate::Error;
use crate::budget::Seen;
use crate::figures::Figure;
use crate::figures::sequence::changes::{self, Bend, bends, changes};
use crate::figures::sequence::tables::{CHANGES, changes_of, distances, errors_of, popping};
use crate::figures::sequence::{frames, plot};
use crate::ledger::{Bench, Setting, number};
use halflight_reports::{Mark, Series, Sheet};
use track::Track;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/sequences",
    place: "Ren et al. 2006, §9",
    shows: "captured characters over 60 frames: error a frame, its change from frame to frame, popping, update and shading time",
    look: "The error changes from frame to frame about as much as the truth does. At the capture's rate a pop stands out, as the planted one does, \
           a frame with another sphere set; at 24 frames a second single steps of the walk bend a picture as much, so that what is told there is \
           a pop only if it is one at the capture's rate too: the walk is looked at where its step at 2.1 s is told.",
    make,
};

/// Scene, frames a second and the first frame: the whole walk at the scene's rate, half a second and more at the capture's own.
const SEQUENCES: [(&str, f32, usize); 3] = [("walker", 24.0, 0), ("walker", 120.0, 228), ("boxers", 100.0, 0)];
const FRAMES: usize = 60;
/// Spheres a body.
const SPHERES: usize = 64;
/// Receivers a side of the ground, and on the skin of each character.
const GROUND: usize = 20;
const SKIN: usize = 300;
/// Frames from one traced under the SH light to the next.
const SPARSE: usize = 10;
/// Where a sphere set of another size is planted: the walk at the capture's rate is calm there. Less than the truth bends is not told.
const PLANTED: usize = 50;
/// Clusters are small, since receivers here are few.
const METHODS: [(&str, &[(&str, &str)]); 2] =
    [("hyb", &[("spheres", "64")]), ("hyb, cut=20", &[("spheres", "64"), ("cut", "20"), ("cluster", "16")])];
const OTHER: &[(&str, &str)] = &[("spheres", "63")];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    sheet.note(&format!(
        "Receivers: {GROUND}×{GROUND} of the ground about the characters, and about {SKIN} vertices of each that go with its skin; albedo 1. \
         e_t is the radiance of frame t less the ray-traced truth's; its noise is taken out of all root mean squares. The bend of a frame is how \
         far it lies from the middle of its neighbours; a pop bends {} times as much as the {} frames around in the median, and surely more \
         than the truth does there. No glTF clip is shipped: captures (BVH) alone.",
        changes::FACTOR,
        2 * changes::WINDOW
    ));
    SEQUENCES.iter().try_for_each(|(name, rate, first)| sequence(bench, sheet, name, *rate, *first))?;
    excess::excess(bench, sheet)?;
    rates::rates(bench, sheet)
}

fn sequence(bench: &Bench, sheet: &mut Sheet, name: &str, rate: f32, first: usize) -> Result<(), Error> {
    let track = Track::new(name, rate, first..first + FRAMES, GROUND, SKIN)?;
    let (truth, light) = (track.traced(bench, "truth", 1)?, track.traced(bench, "sh-light:4", SPARSE)?);
    let mut runs = Vec::new();
    for (name, settings) in METHODS {
        runs.push((name, track.shaded(bench, &Setting::new("shexp/hyb", settings)?)?));
    }
    let mut planted = runs[0].1.clone();
    planted[PLANTED] = track.shaded(bench, &Setting::new("shexp/hyb", OTHER)?)?.swap_remove(PLANTED);

    sheet.heading(&format!("{name}, {rate} frames a second from frame {first}"));
    let (mut table, mut moved) = (Vec::new(), Vec::new());
    let (mut errors, mut moves) = (Vec::new(), Vec::new());
    for (place, of) in [("ground", true), ("skin", false)] {
        let truth = track.part(&truth, of);
        let sparse: Vec<Seen> = truth.iter().step_by(SPARSE).cloned().collect();
        table.push(errors_of(&format!("{place}: traced under the SH light"), &track.part(&light, of), &sparse)?);
        for (name, run) in &runs {
            let (name, run) = (format!("{place}: {name}"), track.part(run, of));
            let changes = changes(&run, &truth);
            table.push(errors_of(&name, &run, &truth)?);
            moved.push(changes_of(&name, &changes));
            errors.push(frames(&name, &distances(&run, &truth)?.iter().map(|d| d.rmse).collect::<Vec<_>>(), 0));
            moves.push(frames(&name, &changes.iter().map(|change| change.error).collect::<Vec<_>>(), 1));
            if name.ends_with("cut=20") {
                let own: Vec<f64> = changes.iter().map(|change| change.truth).collect();
                moves.push(Series { mark: Mark::Dashed, ..frames(&format!("{place}: truth itself"), &own, 1) });
            }
        }
    }
    sheet.table(&["", "mean of truth", "RMSE, mean over frames", "RMSE, largest", "bias, mean"], &table);
    sheet.table(&CHANGES, &moved);
    let cut = distances(&runs[1].1, &runs[0].1)?.iter().map(|d| d.rmse * d.rmse).sum::<f64>() / FRAMES as f64;
    let accumulated = METHODS.map(|(_, settings)| track.accumulated(bench, &Setting::new("shexp/hyb", settings)?));
    let [without, with] = accumulated;
    sheet.note(&format!(
        "Spheres accumulated a receiver in the first frame: {} without the cut, {} with it; what it changes, RMS over all receivers and \
         frames: {}.",
        number(without?),
        number(with?),
        number(cut.sqrt())
    ));
    let own = bends(&truth);
    let all = runs.iter().map(|(name, run)| (*name, bends(run)));
    let all: Vec<_> = all.chain([("hyb, planted", bends(&planted)), ("truth", own.clone())]).collect();
    let rows = all.iter().map(|(name, bends)| popping(name, bends, &own));
    sheet.table(&["", "bend, median", "bend, largest", "pops at frames"], &rows.collect::<Vec<_>>());
    sheet.plot(&plot("Error of each frame against the truth, RMSE", errors))?;
    sheet.plot(&plot("Change of the error from the frame before, root mean square", moves))?;
    let sizes = |bends: &[Bend]| bends.iter().map(|bend| bend.size).collect::<Vec<_>>();
    let bent = all.iter().map(|(name, bends)| frames(name, &sizes(bends), 1)).collect();
    Ok(sheet.plot(&plot("Bend: distance of a frame from the middle of its neighbours, root mean square", bent))?)
}
