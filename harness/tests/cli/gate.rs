//! `halflight gate` and `halflight bless`.

use crate::bench::{Bench, of_kind};
use halflight::Suite;
use std::collections::HashSet;

const SUITE: &str = r#"
about = "a test"

[[entry]]
scenes = ["tiny.toml"]
methods = ["sh-product/ordered", "shexp/hyb"]
references = ["truth"]

[[entry]]
scenes = ["tiny.toml"]
methods = ["shexp/hyb"]
set = { order = 2 }
references = ["sh-light"]
"#;

/// A folder with a suite and its baselines in `b`.
fn blessed() -> Bench {
    let bench = Bench::new();
    bench.write("mine.toml", SUITE);
    bench.well("bless --suite mine.toml --out out --baselines b");
    bench
}

const GATE: &str = "gate --suite mine.toml --out out --baselines b";

#[test]
fn what_was_blessed_passes() {
    let bench = Bench::new();
    bench.write("mine.toml", SUITE);
    let said = bench.halflight(GATE);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("b/mine.json: no baselines; `halflight bless` makes them"), "{}", said.err);

    let told = bench.well("bless --suite mine.toml --out out --baselines b");
    assert!(told.contains("tiny · shexp/hyb order=2 · direct: new"), "{told}");
    assert!(told.contains("b/mine.json: 3 cells"), "{told}");
    let before = bench.files("b");
    // From another store and an empty cache, on other threads.
    for command in [GATE, "gate --suite mine.toml --out other --cache empty --baselines b --threads 1 --strict"] {
        let told = bench.well(command);
        assert!(told.contains("gate passed: 3 cells and 2 references") && told.contains("0 fail"), "{told}");
    }
    assert!(bench.well("bless --suite mine.toml --out out --baselines b").contains("3 cells, 0 changes"));
    assert_eq!(bench.files("b"), before);
}

#[test]
fn a_failure_says_what_was_expected_and_how_to_see_it_again() {
    let bench = blessed();
    // A bluer sky: the scene keeps its name.
    bench.write("tiny.toml", &crate::bench::SCENE.replace("1.0, 0.9, 0.8", "1.0, 0.9, 1.0"));
    let said = bench.halflight(GATE);
    assert_eq!(said.code, 1, "{}", said.out);
    let line = said
        .out
        .lines()
        .find(|line| line.contains("FAILS: tiny · shexp/hyb order=2 · direct: picture, block"))
        .unwrap();
    assert!(
        line.contains("blue: expected 0.") && line.contains("(+25.0") && line.contains("12 means are off"),
        "{line}"
    );
    assert!(line.ends_with("[halflight run --scene tiny.toml --method shexp/hyb --set order=2]"), "{line}");
    let reference = said.out.lines().find(|line| line.contains("FAILS: tiny · truth · direct: reference, ")).unwrap();
    assert!(reference.ends_with("[halflight refs build --scene tiny.toml --reference truth]"), "{reference}");
    assert!(said.out.contains("gate FAILED"), "{}", said.out);
    // The command is one that works.
    let command = line.split_once("[halflight ").unwrap().1.trim_end_matches(']');
    bench.well(&format!("{command} --reference sh-light --out out"));

    let told = bench.well("bless --suite mine.toml --out out --baselines b");
    assert!(told.contains("12 of 36 block means differ, by +25.0"), "{told}");
    bench.well(GATE);
}

#[test]
fn what_is_new_or_gone_fails() {
    let bench = blessed();
    bench.write("mine.toml", &SUITE.replace("order = 2", "order = 3"));
    let said = bench.halflight(GATE);
    assert_eq!(said.code, 1);
    for part in [
        "FAILS: tiny · shexp/hyb order=3 · direct: no baseline; if it is right, `halflight bless`",
        "FAILS: tiny · sh-light:3 · direct: no baseline",
        "FAILS: tiny · shexp/hyb order=2 · direct: expected by the baselines, not found",
        "FAILS: tiny · sh-light:2 · direct: expected by the baselines, not found",
    ] {
        assert!(said.out.contains(part), "{part}: {}", said.out);
    }
}

#[test]
fn a_part_is_held_against_its_part() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("b")).unwrap();
    let all = "--scene tiny.toml --method shexp/hyb --method shexp/eigen --reference truth --out out --baselines b";
    bench.well(&format!("bless {all}"));
    assert!(bench.path("b/gate.json").exists());
    let part = "gate --scene tiny.toml --method shexp/hyb --reference truth --out out --baselines b";
    assert!(bench.well(part).contains("1 cells and 1 references"));
    let said = bench.halflight(&format!("{part} --method sh-product/ordered"));
    assert!(said.code == 1 && said.out.contains("sh-product/ordered · direct: no baseline"), "{}", said.out);
    // Blessing a part keeps the rest.
    bench.well("bless --scene tiny.toml --method sh-product/ordered --reference truth --out out --baselines b");
    assert!(bench.well(&format!("gate {all}")).contains("2 cells and 1 references"));
}

#[test]
fn what_cannot_be_measured_is_not_blessed() {
    let bench = Bench::new();
    bench.write("dark.toml", &crate::bench::SCENE.replace("1.0, 0.9, 0.8", "0.0, 0.0, 0.0"));
    let said = bench.halflight("bless --scene dark.toml --method shexp/hyb --reference truth --out out --baselines b");
    assert_eq!(said.code, 2, "{}{}", said.out, said.err);
    assert!(said.err.contains("nothing blessed") && !bench.path("b").exists(), "{}", said.err);
    // Nothing to measure: terrain is left to other methods.
    let none = "--scene trench --method shexp/hyb --reference truth --out out --baselines b";
    let said = bench.halflight(&format!("bless {none}"));
    assert!(said.code == 2 && said.err.contains("expected at least one cell"), "{}", said.err);
    assert!(!of_kind(&bench.lines("out"), "skip").is_empty());
}

