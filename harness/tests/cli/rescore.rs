//! `halflight score`: newer measures of stored pictures.

use crate::bench::{Bench, of_kind};
use crate::same::assert_same;
use halflight_metrics::VERSION;
use serde_json::Value;

#[test]
fn scores_of_older_measures_are_taken_again_without_running() {
    let bench = Bench::new();
    bench.well("run --scene tiny.toml --method shexp/hyb --set order=2..3 --out out");
    bench.well("run --scene tiny.toml --method shexp/hyb --set order=2..3 --out old");
    let told = bench.well("score --out out");
    assert!(told.contains("0 scores added, 6 present, 0 failed"), "{told}");

    // As an older Halflight would have left it: other measures, other values, no cache at hand.
    let older = |line: &Value| {
        let mut line = line.clone();
        if line["kind"] == "score" {
            line["metrics"] = 0.into();
            line["measures"] = serde_json::json!({ "rmse": 123.0 });
        }
        format!("{line}\n")
    };
    let text: String = bench.lines("old").iter().map(older).collect();
    bench.write("old/results.jsonl", &text);
    std::fs::remove_dir_all(bench.path("cache")).unwrap();
    let told = bench.well("score --out old");
    assert!(told.contains("6 scores added, 0 present, 0 failed"), "{told}");
    assert_eq!(of_kind(&bench.lines("old"), "run").len(), 2, "nothing was run");
    assert!(!bench.path("cache").exists(), "nor was a reference made");
    assert_same(&bench.path("out"), &bench.path("old"));
    assert!(bench.well("score --out old").contains("0 scores added, 6 present"));
}

#[test]
fn a_lost_reference_stops_its_scores_alone() {
    let bench = Bench::new();
    bench.well("run --scene tiny.toml --method shexp/hyb --reference truth --reference sh-light --out out");
    let text = std::fs::read_to_string(bench.path("out/results.jsonl")).unwrap();
    bench.write("out/results.jsonl", &text.replace(&format!("\"metrics\":{VERSION}"), "\"metrics\":0"));
    let lines = bench.lines("out");
    let lost = of_kind(&lines, "score")[0]["reference_image"].as_str().unwrap();
    std::fs::remove_file(bench.path(&format!("out/images/{lost}.exr"))).unwrap();
    let said = bench.halflight("score --out out");
    assert!(said.code == 1 && said.out.contains("1 scores added, 0 present, 1 failed"), "{}{}", said.out, said.err);
    assert!(said.err.contains("tiny · shexp/hyb against") && said.err.contains(lost), "{}", said.err);
    let said = bench.halflight("score --out nowhere");
    assert!(said.code == 2 && !bench.path("nowhere").exists(), "{}", said.err);
}
