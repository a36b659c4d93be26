//! `halflight export`, and what an independent renderer says to it.

use crate::bench::{Bench, SCENE};
use std::io::Write;
use std::path::PathBuf;
use std::process::Command;

#[test]
fn export_writes_blockers_lights_and_receivers_with_their_truth() {
    let bench = Bench::new();
    bench.well("export --scene tiny.toml --to mitsuba --out mi --receivers 12 --samples 256");
    let read = |name: &str| std::fs::read_to_string(bench.path(&format!("mi/{name}"))).unwrap();
    let shapes = read("shapes.xml");
    assert!(
        shapes.contains(r#"<point name="center" x="0" y="0" z="1"/><float name="radius" value="0.5"/>"#),
        "{shapes}"
    );
    assert_eq!(shapes.matches("<shape").count(), 1, "only what casts shadows: {shapes}");
    assert!(read("light-0.xml").contains("environment-0.exr") && bench.path("mi/environment-0.exr").exists());
    let contents: serde_json::Value = serde_json::from_str(&read("export.json")).unwrap();
    assert_eq!((&contents["lights"][0], &contents["quantity"]), (&"light-0.xml".into(), &"direct".into()));
    let receivers = read("receivers.csv");
    let lines: Vec<Vec<f32>> =
        receivers.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    assert!(lines.len() == 12 && lines.iter().all(|line| line.len() == 18 && line[12] > 0.0), "{receivers}");
    // Of 4 × 3 pixels every second one both ways.
    bench.well("export --scene tiny.toml --to mitsuba --out mi --receivers 5 --samples 256");
    let fewer: Vec<String> = read("receivers.csv").lines().skip(1).map(|line| line[..7].to_owned()).collect();
    assert_eq!(fewer, ["-0.5,0,", "1.5,0,0"]);
}

/// Over a terrain of kilometres a light at a fixed distance would move by degrees.
#[test]
fn what_is_infinitely_far_is_far_from_the_farthest_receiver() {
    let bench = Bench::new();
    let key = "key = { direction = [0.6, 0.0, 0.8], angular_radius = 2.0, radiance = [9.0, 9.0, 9.0] }";
    let near = SCENE.replace("sky = { overcast = [1.0, 0.9, 0.8] }", key);
    for (size, least) in [("[4.0, 3.0]", 1e6), ("[40000.0, 30000.0]", 1e9)] {
        bench.write("key.toml", &near.replace("size = [4.0, 3.0]", &format!("size = {size}")));
        bench.well("export --scene key.toml --to mitsuba --out mi --samples 256");
        let light = std::fs::read_to_string(bench.path("mi/light-0.xml")).unwrap();
        let (_, origin) = light.split_once("lookat origin=\"").unwrap_or_else(|| panic!("{light}"));
        let origin: Vec<f64> = origin.split('"').next().unwrap().split(", ").map(|v| v.parse().unwrap()).collect();
        let distance = origin.iter().map(|v| v * v).sum::<f64>().sqrt();
        assert!((0.9..10.0).contains(&(distance / least)), "{size}: {distance}");
    }
}

/// The Python that `HALFLIGHT_PYTHON` names, or `python3` if that has Mitsuba.
fn python() -> Option<String> {
    if let Ok(named) = std::env::var("HALFLIGHT_PYTHON") {
        return Some(named);
    }
    let imports = Command::new("python3").args(["-c", "import mitsuba, numpy"]).output();
    imports.is_ok_and(|said| said.status.success()).then(|| "python3".to_owned())
}

/// The scene exported, what Mitsuba says to it with each thing made wrong, and how `crosscheck` ends.
fn agrees(scene: &str, quantity: &str, controls: &[&str]) {
    let Some(python) = python() else {
        // Straight to the terminal: what print macros say is hidden when a test passes.
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED, not tested: {quantity} of {scene} against Mitsuba needs python3 with mitsuba and numpy"
        );
        return;
    };
    let bench = Bench::new();
    let asked = format!("--scene {scene} --quantity {quantity} --receivers 200 --samples 4096");
    bench.well(&format!("export --to mitsuba --out mi {asked}"));
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/mitsuba/render.py");
    let wrongs = controls.iter().map(|wrong| vec!["--wrong", *wrong]);
    for wrong in std::iter::once(Vec::new()).chain(wrongs) {
        let mut render = Command::new(&python);
        let said = render.arg(&script).arg(bench.path("mi")).args(["--samples", "4096"]).args(&wrong).output().unwrap();
        assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
        let said = bench.halflight("crosscheck mi --out out");
        let (code, verdict) = if wrong.is_empty() { (0, "agrees with Mitsuba 3") } else { (1, "DIFFERS with") };
        assert!(
            said.code == code && said.out.contains(verdict),
            "{scene} {quantity} {wrong:?}: {}{}",
            said.out,
            said.err
        );
    }
    assert!(std::fs::read_to_string(bench.path("out/report.html")).unwrap().contains("Cross-checks with Mitsuba 3"));
}

#[test]
fn mitsuba_agrees_with_light_from_afar_and_not_with_wrong_light() {
    agrees("bunny-studio", "direct", &["scale", "mirror", "turn"]);
}

#[test]
fn mitsuba_agrees_with_one_bounce_in_a_room_and_not_with_brighter_walls() {
    agrees("room", "indirect-1", &["albedo"]);
}

#[test]
fn mitsuba_agrees_with_all_light_of_spherical_lamps_and_not_with_brighter_ones() {
    agrees("lamp", "total", &["scale"]);
}

#[test]
fn answers_that_do_not_fit_are_refused() {
    let bench = Bench::new();
    let refused = |expected: &str| {
        let said = bench.halflight("crosscheck mi --out out");
        assert!(said.code == 2 && said.err.contains(expected), "{expected}: {}", said.err);
        assert!(!bench.path("out/results.jsonl").exists());
    };
    refused("export.json");
    bench.well("export --scene tiny.toml --to mitsuba --out mi --receivers 2 --samples 256");
    refused("mitsuba.json");
    let answer = |mean: &str, variance: &str| {
        let text = format!(r#"{{"program": "x", "samples": 9, "mean": {mean}, "variance": {variance}}}"#);
        bench.write("mi/mitsuba.json", &text);
    };
    answer("[[1, 1, 1]]", "[[1, 1, 1]]");
    refused("1 means, 1 variances; expected 2");
    answer("[[1, 1, 1], [1, 1, 1]]", "[[1, 1, 1], [1, 1, -1]]");
    refused("not below 0");
    answer("[[1, 1, 1], [1, 1, 1]]", "[[1, 1, 1], [1, 1, 1]]");
    bench.write("tiny.toml", &crate::bench::SCENE.replace("0.9", "0.8"));
    refused("the scene has changed since");
    bench.write("tiny.toml", crate::bench::SCENE);
    bench.well("crosscheck mi --out out");
}

#[test]
fn what_mitsuba_has_no_counterpart_for_is_refused() {
    let bench = Bench::new();
    let lamp = "albedo = [0.5, 0.5, 0.5]\nemission = [1.0, 1.0, 1.0]\ncasts = false";
    bench.write("lamp.toml", &crate::bench::SCENE.replace("albedo = [0.5, 0.5, 0.5]", lamp));
    let said = bench.halflight("export --scene lamp.toml --to mitsuba --out mi --receivers 2 --samples 256");
    assert!(said.code == 2 && said.err.contains("`ball` emits but does not cast"), "{}", said.err);
}
