//! Several processes on one directory, several directories into one.

use crate::bench::{Bench, SCENE, of_kind};
use crate::same::assert_same;
use serde_json::Value;
use std::collections::HashSet;
use std::process::Stdio;

const ALL: &str =
    "--method shexp/hyb --method sh-product/ordered --set order=2..6 --reference truth --reference sh-light";

fn two_scenes() -> Bench {
    let bench = Bench::new();
    bench.write("other.toml", &SCENE.replace("radius = 0.5", "radius = 0.8"));
    bench
}

#[test]
fn three_runs_at_once_share_the_work_and_lose_nothing() {
    let bench = two_scenes();
    let scenes = "--scene tiny.toml --scene other.toml";
    bench.well(&format!("run {scenes} {ALL} --out alone --cache one"));
    // Each with a cache of its own, so that they meet in the results alone.
    let start = |i: usize| {
        let command = format!("run {scenes} {ALL} --out shared --cache cache-{i}");
        bench.command(&command).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap()
    };
    let running: Vec<_> = (0..3).map(start).collect();
    let ran = |child: std::process::Child| {
        let said = child.wait_with_output().unwrap();
        let told = String::from_utf8(said.stdout).unwrap();
        assert!(said.status.success(), "{told}");
        told.split_once(" cells run").unwrap().0.parse::<usize>().unwrap()
    };
    let ran: Vec<usize> = running.into_iter().map(ran).collect();
    assert_eq!(ran.iter().sum::<usize>(), 20, "{ran:?}: every cell once");
    let lines = bench.lines("shared");
    let keys = |kind, fields: &[&str]| -> Vec<String> {
        let key = |line: &&Value| fields.iter().map(|field| line[field].as_str().unwrap()).collect();
        of_kind(&lines, kind).iter().map(key).collect()
    };
    for keys in [keys("run", &["key"]), keys("score", &["run", "reference_key"])] {
        assert_eq!(keys.iter().collect::<HashSet<_>>().len(), keys.len(), "something was done twice");
    }
    assert_same(&bench.path("alone"), &bench.path("shared"));
    assert!(!bench.path("shared/claims").exists());
}

#[test]
fn halves_of_a_plan_merge_to_the_same_report_as_one_run() {
    let bench = two_scenes();
    let total = "--quantity direct --quantity total";
    bench.well(&format!("run --scene tiny.toml --scene other.toml {ALL} {total} --out whole"));
    // By methods and settings, so that every scene has some of both.
    let references = "--reference truth --reference sh-light";
    let scenes = "--scene tiny.toml --scene other.toml";
    bench.well(&format!("run {scenes} --method shexp/hyb --set order=2..6 {references} {total} --out a"));
    bench.well(&format!("run {scenes} --method sh-product/ordered --set order=2..6 {references} {total} --out b"));
    let told = bench.well("merge a b --out merged");
    assert!(told.contains("a: 20 cells, 20 scores") && told.contains("b: 20 cells, 20 scores"), "{told}");
    assert_same(&bench.path("whole"), &bench.path("merged"));
    assert!(std::fs::read_to_string(bench.path("merged/report.html")).unwrap().contains("shexp/hyb"));
    // And it is whole: nothing is left to run.
    let before = bench.files("merged");
    let told = bench.well(&format!("run {scenes} {ALL} {total} --out merged"));
    assert!(told.contains("0 cells run, 20 cached") && told.contains("0 scores added"), "{told}");
    let told = bench.well("merge b a merged --out merged");
    assert!(told.contains("a: 0 cells, 0 scores, 0 images"), "{told}");
    assert!(bench.files("merged") == before);
}

#[test]
fn a_merge_tells_conflicts_and_what_is_missing() {
    let bench = Bench::new();
    bench.well("run --scene tiny.toml --method shexp/hyb --reference truth --out a");
    bench.well("run --scene tiny.toml --method shexp/hyb --set order=2 --reference truth --out b");
    let [image, other] =
        ["a", "b"].map(|out| of_kind(&bench.lines(out), "run")[0]["image"].as_str().unwrap().to_owned());
    // The same cell with another picture.
    std::fs::create_dir(bench.path("c")).unwrap();
    let text = std::fs::read_to_string(bench.path("a/results.jsonl")).unwrap();
    bench.write("c/results.jsonl", &text.lines().next().unwrap().replace(&image, &other));
    let said = bench.halflight("merge a c --out merged");
    assert_eq!(said.code, 1);
    assert!(said.err.contains("c: tiny · shexp/hyb") && said.err.contains("different pictures"), "{}", said.err);
    let said = bench.halflight("merge c --out lost");
    assert!(said.code == 1 && said.err.contains(&other), "{}", said.err);
    let said = bench.halflight("merge nowhere --out merged");
    assert!(said.code == 2 && said.err.contains("nowhere/results.jsonl"), "{}", said.err);
}
