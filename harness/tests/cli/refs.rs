//! References by themselves: made, gone on with after a kill, checked, listed, cleared away.

use crate::bench::{Bench, SCENE, Said};
use halflight_references::ReferenceStore;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::{Duration, SystemTime};

const TINY: &str = "--scene tiny.toml --method shexp/hyb";
const STORE: &str = "cache/halflight/references";

fn json(said: &str) -> Vec<Value> {
    serde_json::from_str(said).unwrap()
}

/// The references that are needed for the tiny scene as `refs check` sees them, and how it ended.
fn checked(bench: &Bench, options: &str) -> (i32, Vec<Value>) {
    let Said { code, out, .. } = bench.halflight(&format!("refs check {options} --json"));
    (code, json(&out))
}

fn states(rows: &[Value]) -> Vec<&str> {
    rows.iter().map(|row| row["state"].as_str().unwrap()).collect()
}

fn file(bench: &Bench, row: &Value) -> PathBuf {
    bench.path(STORE).join(format!("{}.exr", row["key"].as_str().unwrap()))
}

#[test]
fn what_a_run_needs_is_made_once_and_serves_the_run() {
    let bench = Bench::new();
    let (code, rows) = checked(&bench, TINY);
    assert_eq!((code, states(&rows)), (1, vec!["missing"; 3]));
    assert!(!bench.path("cache").exists(), "a check wrote something");
    let said = bench.halflight(&format!("refs check {TINY}"));
    assert!(said.err.contains("3 of 3 references are not there") && said.err.contains("refs build"), "{}", said.err);
    assert!(said.out.contains("tiny · sh-light:4 · direct: missing"), "{}", said.out);

    assert!(bench.well(&format!("refs build {TINY}")).contains("3 references made, 0 were there, 0 failed"));
    let before = bench.files(STORE);
    assert!(bench.well(&format!("refs build {TINY}")).contains("0 references made, 3 were there, 0 failed"));
    assert!(bench.well(&format!("run {TINY} --out out")).contains("0 references made, 3 scores added"));
    assert!(bench.files(STORE) == before, "something was made again");

    let (code, rows) = checked(&bench, TINY);
    assert_eq!((code, states(&rows)), (0, vec!["present"; 3]));
    let achieved = &rows[0]["achieved"];
    assert_eq!((achieved["sampled"].as_u64(), achieved["above_target"].as_u64()), (Some(12), Some(0)));
    let error = achieved["standard_error"].as_f64().unwrap();
    assert!(error > 0.0 && error < 0.015, "{error}");
    // Another quality is another reference.
    assert_eq!(checked(&bench, &format!("{TINY} --samples 128")).0, 1);
}

#[test]
fn named_references_are_made_of_any_quantity() {
    let bench = Bench::new();
    let some = "--scene tiny.toml --quantity total --reference truth --samples 128";
    assert!(bench.well(&format!("refs build {some}")).contains("1 references made"));
    assert_eq!(checked(&bench, some).1[0]["achieved"]["samples"], 12 * 128);
    // No method has pictures of it, so a run needs none.
    assert!(bench.well("refs build --scene tiny.toml --quantity total").contains("0 references made, 0 were there"));
}

