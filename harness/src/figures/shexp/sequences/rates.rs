//! What a frame of the characters costs.

use super::FRAMES;
use crate::Error;
use crate::figures::sequence::times::{times, told};
use crate::ledger::{Bench, Setting};
use halflight_reports::{Axis, Mark, Plot, Series, Sheet};
use halflight_scenes::Frame;

const SCENES: [&str; 2] = ["walker", "boxers"];
const METHODS: [(&str, &[(&str, &str)]); 2] =
    [("hyb", &[("spheres", "64")]), ("hyb, cut=20, clusters of 256", &[("spheres", "64"), ("cut", "20")])];

/// Milliseconds of every frame of the scenes as they are shipped, receivers in the camera's pixels.
pub(super) fn rates(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    sheet.heading("Time of a frame");
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    for name in SCENES {
        let scene = halflight_scenes::find(name)?;
        let frames: Vec<Frame> = (0..FRAMES.min(scene.frame_count)).map(|index| scene.frame(index)).collect();
        let receivers = frames.last().map_or(0, |frame| frame.receivers.len());
        for (method, settings) in METHODS {
            let times = times(bench, &scene, &Setting::new("shexp/hyb", settings)?, frames.iter())?;
            let mut row = vec![format!("{name}: {method}"), receivers.to_string()];
            for (phase, times) in ["update", "shade"].into_iter().zip(&times) {
                row.extend(told(times)?);
                let points = times.iter().enumerate().map(|(t, time)| (t as f64, *time));
                series.push(Series::new(format!("{name}, {method}: {phase}"), Mark::Line, points));
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
