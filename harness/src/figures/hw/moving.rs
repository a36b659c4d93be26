//! Height fields in motion: error a frame, popping, and the time that a frame takes.

use crate::Error;
use crate::budget::Seen;
use crate::budget::chain::What;
use crate::execute::Runner;
use crate::figures::Figure;
use crate::figures::seeing::{alone, beside, direct};
use crate::figures::sequence::changes::{self, bends, changes};
use crate::figures::sequence::tables::{CHANGES, changes_of, distances, errors_of, popping};
use crate::figures::sequence::times::{times, told};
use crate::figures::sequence::{frames, plot};
use crate::ledger::{Bench, Setting, silent};
use crate::probe::Question;
use halflight_references::Reference;
use halflight_reports::{Axis, Mark, Plot, Series, Sheet};
use halflight_scenes::{Frame, Rgb, Scene};

pub(super) const FIGURE: Figure = Figure {
    id: "hw/moving",
    place: "Snyder and Nowrouzezahrai 2008, §7",
    shows: "waves that run and hills that grow: error a frame, its change from frame to frame, popping, update and shading time",
    look: "Errors follow the motion: from frame to frame they change by a third to two thirds of what the truth does, and nothing pops but the frame \
           that is planted. Levels of the pyramid do not jump, since each is a filter of the whole field. `update` costs the pyramid or the sweep \
           where heights change, and nothing where hills have ceased to grow.",
    make,
};

/// Scene, frames, and how many there are from one that is shown to the next.
const SEQUENCES: [(&str, usize, usize); 2] = [("ripples", 24, 5), ("growing", 20, 3)];
const RATE: f32 = 24.0;
const SHOWN: usize = 4;
const METHODS: [(&str, &str); 3] = [
    ("pyramid", "horizon-wedges/partial"),
    ("march of 145", "horizon-wedges/march"),
    ("exact sweep", "horizon-wedges/sweep"),
];
/// Where a frame by another level offset is planted.
const PLANTED: usize = 6;
const OTHER: &[(&str, &str)] = &[("offset", "0.5")];
/// Scenes whose frames are timed.
const TIMED: [&str; 2] = ["waves", "growing"];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    sheet.note(&format!(
        "Receivers: all vertices. e_t is the radiance of frame t less the ray-traced truth's; its noise is taken out of all root mean squares. The \
         bend of a frame is how far it lies from the middle of its neighbours; a pop bends {} times as much as the {} frames around in the \
         median, and surely more than the truth does there. Where the truth's is 0, it is below its noise. The planted frame has a level offset of half an \
         octave in place of two.",
        changes::FACTOR,
        2 * changes::WINDOW
    ));
    for (name, count, every) in SEQUENCES {
        let scene = Scene { frame_count: count, fps: RATE, ..halflight_scenes::find(name)? }.as_changed();
        sheet.heading(&format!("{name}, {RATE} frames a second"));
        sequence(bench, sheet, &scene, every)?;
    }
    rates(bench, sheet)
}

fn sequence(bench: &Bench, sheet: &mut Sheet, scene: &Scene, every: usize) -> Result<(), Error> {
    let truth = traced(bench, scene)?;
    let mut runs = Vec::new();
    for (name, method) in METHODS {
        runs.push((name, shaded(bench, scene, &Setting::new(method, &[])?)?));
    }
    strip(sheet, &truth, &runs, every)?;
    let (mut table, mut moved) = (Vec::new(), Vec::new());
    let (mut errors, mut moves) = (Vec::new(), Vec::new());
    for (name, run) in &runs {
        let changes = changes(run, &truth);
        table.push(errors_of(name, run, &truth)?);
        moved.push(changes_of(name, &changes));
        errors.push(frames(name, &distances(run, &truth)?.iter().map(|d| d.rmse).collect::<Vec<_>>(), 0));
        moves.push(frames(name, &changes.iter().map(|change| change.error).collect::<Vec<_>>(), 1));
        if moves.len() == METHODS.len() {
            let own: Vec<f64> = changes.iter().map(|change| change.truth).collect();
            moves.push(Series { mark: Mark::Dashed, ..frames("truth itself", &own, 1) });
        }
    }
    sheet.table(&["", "mean of truth", "RMSE, mean over frames", "RMSE, largest", "bias, mean"], &table);
    sheet.table(&CHANGES, &moved);

    let mut planted = runs[0].1.clone();
    planted[PLANTED] = shaded(bench, scene, &Setting::new(METHODS[0].1, OTHER)?)?.swap_remove(PLANTED);
    runs.push(("pyramid, planted", planted));
    runs.push(("truth", truth));
    let bent: Vec<_> = runs.iter().map(|(name, run)| (*name, bends(run))).collect();
    let own = bends(&runs[runs.len() - 1].1);
    let rows: Vec<_> = bent.iter().map(|(name, bends)| popping(name, bends, &own)).collect();
    sheet.table(&["", "bend, median", "bend, largest", "pops at frames"], &rows);
    sheet.plot(&plot("Error of each frame against the truth, RMSE", errors))?;
    sheet.plot(&plot("Change of the error from the frame before, root mean square", moves))?;
    let sizes = bent.iter().map(|(name, bends)| frames(name, &bends.iter().map(|b| b.size).collect::<Vec<_>>(), 1));
    let title = "Bend: distance of a frame from the middle of its neighbours, root mean square";
    Ok(sheet.plot(&plot(title, sizes.collect()))?)
}