#[test]
fn a_killed_build_goes_on_to_the_same_bytes() {
    let bench = Bench::new();
    bench.write("many.toml", &SCENE.replace("resolution = [4, 3]", "resolution = [60, 50]"));
    let build = "refs build --scene many.toml --reference truth --samples 2048 --threads 1";
    bench.well(&format!("{build} --cache whole"));

    let mut child = bench.command(&format!("{build} --cache killed")).stderr(Stdio::null()).spawn().unwrap();
    let begun = || {
        let file = std::fs::read_dir(bench.path("killed/references")).ok()?.next()?.ok()?.path();
        (file.extension()? == "begun" && file.metadata().ok()?.len() > 4096).then_some(file)
    };
    let left = loop {
        match begun() {
            Some(file) => break file,
            None => assert_eq!(child.try_wait().unwrap(), None, "it ended before it could be killed"),
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    child.kill().unwrap();
    child.wait().unwrap();

    let check = "--scene many.toml --reference truth --samples 2048 --cache killed";
    let (code, rows) = checked(&bench, check);
    let done = rows[0]["done"].as_u64().unwrap();
    assert_eq!((code, states(&rows)), (1, vec!["begun"]));
    assert!((256..3000).contains(&done), "{done}");
    let listed = bench.well("refs list --cache killed");
    assert!(listed.contains(&format!("begun: {done} of 3000 receivers")), "{listed}");
    assert!(bench.well("refs prune --cache killed").starts_with("0 files"), "what goes on was cleared away");
    let held = std::fs::File::open(&left).unwrap();
    held.lock().unwrap();
    assert!(bench.well("refs prune --all --cache killed").starts_with("0 files"), "what is in use was cleared away");
    drop(held);
    assert!(bench.well("refs prune --all --cache killed --dry-run").contains("begun: not needed"));

    bench.well(&format!("{build} --cache killed"));
    assert!(!left.exists());
    let content = |cache: &str| {
        let files = bench.files(&format!("{cache}/references"));
        files.into_iter().map(|(path, bytes, _)| (path.file_name().unwrap().to_owned(), bytes)).collect::<Vec<_>>()
    };
    assert_eq!(content("whole").len(), 1);
    assert!(content("whole") == content("killed"), "the bytes differ");
}

#[test]
fn a_damaged_one_is_found_and_a_failing_one_does_not_stop_the_others() {
    let bench = Bench::new();
    bench.well(&format!("refs build {TINY}"));
    let (_, rows) = checked(&bench, TINY);
    let [first, second, third] = [0, 1, 2].map(|i| file(&bench, &rows[i]));
    let whole = std::fs::read(&first).unwrap();
    let mut damaged = whole.clone();
    damaged[whole.len() / 2] ^= 1;
    std::fs::write(&first, damaged).unwrap();
    std::fs::remove_file(&third).unwrap();
    let (code, rows) = checked(&bench, TINY);
    assert_eq!((code, states(&rows)), (1, vec!["damaged", "present", "missing"]));
    // A whole file under another's name is no reference.
    std::fs::copy(&second, &third).unwrap();
    assert_eq!(states(&checked(&bench, TINY).1), ["damaged", "present", "damaged"]);
    std::fs::remove_file(&third).unwrap();

    // In the place of the second there is what cannot be replaced.
    std::fs::remove_file(&second).unwrap();
    std::fs::create_dir_all(second.join("in the way")).unwrap();
    let said = bench.halflight(&format!("refs build {TINY}"));
    assert!(said.code == 1 && said.out.contains("2 references made, 0 were there, 1 failed"), "{}", said.out);
    assert!(said.err.contains("sh-light:4 · direct … FAILED: reference store: "), "{}", said.err);
    assert_eq!(states(&checked(&bench, TINY).1), ["present", "damaged", "present"]);
    assert!(std::fs::read(&first).unwrap() == whole);
}

#[test]
fn statistics_find_what_a_checksum_does_not() {
    let bench = Bench::new();
    let build = format!("{TINY} --samples 4096");
    bench.well(&format!("refs build {build}"));
    let check = format!("{build} --statistics");
    let (code, rows) = checked(&bench, &check);
    assert_eq!(code, 0, "{rows:?}");
    assert!(rows.iter().all(|row| row["agrees"] == true && row["p"].as_f64().unwrap() > 1e-4), "{rows:?}");

    // A fifth brighter at a single receiver, and whole.
    let store = ReferenceStore::open(bench.path(STORE)).unwrap();
    let (mut estimate, provenance) = store.get_with_provenance(rows[1]["key"].as_str().unwrap()).unwrap();
    let brightest = (0..12).max_by(|a, b| estimate.variance[*a].x.total_cmp(&estimate.variance[*b].x)).unwrap();
    estimate.mean[brightest] *= 1.2;
    let layout = halflight_scenes::Layout::Image { width: 4, height: 3 };
    store.put(&estimate, layout, &provenance).unwrap();
    assert_eq!(checked(&bench, &build).0, 0, "the file is whole");
    let (code, rows) = checked(&bench, &check);
    let agree: Vec<_> = rows.iter().map(|row| row["agrees"].as_bool().unwrap()).collect();
    assert_eq!((code, agree), (1, vec![true, false, true]), "{rows:?}");
}

#[test]
fn the_list_tells_where_files_come_from() {
    let bench = Bench::new();
    assert_eq!(bench.well("refs list"), "0 files, 0 B\n");
    bench.well(&format!("refs build {TINY}"));
    let rows = json(&bench.well("refs list --json"));
    assert_eq!(rows.len(), 3);
    let truth = rows.iter().find(|row| row["provenance"]["reference"] == "truth").unwrap();
    assert_eq!((&truth["state"], &truth["current"]), (&"whole".into(), &true.into()));
    assert_eq!((&truth["provenance"]["scene"], &truth["provenance"]["receivers"]), (&"tiny".into(), &12.into()));
    let size = bench.path(STORE).join(truth["file"].as_str().unwrap()).metadata().unwrap().len();
    assert_eq!(truth["bytes"], size);
    let listed = bench.well("refs list");
    assert!(listed.contains("tiny · sphere-proxies:32 · direct · frame 0, seed 1, "), "{listed}");
}

#[test]
fn prune_leaves_what_is_current() {
    let bench = Bench::new();
    bench.well(&format!("refs build {TINY}"));
    let current = bench.files(STORE);
    let folder = bench.path(STORE);
    let store = ReferenceStore::open(&folder).unwrap();
    let key = json(&bench.well("refs list --json"))[0]["provenance"]["key"].as_str().unwrap().to_owned();

    let (estimate, mut provenance) = store.get_with_provenance(&key).unwrap();
    (provenance.revision, provenance.key) = ("another".into(), "outdated".into());
    store.put(&estimate, halflight_scenes::Layout::List, &provenance).unwrap();
    std::fs::write(folder.join("damaged.exr"), "x").unwrap();
    std::fs::write(folder.join("damaged.begun"), "x").unwrap();
    for (name, age) in [("abandoned.partial-1-0", 3600), ("writing.partial-2-0", 1)] {
        let file = std::fs::File::create(folder.join(name)).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
    }
    std::fs::write(folder.join("notes.txt"), "mine").unwrap();
    let all = bench.files(STORE);
    let names =
        |said: &str| said.lines().filter_map(|line| Some(line.split_once(": ")?.0.to_owned())).collect::<Vec<_>>();
    let gone = ["abandoned.partial-1-0", "damaged.begun", "damaged.exr", "outdated.exr"];

    let said = bench.well("refs prune --dry-run");
    assert!(names(&said) == gone && said.contains("would be cleared away"), "{said}");
    assert!(bench.files(STORE) == all, "a dry run cleared something away");
    let said = bench.well("refs prune");
    assert!(names(&said) == gone && said.ends_with(" B cleared away\n"), "{said}");
    let left: Vec<_> = bench.files(STORE).into_iter().map(|(path, ..)| path).collect();
    assert_eq!(left.len(), current.len() + 2);
    assert!(current.iter().all(|(path, ..)| left.contains(path)));

    // Of a suite that needs the truth alone, with --all.
    let suite = "about = ''\n[[entry]]\nscenes = ['tiny.toml']\nmethods = ['shexp/hyb']\nreferences = ['truth']\n";
    bench.write("suite.toml", suite);
    let said = bench.well("refs prune --all --suite suite.toml");
    assert_eq!(said.matches(": not needed").count(), 2, "{said}");
    assert_eq!(states(&checked(&bench, TINY).1), ["present", "missing", "missing"]);
    assert!(bench.path(STORE).join("notes.txt").exists());
}
