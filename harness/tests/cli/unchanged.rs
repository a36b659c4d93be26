//! What did not change is not done again.

use crate::bench::Bench;
use halflight::{Plan, Selection, State, Terms, environment};
use halflight_results::Store;
use std::time::{Duration, Instant};

#[test]
fn an_unchanged_suite_runs_again_in_no_time_and_touches_nothing() {
    let bench = Bench::new();
    // As many cells as a suite has: every order by several self-shadow rules.
    let command = "run --scene tiny.toml --set order=2..6 --set self-shadow=paper,continuous,off --out out";
    let told = bench.well(command);
    let cells: usize = told.split_once(" cells run").unwrap().0.parse().unwrap();
    assert!(cells >= 40, "{told}");
    let before = (bench.files(""), bench.folders(""));
    let started = Instant::now();
    let told = bench.well(command);
    let took = started.elapsed();
    assert!(told.contains(&format!("0 cells run, {cells} cached")), "{told}");
    assert!((bench.files(""), bench.folders("")) == before, "a second run touched files");
    assert!(took < Duration::from_secs(2), "{took:?}");
}

#[test]
fn a_new_revision_of_a_method_runs_its_cells_alone() {
    let bench = Bench::new();
    let scene = bench.path("tiny.toml").display().to_string();
    let selection = Selection {
        scenes: vec![scene],
        methods: vec!["shexp/hyb".into(), "shexp/eigen".into(), "sh-product/ordered".into()],
        references: vec!["truth".into()],
        ..Default::default()
    };
    let terms = Terms { seed: 1, timed_on: environment().class() };
    let mut plan = Plan::new(&selection.entries().unwrap(), &terms).unwrap();
    bench.well(
        "run --scene tiny.toml --method shexp/hyb --method shexp/eigen --method sh-product/ordered --reference truth --out out",
    );
    let store = Store::open(bench.path("out")).unwrap();
    let states = |plan: &Plan| plan.cells().map(|(group, cell)| group.state(cell, &store)).collect::<Vec<_>>();
    assert_eq!(states(&plan), [State::Cached, State::Cached, State::Cached]);
    plan.groups.iter_mut().filter(|g| g.method.info().family() == "shexp").for_each(|group| {
        group.cells.iter_mut().for_each(|cell| cell.revision = "another".into());
    });
    assert_eq!(states(&plan), [State::Run, State::Run, State::Cached]);
}
