//! H1 to H3: sizes of the pyramid, rates, and the time of wedge tables.

use super::super::bench::{Bench, Figure, Setting, Work, ratios, silent};
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use crate::execute::{evaluate, prepare_once, update};
use crate::recorder::{Recorded, Recorder};
use crate::sway::swayed;
use glam::Vec2;
use halflight_contract::Cache;
use halflight_horizons::{Azimuth, Horizons, Purpose, Pyramid, Settings, Storage};
use halflight_results::Key;
use halflight_scenes::{Frame, HeightField, Light, Rgb, Scene};
use std::sync::Arc;

const SIDES: [usize; 3] = [256, 512, 1024];

pub(crate) const H1: Row = Row {
    id: "H1",
    place: "Table 1 and §4",
    claim: "At 4 levels an octave the pyramid of a field of 256, 512, 1024 has 33, 37, 41 levels, and takes 3.4 times the field's memory",
    paper: &[
        ("levels, 256", "33"),
        ("levels, 512", "37"),
        ("levels, 1024", "41"),
        ("decimated pyramid over the field, 1024", "3.4×"),
    ],
    needs: "",
    measure: measure_sizes,
    judge: judge_sizes,
};

fn measure_sizes(_: &Bench) -> Result<Vec<Figure>, Error> {
    let figures = SIDES.iter().flat_map(|&side| {
        let field = HeightField::new([side, side], Vec2::ZERO, Vec2::ONE, vec![0.0; side * side]);
        let azimuth = Azimuth { angle: 0.0, purpose: Purpose::Key };
        let footprint = |storage| {
            let mut pyramid = Pyramid::new(Settings { storage, ..Settings::default() });
            pyramid.update(&field, &[azimuth]);
            let samples: usize =
                (0..pyramid.levels()).map(|level| pyramid.level_size(level).iter().product::<usize>()).sum();
            (pyramid.levels(), samples, pyramid.footprint())
        };
        let ((levels, samples, decimated), (.., full)) = (footprint(Storage::Decimated), footprint(Storage::Full));
        let (vertices, bytes) = ((side * side) as f64, (side * side * size_of::<f32>()) as f64);
        [
            Figure::exact(format!("levels, {side}"), "", levels as f64, 1),
            Figure::exact(format!("decimated pyramid over the field, {side}"), "×", samples as f64 / vertices, samples),
            Figure::exact(format!("bytes held over the field's, decimated, {side}"), "×", decimated as f64 / bytes, 1),
            Figure::exact(
                format!("bytes held over the field's, back-interpolated, {side}"),
                "×",
                full as f64 / bytes,
                1,
            ),
        ]
    });
    Ok(figures.collect())
}

fn judge_sizes(figures: &Figures<'_>) -> Option<Judgement> {
    let levels = figures.values(["levels, 256", "levels, 512", "levels, 1024"])?;
    let share = figures.value("decimated pyramid over the field, 1024")?;
    let full = figures.value("bytes held over the field's, back-interpolated, 1024")?;
    let why = format!(
        "The formula k·log2 n + 1 gives the printed counts; the samples of all levels are {} times the field's, by the series 1/(1 − 2^(−2/k)). \
         Brought back to the field's resolution, as the paper keeps it, a pyramid takes {} times the field.",
        number(share),
        number(full)
    );
    Some(Judgement { verdict: Verdict::of(&[levels == [33.0, 37.0, 41.0], (share - 3.4).abs() < 0.2]), why })
}

