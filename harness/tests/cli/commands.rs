//! The commands other than `run`.

use crate::bench::{Bench, of_kind};
use serde_json::Value;

#[test]
fn list_gives_ids_and_abouts() {
    let bench = Bench::new();
    for (kind, expected) in [
        ("scenes", "sphere-plane"),
        ("methods", "shexp/hyb"),
        ("parameters", "shexp/hyb order"),
        ("references", "truth"),
        ("suites", "quick"),
        ("metrics", "rmse"),
    ] {
        let listed: Vec<Value> = serde_json::from_str(&bench.well(&format!("list {kind} --json"))).unwrap();
        for entry in &listed {
            let fields: Vec<_> = entry.as_object().unwrap().keys().collect();
            assert_eq!(fields, ["about", "id"], "{kind}");
            assert!(!entry["about"].as_str().unwrap().is_empty(), "{entry}");
        }
        assert!(listed.iter().any(|entry| entry["id"] == expected), "{kind}");
        assert!(bench.well(&format!("list {kind}")).contains(expected));
    }
}

#[test]
fn plan_says_what_would_be_done_and_why_not() {
    let bench = Bench::new();
    let some = "--scene tiny.toml --method shexp/hyb --quantity direct --quantity total --out out";
    let told = bench.well(&format!("plan {some}"));
    assert!(
        told.contains("tiny · shexp/hyb order=4 · cpu · direct: run, against truth, sh-light:4, sphere-proxies:32"),
        "{told}"
    );
    assert!(told.contains("total: skip: computes direct light only"), "{told}");
    assert!(told.ends_with("1 to run, 0 cached, 1 skipped; 3 references to make\n"), "{told}");
    assert!(!bench.path("out").exists() && !bench.path("cache").exists(), "a plan wrote something");

    bench.well(&format!("run {some}"));
    let lines = bench.lines("out");
    assert_eq!(of_kind(&lines, "skip")[0]["reason"], "computes direct light only");
    let told = bench.well(&format!("plan {some}"));
    assert!(told.contains("direct: cached") && told.ends_with("0 to run, 1 cached, 1 skipped\n"), "{told}");
    // A skip is not written twice.
    bench.well(&format!("run {some}"));
    assert_eq!(of_kind(&bench.lines("out"), "skip").len(), 1);
}

#[test]
fn equal_cells_are_planned_once() {
    let bench = Bench::new();
    let entry = "[[entry]]\nscenes = ['tiny.toml']\nmethods = ['shexp/hyb']\n";
    let suite = format!(
        "about = 'x'\n{entry}references = ['truth']\n{entry}set = {{ order = '4..5' }}\nreferences = ['sh-light', 'truth']\n"
    );
    std::fs::create_dir(bench.path("suites")).unwrap();
    bench.write("suites/mine.toml", &suite.replace("tiny.toml", "../tiny.toml"));
    let told = bench.well("plan --suite suites/mine.toml");
    assert!(told.contains("order=4 · cpu · direct: run, against truth, sh-light:4"), "{told}");
    assert!(told.ends_with("2 to run, 0 cached, 0 skipped; 3 references to make\n"), "{told}");
}

const POINTS: &str = "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n100,0,0,0,0,2\n";

/// Under the overcast sky, unoccluded and facing up: 1/π ∫ (1 + 2 sin e)/3 · sin e dω = 7/9 of the zenith's radiance.
const OPEN: f64 = 7.0 / 9.0;

#[test]
fn probe_asks_a_method() {
    let bench = Bench::new();
    bench.write("points.csv", POINTS);
    let command = "probe --scene tiny.toml --method shexp/hyb --set order=3 --at points.csv";
    let rows: Vec<Value> = serde_json::from_str(&bench.well(&format!("{command} --json"))).unwrap();
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[1]["position"], serde_json::json!([100.0, 0.0, 0.0]));
    assert_eq!(rows[1]["normal"], serde_json::json!([0.0, 0.0, 1.0]));
    let visibility =
        |row: &Value| row["visibility"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect::<Vec<_>>();
    assert_eq!(visibility(&rows[0]).len(), 9);
    // Open everywhere but for a speck: √4π, then nothing.
    let open = visibility(&rows[1]);
    assert!(
        (open[0] - (4.0 * std::f64::consts::PI).sqrt()).abs() < 1e-3 && open[1..].iter().all(|v| v.abs() < 1e-3),
        "{open:?}"
    );
    let red = |row: &Value| row["radiance"][0].as_f64().unwrap();
    assert!((red(&rows[1]) - OPEN).abs() < 0.03, "{}", red(&rows[1]));
    assert!(red(&rows[0]) < 0.9 * red(&rows[1]));
    assert!(rows[0].get("standard_error").is_none());

    let csv = bench.well(command);
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "x,y,z,nx,ny,nz,r,g,b,v0,v1,v2,v3,v4,v5,v6,v7,v8");
    let numbers: Vec<f64> = lines[1].split(',').map(|n| n.parse().unwrap()).collect();
    assert_eq!(numbers[6], red(&rows[0]));
    assert_eq!(numbers[9..], visibility(&rows[0]));
}

