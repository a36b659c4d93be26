//! Sweeps: what is written, what is shared, and that sharing changes nothing.

use crate::bench::{Bench, SCENE, methods, of_kind};
use serde_json::Value;

fn label(run: &Value) -> String {
    ["method", "params", "frame"].iter().map(|field| run[field].to_string()).collect()
}

#[test]
fn retuned_cells_equal_fresh_ones_and_name_who_prepared() {
    let bench = Bench::new();
    let moving =
        SCENE.replace("albedo", "motion = [{ time = 0.0 }, { time = 1.0, translate = [1.0, 0.0, 0.0] }]\nalbedo");
    bench.write("moving.toml", &format!("{moving}\n[frames]\ncount = 2\nfps = 1.0\n"));
    let what = |out: &str| format!("run --method shexp/hyb --method sh-product/ordered --reference truth --out {out}");
    let scenes = "--scene tiny.toml --scene moving.toml";
    // What needs a new `prepare` varies fastest, and yet its settings come in a row.
    bench.well(&format!(
        "{} {scenes} --set self-shadow=all --set min-angle=lin(0..20,2) --set order=2,4",
        what("swept")
    ));
    for rule in ["paper", "continuous", "off"] {
        for angle in ["0", "20"] {
            for scene in ["tiny.toml", "moving.toml"] {
                let set = format!("--set self-shadow={rule} --set min-angle={angle}");
                bench.well(&format!("{} --scene {scene} {set} --set order=2", what("fresh")));
                bench.well(&format!("{} --scene {scene} {set} --set order=4", what("fresh")));
            }
        }
    }
    let (swept, fresh) = (bench.lines("swept"), bench.lines("fresh"));
    let (swept, fresh) = (of_kind(&swept, "run"), of_kind(&fresh, "run"));
    assert_eq!((swept.len(), fresh.len()), (2 * 12 * 3, 2 * 12 * 3));
    // A setting that were not taken would show: each differs from the one before it.
    for pair in swept.windows(2).filter(|pair| pair[1]["shared"]["prepare"].is_string() && pair[1]["frame"] == 0) {
        assert!(pair[0]["frame"] == 1 || pair[0]["image"] != pair[1]["image"], "{}", label(pair[1]));
    }
    let mut sharing = 0;
    for run in &swept {
        let same = fresh.iter().find(|other| other["key"] == run["key"]).unwrap();
        for field in ["image", "counters", "footprint", "receivers"] {
            assert_eq!(run[field], same[field], "{field} of {}", label(run));
        }
        let names =
            |run: &Value, field: &str| run[field].as_object().map_or(Vec::new(), |f| f.keys().cloned().collect());
        assert_eq!(names(run, "derived"), names(same, "derived"));
        let shared = run["shared"].as_object();
        for phase in ["prepare", "update"] {
            let Some(bearer) = shared.and_then(|shared| shared.get(phase)) else { continue };
            sharing += usize::from(phase == "prepare");
            let bearer = swept.iter().find(|other| other["key"] == *bearer).unwrap();
            for field in ["scene_hash", "method"] {
                assert_eq!(bearer[field], run[field]);
            }
            assert_eq!(bearer["params"]["order"], run["params"]["order"]);
        }
    }
    // One in a scene, method and order is prepared.
    assert_eq!(sharing, swept.len() - 2 * 2 * 2);
    assert!(fresh.iter().all(|run| run["frame"] == 1 || run["shared"].is_null()));
}

#[test]
fn a_sweep_is_checked_before_any_work() {
    let bench = Bench::new();
    for (set, parts) in [
        ("ordre=2..4", ["unknown parameter `ordre`", "order"]),
        ("order=2..12", ["shexp/hyb: parameter order", "expected an integer from 1 to 8, found \"9\""]),
        ("min-angle=log(0..4,3)", ["--set min-angle=log(0..4,3)", "0 < A < B"]),
        ("self-shadow=lin(0..1,2)", ["parameter self-shadow", "expected one of continuous"]),
        ("spheres=all", ["parameter spheres", "expected an integer from 1 to"]),
    ] {
        let said = bench.halflight(&format!("run --scene tiny.toml --method shexp/hyb --set {set} --out out"));
        assert_eq!(said.code, 2, "{set}: {}", said.err);
        assert!(parts.iter().all(|part| said.err.contains(part)), "{set}: {}", said.err);
        bench.write("wrong.toml", &suite(set));
        let said = bench.halflight("run --suite wrong.toml --out out");
        assert_eq!(said.code, 2, "{set}: {}", said.err);
        let part = parts[1];
        assert!(said.err.contains(part), "{set}: {}", said.err);
    }
    assert!(!bench.path("out").exists());
}