pub(crate) const H2: Row = Row {
    id: "H2",
    place: "Table 1",
    claim: "256, 512, 1024 vertices a side run at 165, 34.5, 7.05 Hz under a key light and at 57.2, 11.5, 2.48 Hz under a key light and an \
            environment: 4.6 to 5 times the time for 4 times the vertices, 2.9 times for the environment",
    paper: &[
        ("rate, key light, 256", "165 Hz"),
        ("rate, key light, 512", "34.5 Hz"),
        ("rate, key light, 1024", "7.05 Hz"),
        ("rate, key light and sky, 256", "57.2 Hz"),
        ("rate, key light and sky, 512", "11.5 Hz"),
        ("rate, key light and sky, 1024", "2.48 Hz"),
        ("time of both over key light alone, 256", "2.9×"),
        ("time of 512 over 256, key light", "4.8×"),
        ("time of 1024 over 512, key light", "4.9×"),
    ],
    needs: "",
    measure: measure_rates,
    judge: judge_rates,
};

const KEY: &str = "key light";
const BOTH: &str = "key light and sky";

/// A whole frame on a field that has changed: pyramid or sweep, horizons, shading at every vertex, and reading the result.
fn frames<'a>(bench: &'a Bench, scene: &'a Scene, setting: &'a Setting) -> Result<Work<'a>, Error> {
    let task = bench.task(scene, setting.method, &setting.params);
    let failed =
        |error: String| Error::Other(format!("{} failed on {}: {error}", setting.method.info().id, scene.name));
    let mut ready = prepare_once(&task, &Key::of_bytes(b"no cell"), &mut silent).map_err(failed)?;
    let mut turns = swaying(scene).into_iter().cycle();
    let mut radiance = vec![Rgb::ZERO; scene.frame(0).receivers.len()];
    Ok(Box::new(move || {
        let (mut recorded, mut silent, frame) = (Recorded::default(), silent, turns.next().expect("a cycle"));
        let mut recorder = Recorder::new(&mut silent);
        update(&mut ready, &frame, &mut recorder, &mut recorded).map_err(failed)?;
        evaluate(&task, ready.method.as_mut(), &frame, &mut recorder, &mut recorded, &mut radiance).map_err(failed)
    }))
}

/// The first frame, and one in which all heights differ.
pub(crate) fn swaying(scene: &Scene) -> [Arc<Frame>; 2] {
    let first = scene.frame(0);
    let second = swayed(&first).unwrap_or_else(|| first.clone());
    [first, second].map(Arc::new)
}

/// Its key lights alone.
fn keys(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.lights.retain(|light| matches!(light.rest, Light::Key(_)));
    scene
}

fn measure_rates(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let settings = [Setting::new("horizon-wedges/partial", &[])?, Setting::new("horizon-wedges/sweep", &[])?];
    let march = Setting::new("horizon-wedges/march", &[])?;
    let scenes = SIDES.map(|side| halflight_scenes::find(&format!("fractal-{side}")));
    let [small, middle, large] = scenes;
    let pairs = [small?, middle?, large?].map(|both| [keys(&both), both]);
    let mut works = Vec::new();
    for [key, both] in &pairs {
        for setting in &settings {
            works.push(frames(bench, key, setting)?);
            works.push(frames(bench, both, setting)?);
        }
    }
    works.push(frames(bench, &pairs[0][0], &march)?);
    let times = bench.interleaved(&mut works)?;
    let rate = |times: &[f64]| times.iter().map(|time| 1e9 / time).collect::<Vec<f64>>();
    let mut figures = Vec::new();
    for (side, times) in SIDES.iter().zip(times.chunks(4)) {
        let [key, both, sweep_key, sweep_both] = times else { break };
        figures.extend([
            Figure::median(format!("rate, {KEY}, {side}"), "Hz", &rate(key)),
            Figure::median(format!("rate, {BOTH}, {side}"), "Hz", &rate(both)),
            Figure::median(format!("time of both over key light alone, {side}"), "×", &ratios(both, key)),
            Figure::median(format!("sweep: rate, {KEY}, {side}"), "Hz", &rate(sweep_key)),
            Figure::median(format!("sweep: rate, {BOTH}, {side}"), "Hz", &rate(sweep_both)),
        ]);
    }
    for (to, from, at) in [(512, 256, 0), (1024, 512, 4)] {
        for (what, turn) in [(KEY, 0), (BOTH, 1)] {
            let growth = ratios(&times[at + 4 + turn], &times[at + turn]);
            figures.push(Figure::median(format!("time of {to} over {from}, {what}"), "×", &growth));
        }
    }
    figures.push(Figure::median(
        format!("march of 145 samples over pyramid, {KEY}, 256"),
        "×",
        &ratios(&times[12], &times[0]),
    ));
    Ok(figures)
}

