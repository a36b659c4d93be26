//! `--dry-run`, `--budget` and what earlier runs tell of the time.

use crate::bench::{Bench, of_kind};

const SWEEP: &str = "--scene tiny.toml --method shexp/hyb --set order=2..6 --reference truth --out out";

#[test]
fn a_dry_run_does_nothing() {
    let bench = Bench::new();
    let told = bench.well(&format!("run {SWEEP} --dry-run"));
    assert_eq!(told, bench.well(&format!("plan {SWEEP}")));
    assert!(told.ends_with("5 to run, 0 cached, 0 skipped; 1 references to make\n"), "{told}");
    assert!(!bench.path("out").exists() && !bench.path("cache").exists());
}

#[test]
fn earlier_runs_tell_the_time() {
    let bench = Bench::new();
    bench.well(&format!("run {SWEEP}"));
    let before = bench.files("out");
    let told = bench.well(&format!("plan {SWEEP} --seed 2"));
    assert!(told.contains("order=4 · cpu · direct: run, against truth; about "), "{told}");
    assert!(
        told.contains("5 to run, 0 cached, 0 skipped; 1 references to make; about ")
            && told.contains(" s, by earlier runs"),
        "{told}"
    );
    let said = bench.halflight(&format!("run {SWEEP} --seed 2"));
    assert!(said.err.contains("5 cells to run and 1 references to make: about "), "{}", said.err);
    assert!(before != bench.files("out"));
}

#[test]
fn a_budget_takes_what_says_most_and_tells_what_it_left_out() {
    let bench = Bench::new();
    let told = bench.well(&format!("run {SWEEP} --budget 0s"));
    assert!(told.contains("0 cells run") && told.contains("; 5 cells left out, over the budget"), "{told}");
    let told = bench.well(&format!("run {SWEEP} --budget 1h"));
    assert!(told.contains("5 cells run") && !told.contains("left out"), "{told}");
    let lines = bench.lines("out");
    let orders: Vec<_> = of_kind(&lines, "run").iter().map(|run| run["params"]["order"].as_u64().unwrap()).collect();
    assert_eq!(orders, [4, 2, 6, 3, 5]);
    // A cell is scored before the next one is run: what was done when the time is over says something.
    let kinds: Vec<_> = lines[..7].iter().map(|line| line["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["run", "times", "reference", "score", "run", "times", "score"]);
    // With a time that is known to be too long, the budget is held without trying.
    let text = std::fs::read_to_string(bench.path("out/results.jsonl")).unwrap();
    let slow = |line: &str| {
        let mut line: serde_json::Value = serde_json::from_str(line).unwrap();
        if line["kind"] == "times" {
            line["phases"]["shade"]["nanoseconds"] = serde_json::json!([1e12]);
        }
        format!("{line}\n")
    };
    bench.write("out/results.jsonl", &text.lines().map(slow).collect::<String>());
    let told = bench.well(&format!("run {SWEEP} --seed 2 --budget 1m"));
    assert!(told.contains("0 cells run") && told.contains("5 cells left out"), "{told}");
    let told = bench.well(&format!("run {SWEEP} --seed 2 --budget 5h --repeats 1 --dry-run"));
    // 3000 s a cell.
    assert!(told.contains("5 to run, 0 cached, 0 skipped; 1 references to make; about 4.2 h"), "{told}");
    let told = bench.well(&format!("run {SWEEP} --seed 2 --budget 2.6h --repeats 1 --dry-run"));
    assert!(told.contains("3 to run, 0 cached, 0 skipped, 2 left out; 1 references to make; about 2.5 h"), "{told}");
    let said = bench.halflight(&format!("run {SWEEP} --budget soon"));
    assert!(said.code == 2 && said.err.contains("10m"), "{}", said.err);
}
