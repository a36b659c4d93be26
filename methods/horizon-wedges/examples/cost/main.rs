//! Writes `docs/horizon-wedges.md`: what the family costs, phase by phase.
//!
//! `cargo run --release -p halflight-horizon-wedges --example cost > docs/horizon-wedges.md`; with `rates [ROUNDS [CASE]]` after `--` the rates
//! alone, of the cases whose names begin so.

mod running;

use halflight_contract::Cache;
use halflight_horizon_wedges::{MARCH, PARTIAL, SWEEP};
use running::{Case, Running, keys, scene};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let rounds = args.get(1).and_then(|arg| arg.parse().ok()).unwrap_or(8);
    rates(rounds, args.get(2).map_or("", String::as_str));
}

fn rates(rounds: usize, prefix: &str) {
    let mut cases = Vec::new();
    for side in [256, 512, 1024] {
        let both = || scene(&format!("fractal-{side}"));
        for (way, method) in [("pyramid", PARTIAL), ("sweep", SWEEP), ("march", MARCH)] {
            if way == "march" && side > 256 {
                continue;
            }
            let case = |lights, scene| Case { name: format!("{way}, {side}, {lights}"), scene, method, params: vec![] };
            cases.push(case("key", keys(both())));
            cases.push(case("both", both()));
        }
    }
    for (way, method) in [("pyramid", PARTIAL), ("sweep", SWEEP), ("march", MARCH)] {
        let scene = scene("jacksboro-sunrise");
        cases.push(Case { name: format!("{way}, camera"), scene, method, params: vec![] });
    }
    let cache = Cache::in_memory();
    let cases: Vec<&Case> = cases.iter().filter(|case| case.name.starts_with(prefix)).collect();
    let mut all: Vec<Running<'_>> = cases.iter().map(|case| Running::new(case, &cache)).collect();
    for _ in 0..rounds {
        all.iter_mut().for_each(Running::round);
    }
    println!(
        "| case | receivers | Hz: median, quartiles | update ms | evaluate ms | quickest Hz | processor ms |\n|---|---|---|---|---|---|---|"
    );
    for running in &all {
        let hertz = |share| 1e3 / running.quantile(share, |times| times.whole());
        println!(
            "| {} | {} | {:.1}, {:.1}–{:.1} | {:.2} | {:.2} | {:.1} | {:.2} |",
            running.case.name,
            running.receivers(),
            hertz(0.5),
            hertz(0.75),
            hertz(0.25),
            running.quantile(0.5, |times| times.update),
            running.quantile(0.5, |times| times.evaluate),
            hertz(0.0),
            running.quantile(0.0, |times| times.processors),
        );
    }
}