/// Some frames of the truth, and under them those of the methods.
fn strip(sheet: &mut Sheet, truth: &[Seen], runs: &[(&str, Vec<Seen>)], every: usize) -> Result<(), Error> {
    let chosen = || (1..=SHOWN).map(|i| i * every);
    let mut shown: Vec<_> = chosen().map(|t| alone(format!("ray traced, frame {t}"), &truth[t])).collect();
    for (name, run) in runs {
        for t in chosen() {
            shown.push(beside(format!("{name}, frame {t}"), &run[t], &truth[t])?);
        }
    }
    Ok(sheet.pictures(&shown)?)
}

/// The truth at every frame, the noise of each independent of the others'.
fn traced(bench: &Bench, scene: &Scene) -> Result<Vec<Seen>, Error> {
    let traced = |index: usize| {
        let question = Question { seed: 1 + index as u64, ..direct(scene, index) };
        bench.ask(&question)?.see(&What::Reference(Reference::TRUTH), &mut silent)
    };
    (0..scene.frame_count).map(traced).collect()
}

/// A method at every frame, prepared once.
fn shaded(bench: &Bench, scene: &Scene, setting: &Setting) -> Result<Vec<Seen>, Error> {
    let mut runner = Runner::new(bench.task(scene, setting.method, &setting.params));
    let shade = |index| {
        let frame = scene.frame(index);
        let shaded = runner.picture(&frame, &mut silent).map_err(|error| setting.failed(scene, &error))?;
        let (valid, layout) = (frame.receivers.valid.clone(), crate::score::layout(&frame.receivers));
        let variance = vec![Rgb::ZERO; shaded.radiance.len()];
        let picture = halflight_results::Picture { layout, radiance: shaded.radiance, valid };
        Ok(Seen { picture, variance })
    };
    (0..scene.frame_count).map(shade).collect()
}

fn rates(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    sheet.heading("Time of a frame");
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    for name in TIMED {
        let scene = halflight_scenes::find(name)?;
        let all: Vec<Frame> = (0..scene.frame_count).map(|index| scene.frame(index)).collect();
        let stands: Vec<bool> = (0..all.len()).map(|t| t > 0 && same(&all[t - 1], &all[t])).collect();
        for (method, id) in METHODS {
            let times = times(bench, &scene, &Setting::new(id, &[])?, all.iter())?;
            for (what, which) in [("", false), (", field as before", true)] {
                let of = |times: &[f64]| -> Vec<f64> {
                    times.iter().zip(&stands).filter(|(_, stands)| **stands == which).map(|(time, _)| *time).collect()
                };
                if stands.contains(&which) {
                    let mut row = vec![format!("{name}: {method}{what}"), scene.facts().receivers.to_string()];
                    row.extend(told(&of(&times[0]))?.into_iter().chain(told(&of(&times[1]))?));
                    rows.push(row);
                }
            }
            for (phase, times) in ["update", "shade"].into_iter().zip(&times) {
                let points = times.iter().enumerate().map(|(t, time)| (t as f64, *time));
                series.push(Series::new(format!("{name}, {method}: {phase}"), Mark::Line, points));
            }
        }
    }
    let columns = ["", "receivers", "update, ms", "95th percentile", "shade, ms", "95th percentile"];
    sheet.table(&columns, &rows);
    sheet.note(&format!(
        "Medians over the shipped frames with their 95% interval, on {} threads. `update` makes the pyramid or sweeps, and finds nothing to do \
         where the field is as in the frame before.",
        rayon::current_num_threads()
    ));
    let upwards = Axis { logarithmic: true, ..Axis::linear("ms") };
    Ok(sheet.plot(&Plot { title: "Time of each frame".into(), across: Axis::linear("frame"), upwards, series })?)
}

/// Whether all objects are as they were.
fn same(before: &Frame, after: &Frame) -> bool {
    before.objects.iter().zip(&after.objects).all(|(before, after)| before.revision == after.revision)
}