#[test]
fn the_shipped_suite_has_every_method_at_its_defaults() {
    let suite = Suite::find("gate").unwrap();
    let plain = suite.entries.iter().filter(|entry| entry.set.is_empty());
    let gated: HashSet<&str> = plain.flat_map(|entry| entry.methods.iter().map(String::as_str)).collect();
    for method in halflight_registry::methods() {
        let id = method.info().id;
        let family = format!("{}/*", id.split('/').next().unwrap_or(id));
        assert!(
            gated.contains(id) || gated.contains(&*family),
            "{id} is not gated: add it to harness/suites/gate.toml and `halflight bless`"
        );
    }
}

/// Every kind of failure by a part of what is said, with the place in the baselines that was changed for it.
const FAILURES: [(&str, &str); 9] = [
    ("shexp/hyb · direct: picture, block", "cells"),
    ("shexp/hyb · direct: memory", "cells"),
    ("shexp/hyb · direct: work", "cells"),
    ("shexp/hyb · direct: valid receivers", "cells"),
    ("truth · direct: reference of the same key", "references"),
    ("shexp/ps-star · direct: no baseline", "cells"),
    ("shexp/hyb order=3 · direct: expected by the baselines, not found", "cells"),
    ("sh-light:3 · direct: expected by the baselines, not found", "references"),
    ("shexp/hyb: shading time over", "paces"),
];

#[test]
fn every_kind_of_failure_comes_with_a_command_that_works() {
    let bench = Bench::new();
    // Large enough to take a time that counts.
    bench.write("large.toml", &crate::bench::SCENE.replace("[4, 3]", "[320, 240]"));
    let methods = "--method sh-product/ordered --method shexp/hyb --method shexp/ps-star";
    let what = format!("--scene large.toml {methods} --reference truth --samples 64 --out out --baselines b");
    bench.well(&format!("bless {what}"));
    let text = std::fs::read_to_string(bench.path("b/gate.json")).unwrap();
    let mut baselines: serde_json::Value = serde_json::from_str(&text).unwrap();
    let hyb = baselines["cells"]["large · shexp/hyb · direct"].clone();
    let truth = baselines["references"]["large · truth · direct"].clone();
    let cells = baselines["cells"].as_object_mut().unwrap();
    cells.remove("large · shexp/ps-star · direct").unwrap();
    cells.insert("large · shexp/hyb order=3 · direct".into(), hyb);
    let wrong = &mut cells["large · shexp/hyb · direct"];
    wrong["receivers"] = 7.into();
    wrong["blocks"][3][0] = 9.into();
    for field in ["memory", "work"] {
        *wrong[field].as_object_mut().unwrap().values_mut().next().unwrap() = 1.into();
    }
    let references = baselines["references"].as_object_mut().unwrap();
    references.insert("large · sh-light:3 · direct".into(), truth);
    references["large · truth · direct"]["blocks"][3][0][0] = 9.into();
    baselines["paces"]["shexp/hyb"] = 0.01.into();
    bench.write("b/gate.json", &baselines.to_string());
    // Not as a part, of which nothing is missed.
    let references = "references = [\"truth\"]";
    let methods = "methods = [\"sh-product/ordered\", \"shexp/hyb\", \"shexp/ps-star\"]";
    bench
        .write("gate.toml", &format!("about = \"x\"\n[[entry]]\nscenes = [\"large.toml\"]\n{methods}\n{references}\n"));
    let said = bench.halflight("gate --suite gate.toml --samples 64 --out out --baselines b");
    assert_eq!(said.code, 1, "{}", said.err);
    let mut commands = HashSet::new();
    for (part, place) in FAILURES {
        let line = said.out.lines().find(|line| line.contains(&format!("FAILS: large · {part}")));
        let line = line.or_else(|| said.out.lines().find(|line| line.contains(&format!("FAILS: {part}"))));
        let line = line.unwrap_or_else(|| panic!("{part} ({place}): {}", said.out));
        let command = line.rsplit_once(" [").unwrap().1.strip_suffix(']').unwrap();
        commands.insert(command.to_owned());
    }
    let nothing = "gate --scene trench --method shexp/hyb --reference truth --out out --baselines b";
    let said = bench.halflight(nothing);
    assert!(said.code == 1 && said.out.contains("the gate: expected at least one check"), "{}", said.out);
    let line = said.out.lines().find(|line| line.contains("FAILS: the gate")).unwrap();
    assert!(line.ends_with("[halflight plan --scene trench --method shexp/hyb --reference truth]"), "{line}");
    commands.insert(line.rsplit_once(" [").unwrap().1.trim_end_matches(']').to_owned());
    assert!(commands.len() >= 7, "{commands:?}");
    for command in commands.iter().flat_map(|command| command.split(" && ")) {
        // A name is all that baselines know of a scene.
        let command = command.strip_prefix("halflight ").unwrap().replace("--scene large ", "--scene large.toml ");
        let samples = if command.starts_with("plan") { "" } else { " --samples 64" };
        bench.well(&format!("{command}{samples}"));
    }
}

#[test]
fn instructions_are_skipped_without_valgrind() {
    let bench = blessed();
    let command =
        || bench.command(&format!("{GATE} --instructions")).env("PATH", bench.path("nowhere")).output().unwrap();
    let told = String::from_utf8(command().stdout).unwrap();
    assert!(told.contains("instructions are not counted: there is no valgrind"), "{told}");
    assert!(told.contains("gate passed"), "{told}");
}
