//! What a frame of a sequence costs: `update`, which all motion forces, apart from shading.

use super::FRAMES;
use crate::Error;
use crate::execute::{evaluate, prepare_once, update};
use crate::ledger::{Bench, Setting, number, silent};
use crate::recorder::{Recorded, Recorder};
use halflight_metrics::{median_interval, percentile};
use halflight_reports::{Axis, Mark, Plot, Series, Sheet};
use halflight_results::Key;
use halflight_scenes::Rgb;
use std::time::Instant;

const SCENES: [&str; 2] = ["walker", "boxers"];
const METHODS: [(&str, &[(&str, &str)]); 2] =
    [("hyb", &[("spheres", "64")]), ("hyb, cut=20, clusters of 256", &[("spheres", "64"), ("cut", "20")])];

/// Milliseconds of every frame of the scenes as they are shipped, receivers in the camera's pixels.
pub(super) fn rates(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    sheet.heading("Time of a frame");
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    for scene in SCENES {
        for (name, settings) in METHODS {
            let (receivers, times) = times(bench, scene, &Setting::new("shexp/hyb", settings)?)?;
            let mut row = vec![format!("{scene}: {name}"), receivers.to_string()];
            for (phase, times) in ["update", "shade"].into_iter().zip(&times) {
                let found = median_interval(times).ok_or_else(|| Error::Other("no frames".into()))?;
                let mut sorted = times.clone();
                sorted.sort_by(f64::total_cmp);
                let high = percentile(&sorted, 95.0).unwrap_or(f64::NAN);
                row.push(format!("{} ({} to {})", number(found.median), number(found.low), number(found.high)));
                row.push(number(high));
                let points = times.iter().enumerate().map(|(t, time)| (t as f64, *time));
                series.push(Series::new(format!("{scene}, {name}: {phase}"), Mark::Line, points));
            }
            rows.push(row);
        }
    }
    let columns = ["", "receivers", "update, ms", "95th percentile", "shade, ms", "95th percentile"];
    sheet.table(&columns, &rows);
    sheet.note(&format!(
        "Medians over {FRAMES} frames with their 95% interval, on {} threads; update poses spheres and rebuilds what cuts need.",
        rayon::current_num_threads()
    ));
    let upwards = Axis { logarithmic: true, ..Axis::linear("ms") };
    Ok(sheet.plot(&Plot { title: "Time of each frame".into(), across: Axis::linear("frame"), upwards, series })?)
}

/// Receivers a frame, and milliseconds of `update` and of shading.
fn times(bench: &Bench, scene: &str, setting: &Setting) -> Result<(usize, [Vec<f64>; 2]), Error> {
    let scene = halflight_scenes::find(scene)?;
    let failed = |error: String| setting.failed(&scene, &error);
    let task = bench.task(&scene, setting.method, &setting.params);
    let mut ready = prepare_once(&task, &Key::of_bytes(b"no cell"), &mut silent).map_err(failed)?;
    let (mut times, mut receivers) = ([Vec::new(), Vec::new()], 0);
    for index in 0..FRAMES.min(scene.frame_count) {
        let frame = scene.frame(index);
        receivers = frame.receivers.len();
        let (mut recorded, mut quiet) = (Recorded::default(), silent);
        let mut recorder = Recorder::new(&mut quiet);
        let mut radiance = vec![Rgb::ZERO; receivers];
        let start = Instant::now();
        update(&mut ready, &frame, &mut recorder, &mut recorded).map_err(failed)?;
        times[0].push(1e3 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        evaluate(&task, ready.method.as_mut(), &frame, &mut recorder, &mut recorded, &mut radiance).map_err(failed)?;
        times[1].push(1e3 * start.elapsed().as_secs_f64());
    }
    Ok((receivers, times))
}
