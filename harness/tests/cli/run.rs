//! `halflight run`: nothing twice, nothing lost, the same bits.

use crate::bench::{Bench, SCENE, of_kind};

const TINY: &str = "run --scene tiny.toml --method shexp/hyb --method sh-product/ordered --set order=2..3 --repeats 2";

#[test]
fn a_run_leaves_results_pictures_and_a_report() {
    let bench = Bench::new();
    let told = bench.well(&format!("{TINY} --out out"));
    assert!(told.contains("4 cells run, 0 cached, 0 skipped, 0 failed"), "{told}");
    assert!(told.contains("report: out/report.html"), "{told}");
    let page = std::fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(page.contains("shexp/hyb") && page.contains("tiny"));

    let lines = bench.lines("out");
    let (runs, scores) = (of_kind(&lines, "run"), of_kind(&lines, "score"));
    // truth and sphere-proxies for all, sh-light of each cell's own order.
    assert_eq!((runs.len(), scores.len()), (4, 12));
    for order in ["sh-light:2", "sh-light:3"] {
        assert_eq!(scores.iter().filter(|score| score["reference"] == order).count(), 2, "{order}");
    }
    for run in runs {
        assert_eq!(run["receivers"], 12);
        let derived = run["derived"].as_object().unwrap();
        assert!(!derived.is_empty() && derived.values().all(|time| time.as_f64() > Some(0.0)), "{derived:?}");
        let image = format!("out/images/{}.exr", run["image"].as_str().unwrap());
        assert!(bench.path(&image).is_file());
    }
    // No blocker covers more than a part of the sky, and none of it is lost.
    for score in scores.iter().filter(|score| score["reference"] == "truth") {
        let rmse = score["measures"]["rmse"].as_f64().unwrap();
        assert!(rmse > 0.0 && rmse < 0.1, "{rmse}");
    }
}

#[test]
fn a_second_run_does_nothing_and_a_deleted_line_recomputes_that_cell_alone() {
    let bench = Bench::new();
    bench.well(&format!("{TINY} --out out"));
    let before = (bench.files("out"), bench.files("cache"));
    let told = bench.well(&format!("{TINY} --out out"));
    assert!(told.contains("0 cells run, 4 cached, 0 skipped, 0 failed; 0 references made, 0 scores added"), "{told}");
    assert!((bench.files("out"), bench.files("cache")) == before, "a second run touched files");

    let text = std::fs::read_to_string(bench.path("out/results.jsonl")).unwrap();
    let gone = text.lines().find(|line| line.contains(r#""kind":"run""#)).unwrap();
    let kept: String = text.lines().filter(|line| *line != gone).map(|line| format!("{line}\n")).collect();
    bench.write("out/results.jsonl", &kept);
    let told = bench.well(&format!("{TINY} --out out"));
    assert!(told.contains("1 cells run, 3 cached, 0 skipped, 0 failed; 0 references made, 0 scores added"), "{told}");
    let lines = bench.lines("out");
    let again = lines.last().unwrap();
    let gone: serde_json::Value = serde_json::from_str(gone).unwrap();
    assert_eq!((&again["key"], &again["image"]), (&gone["key"], &gone["image"]));
}

#[test]
fn without_its_store_a_run_takes_references_from_the_cache() {
    let bench = Bench::new();
    bench.well(&format!("{TINY} --out one"));
    let told = bench.well(&format!("{TINY} --out two"));
    assert!(told.contains("4 cells run") && told.contains("0 references made, 12 scores added"), "{told}");
}

#[test]
fn missing_pictures_are_made_again() {
    let bench = Bench::new();
    bench.well(&format!("{TINY} --out out"));
    std::fs::remove_dir_all(bench.path("out/images")).unwrap();
    let told = bench.well(&format!("{TINY} --out out"));
    assert!(told.contains("4 cells run, 0 cached") && told.contains("12 scores added"), "{told}");
}

#[test]
fn threads_change_no_bit_and_the_seed_decides() {
    let bench = Bench::new();
    // Enough receivers for several threads to have some.
    bench.write("wide.toml", &SCENE.replace("[4, 3]", "[32, 24]"));
    let run = |out: &str, more: &str| {
        let what = "--scene wide.toml --method shexp/hyb --method sh-product/ordered --reference truth";
        bench.well(&format!("run {what} --out {out} --cache cache-{out} {more}"));
        let lines = bench.lines(out);
        let images = |kind: &str, field: &str| {
            let mut all: Vec<_> = of_kind(&lines, kind).iter().map(|l| l[field].as_str().unwrap().to_owned()).collect();
            all.sort();
            all
        };
        (images("run", "image"), images("score", "reference_image"))
    };
    let one = run("one", "--threads 1");
    assert_eq!(one, run("two", "--threads 2"));
    let other = run("three", "--threads 2 --seed 2");
    assert_ne!(one.1, other.1, "references of another seed");
}

#[test]
fn every_frame_is_a_cell() {
    let bench = Bench::new();
    let moving =
        SCENE.replace("albedo", "motion = [{ time = 0.0 }, { time = 1.0, translate = [1.0, 0.0, 0.0] }]\nalbedo");
    bench.write("moving.toml", &format!("{moving}\n[frames]\ncount = 3\nfps = 1.0\n"));
    // The last key holds from 1 s on: frames 1 and 2 are equal, and so is their reference.
    let command = "run --scene moving.toml --method shexp/hyb --reference truth --out out";
    let told = bench.well(command);
    assert!(told.contains("3 cells run") && told.contains("2 references made, 3 scores added"), "{told}");
    let lines = bench.lines("out");
    let runs = of_kind(&lines, "run");
    let frames: Vec<_> = runs.iter().map(|run| run["frame"].as_u64().unwrap()).collect();
    assert_eq!(frames, [0, 1, 2]);
    assert_ne!(runs[0]["image"], runs[1]["image"]);
    assert_eq!(runs[1]["image"], runs[2]["image"]);
    assert!(bench.well(command).contains("0 cells run, 3 cached"));
}

#[test]
fn damaged_pictures_are_made_again() {
    let bench = Bench::new();
    bench.well(&format!("{TINY} --out out"));
    for (path, ..) in bench.files("out/images") {
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    }
    let said = bench.halflight("report --out out");
    assert!(said.err.contains("picture left out"), "{}", said.err);
    let told = bench.well(&format!("{TINY} --out out"));
    assert!(told.contains("4 cells run, 0 cached"), "{told}");
    assert!(bench.halflight("report --out out").err.is_empty());
}

#[test]
fn a_frame_that_shows_nothing_is_skipped() {
    let bench = Bench::new();
    let view = "[camera]\neye = [0.0, -3.0, 1.0]\ntarget = [0.0, 0.0, 1.0]\nfov = 40.0\nwidth = 8\nheight = 6\n[receivers]\ncamera = {}\n";
    let (start, end) = (SCENE.find("[receivers").unwrap(), SCENE.find("[[objects]]").unwrap());
    let away = "motion = [{ time = 0.0 }, { time = 1.0, translate = [50.0, 0.0, 0.0] }]\nalbedo";
    let scene = format!("{}{view}{}", &SCENE[..start], SCENE[end..].replace("albedo", away));
    bench.write("away.toml", &format!("{scene}\n[frames]\ncount = 2\nfps = 1.0\n"));
    let told = bench.well("run --scene away.toml --method shexp/hyb --reference truth --out out");
    assert!(told.contains("1 cells run, 0 cached, 1 skipped, 0 failed"), "{told}");
    assert_eq!(of_kind(&bench.lines("out"), "skip")[0]["reason"], "frame 1 has no receiver");
}
