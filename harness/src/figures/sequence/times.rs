//! What a frame of a sequence costs: `update`, which all motion forces, apart from shading.

use crate::Error;
use crate::execute::{evaluate, prepare_once, update};
use crate::ledger::{Bench, Setting, number, silent};
use crate::recorder::{Recorded, Recorder};
use halflight_metrics::{median_interval, percentile};
use halflight_results::Key;
use halflight_scenes::{Frame, Rgb, Scene};
use std::time::Instant;

/// Milliseconds of `update` and of shading, an entry a frame, after one `prepare`.
pub(in crate::figures) fn times<'a>(
    bench: &Bench,
    scene: &Scene,
    setting: &Setting,
    frames: impl Iterator<Item = &'a Frame>,
) -> Result<[Vec<f64>; 2], Error> {
    let failed = |error: String| setting.failed(scene, &error);
    let task = bench.task(scene, setting.method, &setting.params);
    let mut ready = prepare_once(&task, &Key::of_bytes(b"no cell"), &mut silent).map_err(failed)?;
    let mut times = [Vec::new(), Vec::new()];
    for frame in frames {
        let (mut recorded, mut quiet) = (Recorded::default(), silent);
        let mut recorder = Recorder::new(&mut quiet);
        let mut radiance = vec![Rgb::ZERO; frame.receivers.len()];
        let start = Instant::now();
        update(&mut ready, frame, &mut recorder, &mut recorded).map_err(failed)?;
        times[0].push(1e3 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        evaluate(&task, ready.method.as_mut(), frame, &mut recorder, &mut recorded, &mut radiance).map_err(failed)?;
        times[1].push(1e3 * start.elapsed().as_secs_f64());
    }
    Ok(times)
}

/// The median with its 95% interval, and the 95th percentile.
pub(in crate::figures) fn told(times: &[f64]) -> Result<[String; 2], Error> {
    let found = median_interval(times).ok_or_else(|| Error::Other("no frames".into()))?;
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let high = percentile(&sorted, 95.0).unwrap_or(f64::NAN);
    Ok([format!("{} ({} to {})", number(found.median), number(found.low), number(found.high)), number(high)])
}
