//! Characters in motion: error a frame, popping, and the time that a frame takes.

mod changes;
mod rates;
mod track;

use crate::Error;
use crate::budget::{Seen, apart};
use crate::figures::Figure;
use crate::figures::seeing::with_error;
use crate::ledger::{Bench, Setting, number};
use changes::{Change, bends, changes, pops};
use halflight_reports::{Axis, Mark, Plot, Series, Sheet};
use track::Track;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/sequences",
    place: "Ren et al. 2006, §9",
    shows: "captured characters over 60 frames: error a frame, its change from frame to frame, popping, update and shading time",
    look: "The error changes with the motion, not by itself: no frame lies off its neighbours more than the usual few times, but the \
           planted one, which has another sphere set. Most of the error is that light in SH makes shadows soft.",
    make,
};

/// Scene and frames a second: the whole capture at the scene's rate, and its first half second at the capture's own.
const SEQUENCES: [(&str, f32); 3] = [("walker", 24.0), ("walker", 120.0), ("boxers", 100.0)];
const FRAMES: usize = 60;
/// Receivers a side of the ground, and on the skin of each character.
const GROUND: usize = 20;
const SKIN: usize = 300;
/// Where a sphere set of another size is planted.
const PLANTED: usize = 30;
const METHODS: [(&str, &[(&str, &str)]); 2] =
    [("hyb", &[("spheres", "64")]), ("hyb, cut=20", &[("spheres", "64"), ("cut", "20"), ("cluster", "64")])];
const OTHER: &[(&str, &str)] = &[("spheres", "63")];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    sheet.note(&format!(
        "Receivers: {GROUND}×{GROUND} of the ground about the characters, and about {SKIN} vertices of each that go with its skin; albedo 1. \
         e_t is the radiance of frame t less the ray-traced truth's; its noise is taken out of all root mean squares. The bend of a frame is how \
         far it lies from the middle of its neighbours; a pop bends {} times as much as the {} frames around in the median. No glTF clip is \
         shipped: captures (BVH) alone.",
        changes::FACTOR,
        2 * changes::WINDOW
    ));
    SEQUENCES.iter().try_for_each(|(name, rate)| sequence(bench, sheet, name, *rate))?;
    rates::rates(bench, sheet)
}

fn sequence(bench: &Bench, sheet: &mut Sheet, name: &str, rate: f32) -> Result<(), Error> {
    let track = Track::new(name, rate, FRAMES, GROUND, SKIN)?;
    let truth = track.truth(bench)?;
    let mut runs = Vec::new();
    for (name, settings) in METHODS {
        runs.push((name, track.shaded(bench, &Setting::new("shexp/hyb", settings)?)?));
    }
    let mut planted = runs[0].1.clone();
    planted[PLANTED] = track.shaded(bench, &Setting::new("shexp/hyb", OTHER)?)?.swap_remove(PLANTED);

    sheet.heading(&format!("{name}, {rate} frames a second"));
    let (mut table, mut errors, mut moves) = (Vec::new(), Vec::new(), Vec::new());
    for (place, of) in [("ground", true), ("skin", false)] {
        let truth = track.part(&truth, of);
        for (name, run) in &runs {
            let (name, run) = (format!("{place}: {name}"), track.part(run, of));
            let changes = changes(&run, &truth);
            table.push(row(&name, &run, &truth, &changes)?);
            errors.push(frames(&name, &distances(&run, &truth)?.iter().map(|d| d.rmse).collect::<Vec<_>>(), 0));
            moves.push(frames(&name, &changes.iter().map(|change| change.error).collect::<Vec<_>>(), 1));
            if name.ends_with("cut=20") {
                let own: Vec<f64> = changes.iter().map(|change| change.truth).collect();
                moves.push(Series { mark: Mark::Dashed, ..frames(&format!("{place}: truth itself"), &own, 1) });
            }
        }
    }
    sheet.table(
        &[
            "",
            "mean of truth",
            "RMSE, mean",
            "largest",
            "bias, mean",
            "change of e: RMS, largest",
            "of truth, there",
            "of one receiver",
            "of truth",
        ],
        &table,
    );
    let bent: Vec<(&str, Vec<f64>)> = runs
        .iter()
        .map(|(name, run)| (*name, bends(run)))
        .chain([("hyb, planted", bends(&planted)), ("truth", bends(&truth))])
        .collect();
    sheet.table(
        &["", "bend, median", "bend, largest", "pops at frames"],
        &bent.iter().map(|(n, b)| popping(n, b)).collect::<Vec<_>>(),
    );
    let plot = |title: &str, series| {
        let (across, upwards) = (Axis::linear("frame"), Axis::linear("radiance"));
        Plot { title: title.into(), across, upwards, series }
    };
    sheet.plot(&plot("Error of each frame against the truth, RMSE", errors))?;
    sheet.plot(&plot("Change of the error from the frame before, root mean square", moves))?;
    let bent = bent.iter().map(|(name, bends)| frames(name, bends, 1)).collect();
    Ok(sheet.plot(&plot("Bend: distance of a frame from the middle of its neighbours, root mean square", bent))?)
}

/// A value a frame, from a first one on.
fn frames(name: &str, values: &[f64], first: usize) -> Series {
    Series::new(name, Mark::Line, values.iter().enumerate().map(|(t, value)| ((t + first) as f64, *value)))
}

fn distances(run: &[Seen], truth: &[Seen]) -> Result<Vec<halflight_metrics::Difference>, Error> {
    run.iter().zip(truth).map(|(run, truth)| apart(run, truth)).collect()
}

fn row(name: &str, run: &[Seen], truth: &[Seen], changes: &[Change]) -> Result<Vec<String>, Error> {
    let apart = distances(run, truth)?;
    let count = apart.len() as f64;
    let mean = |of: fn(&halflight_metrics::Difference) -> f64| apart.iter().map(of).sum::<f64>() / count;
    let error =
        |of: fn(&halflight_metrics::Difference) -> f64| apart.iter().map(|d| of(d).powi(2)).sum::<f64>().sqrt() / count;
    let level = |seen: &Seen| f64::from(seen.picture.radiance.iter().map(|v| v.element_sum()).sum::<f32>()) / 3.0;
    let receivers = count * truth.first().map_or(1.0, |seen| seen.variance.len() as f64);
    let worst = apart.iter().max_by(|a, b| a.rmse.total_cmp(&b.rmse));
    let largest = changes.iter().max_by(|a, b| a.error.total_cmp(&b.error)).copied().unwrap_or_default();
    let most = |of: fn(&Change) -> f64| changes.iter().map(of).fold(0.0, f64::max);
    Ok(vec![
        name.to_owned(),
        number(truth.iter().map(level).sum::<f64>() / receivers),
        with_error(mean(|d| d.rmse), error(|d| d.rmse_error)),
        worst.map_or("–".into(), |d| with_error(d.rmse, d.rmse_error)),
        with_error(mean(|d| d.bias), error(|d| d.bias_error)),
        number(largest.error),
        number(largest.truth),
        number(most(|change| change.worst)),
        number(most(|change| change.worst_truth)),
    ])
}

fn popping(name: &str, bends: &[f64]) -> Vec<String> {
    let median = halflight_metrics::median(bends).unwrap_or(f64::NAN);
    let frames: Vec<String> = pops(bends).iter().map(ToString::to_string).collect();
    let frames = if frames.is_empty() { "none".into() } else { frames.join(", ") };
    vec![name.to_owned(), number(median), number(bends.iter().copied().fold(0.0, f64::max)), frames]
}