#[test]
fn a_suite_file_sweeps_as_the_command_line_does() {
    let bench = Bench::new();
    let set = ["order=2..3", "spheres=log(1..16,3)", "self-shadow=all"];
    let given: String = set.iter().map(|set| format!(" --set {set}")).collect();
    let told = bench.well(&format!("plan --scene tiny.toml --method shexp/hyb{given}"));
    bench.write("sweep.toml", &suite(&set.join(";")));
    let mut planned: Vec<String> = bench.well("plan --suite sweep.toml").lines().map(str::to_owned).collect();
    let mut expected: Vec<String> = told.lines().map(str::to_owned).collect();
    planned.sort();
    expected.sort();
    assert_eq!(planned, expected);
    assert_eq!(told.lines().count(), 18 + 1);
}

#[test]
fn suites_tell_their_cells_and_name_families() {
    let bench = Bench::new();
    let told = bench.well("list suites --out out");
    for part in ["quick ", "full ", "paper/shexp ", "(28 cells, 28 to run, of unknown time)"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert!(!bench.path("out").exists());
    let whole = halflight::Suite::find("full").unwrap();
    let plan = |methods: &str| {
        bench.write("families.toml", &suite("order=3").replace("'shexp/hyb'", methods));
        bench.well("plan --suite families.toml").lines().count() - 1
    };
    let ids = || halflight_registry::methods().into_iter().map(|method| method.info().id);
    assert_eq!(plan("'shexp/*'"), ids().filter(|id| id.starts_with("shexp/")).count());
    assert_eq!(plan("'all'"), ids().count());
    assert!(whole.entries.iter().any(|entry| entry.scenes == ["all"] && entry.methods == ["all"]));
    let said = bench.halflight("plan --scene tiny.toml --method nobody/*");
    assert!(said.code == 2 && said.err.contains("unknown method `nobody/*`"), "{}", said.err);
}

#[test]
fn fronts_are_printed_and_told_apart() {
    let bench = Bench::new();
    bench.write("other.toml", &SCENE.replace("radius = 0.5", "radius = 0.8"));
    bench.well("run --scene tiny.toml --scene other.toml --set order=2..3 --reference truth --out out");
    let told = bench.well("pareto --out out --all");
    assert_eq!(told.matches("direct · over tiny, other (geometric means of ratios to").count(), 2, "{told}");
    for part in ["direct · tiny: error against shade time", "direct · other: error against memory held", "★"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert_eq!(told.lines().filter(|line| line.contains("  RMSE ")).count(), 6 * 2 * methods().len());
    let one = bench.well("pareto --out out --scene tiny --quantity direct --against memory");
    assert!(one.starts_with("direct · tiny: error against memory held; ") && !one.contains("over"), "{one}");
    for (what, part) in [
        ("--scene tinny", "expected one of tiny, other"),
        ("--base nobody", "unknown setting `nobody`"),
        ("--quantity total", "expected scored runs"),
    ] {
        let said = bench.halflight(&format!("pareto --out out {what}"));
        assert!(said.code == 2 && said.err.contains(part), "{what}: {}", said.err);
    }
    assert!(bench.well("report --out out").contains("direct · tiny: error against shade time"));
}

/// A suite with these settings, separated by semicolons.
fn suite(set: &str) -> String {
    let set: Vec<String> = set
        .split(';')
        .filter_map(|set| set.split_once('='))
        .map(|(name, values)| format!("{name} = '{values}'"))
        .collect();
    format!("about = 'x'\n[[entry]]\nscenes = ['tiny.toml']\nmethods = ['shexp/hyb']\nset = {{ {} }}\n", set.join(", "))
}
