//! `halflight export`, and what an independent renderer says to it.

use crate::bench::Bench;
use std::io::Write;
use std::path::PathBuf;
use std::process::Command;

#[test]
fn export_writes_blockers_lights_and_receivers_with_their_truth() {
    let bench = Bench::new();
    bench.well("export --scene tiny.toml --to mitsuba --out mi --receivers 5 --samples 256");
    let read = |name: &str| std::fs::read_to_string(bench.path(&format!("mi/{name}"))).unwrap();
    let shapes = read("shapes.xml");
    assert!(
        shapes.contains(r#"<point name="center" x="0" y="0" z="1"/><float name="radius" value="0.5"/>"#),
        "{shapes}"
    );
    assert_eq!(shapes.matches("<shape").count(), 1, "only what casts shadows: {shapes}");
    assert!(read("light-0.xml").contains("environment-0.exr") && bench.path("mi/environment-0.exr").exists());
    let contents: serde_json::Value = serde_json::from_str(&read("export.json")).unwrap();
    assert_eq!((&contents["lights"][0], &contents["degrees_of_freedom"]), (&"light-0.xml".into(), &63.into()));
    let receivers = read("receivers.csv");
    let lines: Vec<Vec<f32>> =
        receivers.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    assert!(lines.len() == 5 && lines.iter().all(|line| line.len() == 18 && line[12] > 0.0), "{receivers}");
}

/// The Python that `HALFLIGHT_PYTHON` names, or `python3` if that has Mitsuba.
fn python() -> Option<String> {
    if let Ok(named) = std::env::var("HALFLIGHT_PYTHON") {
        return Some(named);
    }
    let imports = Command::new("python3").args(["-c", "import mitsuba, numpy"]).output();
    imports.is_ok_and(|said| said.status.success()).then(|| "python3".to_owned())
}

#[test]
fn mitsuba_agrees_with_truth_and_not_with_wrong_light() {
    let Some(python) = python() else {
        // Straight to the terminal: what print macros say is hidden when a test passes.
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED, not tested: mitsuba_agrees_with_truth_and_not_with_wrong_light needs python3 with mitsuba and numpy"
        );
        return;
    };
    let bench = Bench::new();
    bench.well("export --scene bunny-studio --to mitsuba --out mi --receivers 200 --samples 4096");
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/mitsuba/compare.py");
    for (wrong, expected) in [(None, 0), (Some("scale"), 1), (Some("mirror"), 1), (Some("turn"), 1)] {
        let mut compare = Command::new(&python);
        compare.arg(&script).arg(bench.path("mi")).args(["--samples", "4096"]);
        compare.args(wrong.iter().flat_map(|wrong| ["--wrong", wrong]));
        let said = compare.output().unwrap();
        let told = [said.stdout, said.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        assert_eq!(said.status.code(), Some(expected), "{wrong:?}: {told}");
        // An exit status alone may be a crash's.
        assert!(told.contains(if expected == 0 { "agree;" } else { "DIFFER;" }), "{wrong:?}: {told}");
    }
}
