//! Merging stores.

use halflight_results::{Calibration, Cell, Failure, Key, Layout, Picture, Record, Run, Score, Store, Times};
use std::fs;
use std::path::Path;

fn cell(seed: u64) -> Cell {
    Cell { scene: "bunny".into(), method: "shexp/hyb".into(), seed, ..Cell::default() }
}

fn picture(level: f32) -> Picture {
    Picture { layout: Layout::List(2), radiance: vec![glam::Vec3::splat(level); 2], valid: vec![true; 2] }
}

/// A run with a picture of this level, kept in the store, that counted so many products.
fn run(store: &mut Store, seed: u64, level: f32, counted: u64) -> Key {
    let image = store.write_picture(&picture(level)).unwrap();
    let counters = [("products".to_owned(), counted)].into();
    let run = Run { cell: cell(seed), receivers: 2, image: Some(image.clone()), counters, ..Run::default() };
    store.append(Record::Run(Box::new(run))).unwrap();
    image
}

fn score(store: &mut Store, seed: u64, image: &Key, rmse: f64) {
    let reference_image = store.write_picture(&picture(9.0)).unwrap();
    let score = Score {
        run: cell(seed).key(),
        image: image.clone(),
        reference: "truth".into(),
        reference_key: Key::of_bytes(b"reference"),
        reference_image,
        metrics: 1,
        receivers: 2,
        resolved: true,
        measures: [("rmse".to_owned(), rmse)].into(),
    };
    store.append(Record::Score(score)).unwrap();
}

fn times(store: &mut Store, seed: u64, taken: u64) {
    let (phases, calibration) = (Default::default(), Calibration::default());
    let times = Times { run: cell(seed).key(), taken, beside: 1, phases, calibration };
    store.append(Record::Times(Box::new(times))).unwrap();
}

fn failure(store: &mut Store, seed: u64) {
    store.append(Record::Failure(Failure { cell: cell(seed), error: "it broke".into() })).unwrap();
}

fn stores(dir: &Path) -> [Store; 3] {
    ["a", "b", "out"].map(|name| Store::open(dir.join(name)).unwrap())
}

fn counted(store: &Store, seed: u64) -> u64 {
    store.run(&cell(seed).key()).unwrap().counters["products"]
}

#[test]
fn everything_is_there_once_and_again_adds_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let [mut a, mut b, mut out] = stores(dir.path());
    let one = run(&mut a, 1, 0.1, 0);
    score(&mut a, 1, &one, 0.5);
    failure(&mut a, 3);
    let two = run(&mut b, 2, 0.2, 0);
    score(&mut b, 2, &two, 0.6);
    run(&mut b, 1, 0.1, 0);
    score(&mut b, 1, &one, 0.5);

    let first = out.merge(&a).unwrap();
    assert_eq!((first.cells, first.scores, first.images), (2, 1, 2));
    let second = out.merge(&b).unwrap();
    assert_eq!((second.cells, second.scores, second.images), (1, 1, 1));
    assert!(second.conflicts.is_empty() && second.missing.is_empty());
    let out = &mut Store::open(out.dir()).unwrap();
    assert_eq!(out.outcomes().count(), 3);
    assert_eq!(out.read_picture(&two).unwrap(), picture(0.2));
    assert_eq!(out.scores(&cell(1).key()).len(), 1);

    let before = fs::read(out.path()).unwrap();
    for from in [&a, &b] {
        assert_eq!(out.merge(from).unwrap(), Default::default());
    }
    assert_eq!(fs::read(out.path()).unwrap(), before);
}

#[test]
fn the_better_outcome_stays_and_between_equals_the_first() {
    let dir = tempfile::tempdir().unwrap();
    let [mut a, mut b, mut out] = stores(dir.path());
    failure(&mut a, 1);
    run(&mut b, 1, 0.1, 7);
    run(&mut a, 2, 0.1, 7);
    failure(&mut b, 2);
    run(&mut a, 3, 0.1, 7);
    run(&mut b, 3, 0.1, 8);
    // The run that came first has lost its picture.
    let lost = run(&mut a, 4, 0.4, 8);
    run(&mut b, 4, 0.4, 7);
    fs::remove_file(a.image_path(&lost)).unwrap();
    let missing = out.merge(&a).unwrap().missing;
    assert!(missing.len() == 1 && missing[0].contains("bunny · shexp/hyb"), "{missing:?}");
    out.merge(&b).unwrap();
    assert_eq!([1, 2, 3, 4].map(|seed| counted(&out, seed)), [7; 4]);
    assert!(out.has_image(&lost));
}

#[test]
fn different_pictures_or_scores_under_one_key_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let [mut a, mut b, mut out] = stores(dir.path());
    let one = run(&mut a, 1, 0.1, 0);
    let other = run(&mut b, 1, 0.2, 0);
    score(&mut b, 1, &other, 0.6);
    let same = run(&mut a, 2, 0.1, 0);
    run(&mut b, 2, 0.1, 0);
    score(&mut a, 2, &same, 0.5);
    score(&mut b, 2, &same, 0.6);
    out.merge(&a).unwrap();
    let told = out.merge(&b).unwrap().conflicts;
    assert!(told.len() == 2 && told[0].contains("pictures") && told[1].contains("`truth`"), "{told:?}");
    assert_eq!(out.run(&cell(1).key()).unwrap().image, Some(one));
    assert!(out.scores(&cell(1).key()).is_empty(), "a score of the picture that did not stay");
    assert_eq!(out.scores(&cell(2).key())[0].measures["rmse"], 0.5);
}

#[test]
fn a_damaged_picture_is_not_copied() {
    let dir = tempfile::tempdir().unwrap();
    let [mut a, _, mut out] = stores(dir.path());
    let image = run(&mut a, 1, 0.1, 0);
    fs::write(a.image_path(&image), b"no picture").unwrap();
    let merged = out.merge(&a).unwrap();
    assert!(merged.missing[0].contains("damaged"), "{:?}", merged.missing);
    assert!(!out.image_path(&image).exists());
    assert_eq!(merged.cells, 1, "its times and counters are worth keeping");
}

#[test]
fn times_are_taken_over_where_there_are_none() {
    let dir = tempfile::tempdir().unwrap();
    let [mut a, mut b, mut out] = stores(dir.path());
    for (store, level, taken) in [(&mut a, 0.1, 5), (&mut b, 0.1, 7)] {
        run(store, 1, level, 0);
        times(store, 1, taken);
    }
    assert_eq!(out.merge(&a).unwrap().times, 1);
    assert_eq!((out.merge(&b).unwrap().times, out.merge(&a).unwrap().times), (0, 0));
    assert_eq!(out.times(&cell(1).key()).unwrap().taken, 5);
}
