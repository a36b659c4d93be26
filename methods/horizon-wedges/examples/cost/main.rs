//! Writes `docs/horizon-wedges.md`: what the family costs, phase by phase.
//!
//! `cargo run --release -p halflight-horizon-wedges --example cost > docs/horizon-wedges.md`; with `rates [ROUNDS [CASE]]` after `--` the rates
//! alone, of the cases whose names begin so.

mod looks;
mod running;

use halflight_contract::Cache;
use halflight_horizon_wedges::{MARCH, PARTIAL, SWEEP, Variant};
use running::{Case, Motion, Running, keys, scene};

const ROUNDS: usize = 6;
const WAYS: [(&str, Variant); 3] = [("pyramid", PARTIAL), ("sweep", SWEEP), ("march", MARCH)];

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if args.first().is_some_and(|arg| arg == "rates") {
        let rounds = args.get(1).and_then(|arg| arg.parse().ok()).unwrap_or(ROUNDS);
        return rates(rounds, args.get(2).map_or("", String::as_str));
    }
    print!("{}", include_str!("head.md"));
    println!("\n## Rates\n\n{} threads, {:?}.\n", rayon::current_num_threads(), halflight_sh::Simd::best());
    rates(ROUNDS, "");
    println!("\n## Little changes, or little is asked\n\n512 × 512 vertices, key light and sky.\n");
    little();
    println!("\n## Horizons alone\n");
    looks::costs();
    println!("\n## Settings\n\n256 × 256 vertices, key light and sky, all else by default.\n");
    settings();
    println!("\n## Bytes\n");
    looks::bytes();
    println!("\n## Borders\n");
    looks::borders();
}

/// Those that are timed in turns, ready and run once.
fn timed<'s>(cases: &[&'s Case], rounds: usize, cache: &Cache) -> Vec<Running<'s>> {
    let mut all: Vec<Running<'_>> = cases.iter().map(|case| Running::new(case, cache)).collect();
    for _ in 0..rounds {
        all.iter_mut().for_each(Running::round);
    }
    all
}

fn rates(rounds: usize, prefix: &str) {
    let (mut cases, motion) = (Vec::new(), Motion::Heights);
    for side in [256, 512, 1024] {
        for (way, method) in WAYS {
            // The march would take longest.
            if way == "march" && side > 256 {
                continue;
            }
            let both = scene(&format!("fractal-{side}"));
            let name = |lights| format!("{way}, {side}, {lights}");
            cases.push(Case {
                name: name("key"),
                scene: keys(both.clone()),
                method,
                params: vec![],
                motion,
                azimuths: 3,
            });
            cases.push(Case { name: name("both"), scene: both, method, params: vec![], motion, azimuths: 19 });
        }
    }
    for (way, method) in WAYS {
        let scene = scene("jacksboro-sunrise");
        cases.push(Case { name: format!("{way}, camera"), scene, method, params: vec![], motion, azimuths: 19 });
    }
    let cases: Vec<&Case> = cases.iter().filter(|case| case.name.starts_with(prefix)).collect();
    table(&cases, rounds);
}

fn table(cases: &[&Case], rounds: usize) {
    println!(
        "| case | receivers | Hz: median, quartiles | update ms | evaluate ms | processor ms | ns a receiver and direction |\n\
         |---|---|---|---|---|---|---|"
    );
    for running in timed(cases, rounds, &Cache::in_memory()) {
        let hertz = |share| 1e3 / running.quantile(share, |times| times.update + times.evaluate);
        let spent = running.processors();
        println!(
            "| {} | {} | {:.1}, {:.1}–{:.1} | {:.2} | {:.2} | {spent:.2} | {:.1} |",
            running.case.name,
            running.receivers(),
            hertz(0.5),
            hertz(0.75),
            hertz(0.25),
            running.quantile(0.5, |times| times.update),
            running.quantile(0.5, |times| times.evaluate),
            1e6 * spent / (running.receivers() * running.case.azimuths) as f64,
        );
    }
}

/// Frames of which little changes, and few receivers.
fn little() {
    let both = scene("fractal-512");
    let frame = both.frame(0);
    let few = (0..1000).map(|i| i * 257 % frame.receivers.len());
    let points: Vec<_> = few.map(|i| (frame.receivers.position[i], frame.receivers.normal[i])).collect();
    let few = both.with_receivers(&points);
    let mut cases = Vec::new();
    for (what, scene, motion) in [
        ("the key light turns", &both, Motion::Lights),
        ("8 rows change", &both, Motion::Rows),
        ("1000 receivers, all heights change", &few, Motion::Heights),
        ("1000 receivers, 8 rows change", &few, Motion::Rows),
        ("1000 receivers, the key light turns", &few, Motion::Lights),
    ] {
        for (way, method) in WAYS {
            let (name, scene) = (format!("{way}, {what}"), scene.clone());
            cases.push(Case { name, scene, method, params: vec![], motion, azimuths: 19 });
        }
    }
    table(&cases.iter().collect::<Vec<_>>(), ROUNDS);
}

fn settings() {
    let both = scene("fractal-256");
    let mut cases = Vec::new();
    for (parameter, values) in [
        ("levels", &["1", "2", "4", "8"][..]),
        ("azimuths", &["4", "8", "16", "32", "64"]),
        ("key-azimuths", &["1", "3", "8", "16"]),
        ("order", &["2", "3", "4", "5", "6", "8"]),
        ("storage", &["octaves", "decimated", "full"]),
        ("border", &["open", "extend"]),
    ] {
        cases.extend(values.iter().map(|value| Case {
            name: format!("{parameter} = {value}"),
            scene: both.clone(),
            method: PARTIAL,
            params: vec![(parameter, value)],
            motion: Motion::Heights,
            azimuths: 19,
        }));
    }
    println!("| setting | update ms | evaluate ms | processor ms |\n|---|---|---|---|");
    for running in timed(&cases.iter().collect::<Vec<_>>(), ROUNDS, &Cache::in_memory()) {
        println!(
            "| {} | {:.2} | {:.2} | {:.2} |",
            running.case.name,
            running.quantile(0.5, |times| times.update),
            running.quantile(0.5, |times| times.evaluate),
            running.processors(),
        );
    }
}