#[test]
fn probe_asks_a_reference() {
    let bench = Bench::new();
    bench.write("points.csv", POINTS);
    let command = "probe --scene tiny.toml --reference truth --at points.csv";
    let rows: Vec<Value> = serde_json::from_str(&bench.well(&format!("{command} --json"))).unwrap();
    let (red, error) = (rows[1]["radiance"][0].as_f64().unwrap(), rows[1]["standard_error"][0].as_f64().unwrap());
    assert!((red - OPEN).abs() < 4.0 * error + 1e-4 && error < 0.01, "{red} ± {error}");
    assert!(rows[0].get("visibility").is_none());
    assert!(bench.well(command).starts_with("x,y,z,nx,ny,nz,r,g,b,se_r,se_g,se_b\n0,0,0,0,0,1,"));

    let rows: Vec<Value> = serde_json::from_str(&bench.well(&format!("{command} --visibility 1 --json"))).unwrap();
    let (seen, error) = (rows[0]["visibility"][0].as_f64().unwrap(), rows[0]["visibility_error"][0].as_f64().unwrap());
    // The ball covers a circle of 30°.
    let open = (4.0 * std::f64::consts::PI).sqrt() * 0.5 * (1.0 + 0.75f64.sqrt());
    assert!((seen - open).abs() < 5.0 * error && error < 0.02, "{seen} ± {error} for {open}");
    let total = bench.well(&format!("{command} --quantity total --json"));
    let rows: Vec<Value> = serde_json::from_str(&total).unwrap();
    assert!((rows[1]["radiance"][0].as_f64().unwrap() - OPEN).abs() < 0.01, "a ball far off adds little: {total}");
}

#[test]
fn diff_tells_pictures_and_directories_apart() {
    let bench = Bench::new();
    let run = |out: &str, order: u32| {
        bench.well(&format!(
            "run --scene tiny.toml --method shexp/hyb --set order={order} --reference truth --out {out}"
        ));
        format!("{out}/images/{}.exr", of_kind(&bench.lines(out), "run")[0]["image"].as_str().unwrap())
    };
    let (a, b, c) = (run("a", 4), run("b", 4), run("c", 2));
    assert!(bench.well("diff a b").contains(": same"));
    assert!(bench.well(&format!("diff {a} {b}")).contains(": same"));

    let said = bench.halflight(&format!("diff {a} {c}"));
    assert!(said.code == 1 && said.out.contains("DIFFERS: RMSE") && said.out.contains("flip"), "{}", said.out);
    assert!(bench.well(&format!("diff {a} {c} --tolerance 0.9")).contains(": same"));
    let said = bench.halflight("diff a c");
    assert!(said.code == 1 && said.out.contains("only in a") && said.out.contains("only in c"), "{}", said.out);
}

#[test]
fn report_is_made_again() {
    let bench = Bench::new();
    bench.well("run --scene tiny.toml --method shexp/hyb --out out");
    let page = bench.path("out/report.html");
    std::fs::remove_file(&page).unwrap();
    assert!(bench.well("report --out out").contains("out/report.html"));
    assert!(page.is_file());
    let said = bench.halflight("report --out nowhere");
    assert!(said.code == 2 && said.err.contains("nowhere"), "{}", said.err);
}

#[test]
fn doctor_verifies_the_shipped_scenes() {
    let bench = Bench::new();
    let told = bench.well("doctor --threads 1");
    for part in ["1 threads in use", "sphere-plane: whole", "rustc ", "cache/halflight", "OpenImageIO  "] {
        assert!(told.contains(part), "{part}: {told}");
    }
}