fn judge_rates(figures: &Figures<'_>) -> Option<Judgement> {
    let rate = |what: &str, side: usize| figures.value(&format!("rate, {what}, {side}"));
    let printed = |what: &str, side: usize| {
        H2.printed(&format!("rate, {what}, {side}"))?.trim_end_matches(" Hz").parse::<f64>().ok()
    };
    let (mut faster, mut told) = (Vec::new(), Vec::new());
    for what in [KEY, BOTH] {
        for side in SIDES {
            faster.push(rate(what, side)? >= printed(what, side)?);
            told.push(number(rate(what, side)?));
        }
    }
    let share = figures.value("time of both over key light alone, 256")?;
    let growth = figures.values(["time of 512 over 256, key light", "time of 1024 over 512, key light"])?;
    let wins = faster.iter().filter(|faster| **faster).count();
    let mut sweeps = Vec::new();
    for what in [KEY, BOTH] {
        for side in SIDES {
            sweeps.push(figures.value(&format!("sweep: rate, {what}, {side}"))? / rate(what, side)?);
        }
    }
    let pyramid_wins = sweeps.iter().filter(|gain| **gain < 1.0).count();
    let sweeps: Vec<String> = sweeps.into_iter().map(number).collect();
    let why = format!(
        "Two cores reach {} Hz, at {wins} of 6 the printed rate or more; the environment costs {} times (2 to 4.5 count as the same), four \
         times the vertices {} and {} times (3.5 to 6). With the exact sweep in the pyramid's place rates are {} times these: the pyramid \
         wins {pyramid_wins} of 6.",
        told.join(", "),
        number(share),
        number(growth[0]),
        number(growth[1]),
        sweeps.join(", "),
    );
    let parts = [wins == 6, growth.iter().all(|growth| (3.5..6.0).contains(growth)), (2.0..4.5).contains(&share)];
    Some(Judgement { verdict: Verdict::of(&parts), why })
}

pub(crate) const H3: Row = Row {
    id: "H3",
    place: "§7",
    claim: "Wedge tables for 256 elevations take less than a second on the CPU",
    paper: &[("tables of order 4", "< 1 s")],
    needs: "",
    measure: measure_tables,
    judge: judge_tables,
};

fn measure_tables(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let scene = halflight_scenes::find("trench")?;
    let mut figures = Vec::new();
    for order in [4, 8] {
        let setting = Setting::new("horizon-wedges/complete", &[("order", &order.to_string())])?;
        let mut rounds = Vec::new();
        for _ in 0..bench.terms.rounds {
            let cache = Cache::in_memory();
            let task = crate::execute::Task { cache: &cache, ..bench.task(&scene, setting.method, &setting.params) };
            let ready = prepare_once(&task, &Key::of_bytes(b"no cell"), &mut silent).map_err(Error::Other)?;
            let nanoseconds = ready.prepared.recorded.derived.get("wedge-tables").copied().unwrap_or(f64::NAN);
            rounds.push(nanoseconds * 1e-9);
        }
        figures.push(Figure::median(format!("tables of order {order}"), "s", &rounds));
    }
    Ok(figures)
}

fn judge_tables(figures: &Figures<'_>) -> Option<Judgement> {
    let [four, eight] = figures.values(["tables of order 4", "tables of order 8"])?;
    let why = format!(
        "In closed form {} s at order 4 and {} s at order 8 on all cores; the paper integrates numerically.",
        number(four),
        number(eight)
    );
    Some(Judgement { verdict: Verdict::of(&[four < 1.0]), why })
}
