//! The store on disk: reading back, deletion, torn and corrupt lines, several writers.

use halflight_results::{
    Calibration, Cell, CrossCheck, Failure, Key, Phase, Record, Run, Score, Skip, Storage, Store, StoreError, Times,
    Timing,
};
use std::fs;

fn cell(seed: u64) -> Cell {
    Cell {
        scene: "bunny".into(),
        scene_hash: "5ce9e".into(),
        method: "shexp/hyb".into(),
        revision: "r1".into(),
        params: [("order".to_owned(), 4.into()), ("p".to_owned(), 0.1.into())].into(),
        backend: "cpu".into(),
        quantity: "direct".into(),
        seed,
        frame: 0,
        receivers_hash: "7ece1".into(),
        timed_on: Some("a machine".into()),
    }
}

fn run(seed: u64) -> Record {
    Record::Run(Box::new(Run {
        cell: cell(seed),
        receivers: 3,
        image: Some(Key::of_bytes(b"picture")),
        approximate: Some("a \"quoted\"\nreason".into()),
        shared: [("prepare".to_owned(), Key::of_bytes(b"another cell"))].into(),
        derived: [("spheres of bunny".to_owned(), 2.5e9)].into(),
        counters: [("products".to_owned(), u64::MAX)].into(),
        footprint: vec![Storage { purpose: "tables".into(), host_bytes: 1 << 40, device_bytes: 0 }],
        ..Run::default()
    }))
}

/// Times of a run, these in nanoseconds.
fn times(seed: u64, nanoseconds: Vec<f64>) -> Times {
    let calibration = Calibration { compute: vec![1.0 / 3.0], memory: vec![5e-324] };
    let phases = [("shade".to_owned(), Timing { phase: Phase::Shade, nanoseconds })].into();
    Times { run: cell(seed).key(), taken: 1 << 40, beside: 3, phases, calibration }
}

fn score(seed: u64, image: &[u8], rmse: f64) -> Record {
    Record::Score(Score {
        run: cell(seed).key(),
        image: Key::of_bytes(image),
        reference: "truth".into(),
        reference_key: Key::of_bytes(b"reference"),
        reference_image: Key::of_bytes(b"reference image"),
        metrics: 1,
        receivers: 3,
        resolved: true,
        measures: [("rmse".to_owned(), rmse)].into(),
    })
}

fn cross_check(quantity: &str, p: f64) -> CrossCheck {
    CrossCheck {
        scene: "bunny".into(),
        scene_hash: "5ce9e".into(),
        frame: 0,
        quantity: quantity.into(),
        program: "another".into(),
        samples: [4096, 1024],
        ours: Key::of_bytes(b"ours"),
        theirs: Key::of_bytes(b"theirs"),
        receiver_p: Key::of_bytes(b"p"),
        receivers: 3,
        largest: None,
        family_p: 0.3,
        bias: [1e-9, -1e-9, 0.0],
        bias_error: [1e-8; 3],
        bias_p: 0.9,
        level: 0.5,
        p,
        agrees: true,
    }
}

#[test]
fn of_equal_cross_checks_the_latest_counts() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    for check in [cross_check("direct", 0.1), cross_check("total", 0.2), cross_check("direct", 0.3)] {
        store.append(Record::CrossCheck(Box::new(check))).unwrap();
    }
    for store in [store, Store::open(dir.path()).unwrap()] {
        let kept: Vec<CrossCheck> = store.cross_checks().into_iter().cloned().collect();
        assert_eq!(kept, [cross_check("direct", 0.3), cross_check("total", 0.2)]);
        assert_eq!(store.outcomes().count(), 0, "a cross-check is no cell's outcome");
    }
}

fn all(store: &Store) -> Vec<Record> {
    store.outcomes().cloned().collect()
}

#[test]
fn every_kind_reads_back_as_itself() {
    let dir = tempfile::tempdir().unwrap();
    let skip = Record::Skip(Skip { cell: cell(2), reason: "no occluder".into() });
    let failure = Record::Failure(Failure { cell: cell(3), error: "it broke".into() });
    let mut store = Store::open(dir.path().join("not/yet/there")).unwrap();
    for record in [run(1), skip.clone(), failure.clone(), score(1, b"picture", 0.1 + 0.7)] {
        store.append(record).unwrap();
    }
    for store in [&store, &Store::open(store.dir()).unwrap()] {
        assert_eq!(all(store), [run(1), skip.clone(), failure.clone()]);
        let score = store.score(&cell(1).key(), &Key::of_bytes(b"reference"), 1).unwrap();
        assert_eq!(score.measures["rmse"].to_bits(), (0.1f64 + 0.7).to_bits());
        assert!(store.score(&cell(1).key(), &Key::of_bytes(b"reference"), 2).is_none());
        assert!(store.run(&cell(3).key()).is_none());
        assert!(store.warnings().is_empty());
    }
}

#[test]
fn samples_read_back_bit_for_bit() {
    let dir = tempfile::tempdir().unwrap();
    // A parser that is off by one unit in the last place is so for some values only: try many.
    let bits = (0..20_000u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 2);
    let nanoseconds: Vec<f64> = bits.map(f64::from_bits).filter(|v| v.is_finite()).collect();
    Store::open(dir.path()).unwrap().append(Record::Times(Box::new(times(1, nanoseconds.clone())))).unwrap();
    let store = Store::open(dir.path()).unwrap();
    assert!(store.times(&cell(1).key()).unwrap().phases["shade"].nanoseconds == nanoseconds);
}

#[test]
fn the_latest_times_of_a_run_count_and_its_outcome_stays() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    store.append(run(1)).unwrap();
    assert_eq!(store.times(&cell(1).key()), None);
    for nanoseconds in [vec![0.1 + 0.2, 123_456_789.123_456_78], vec![5e-324]] {
        let latest = times(1, nanoseconds);
        store.append(Record::Times(Box::new(latest.clone()))).unwrap();
        for store in [&store, &Store::open(dir.path()).unwrap()] {
            assert_eq!(store.times(&cell(1).key()), Some(&latest));
            assert_eq!((store.times(&cell(2).key()), store.outcomes().count()), (None, 1));
        }
    }
}

#[test]
fn lines_name_schema_kind_and_key() {
    let dir = tempfile::tempdir().unwrap();
    Store::open(dir.path()).unwrap().append(run(1)).unwrap();
    let text = fs::read_to_string(dir.path().join("results.jsonl")).unwrap();
    let line: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(line["schema"], 2);
    assert_eq!(line["kind"], "run");
    assert_eq!(line["key"], cell(1).key().as_str());
    assert_eq!(line["method"], "shexp/hyb");
}

#[test]
fn the_latest_line_of_a_key_wins() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    store.append(Record::Failure(Failure { cell: cell(1), error: "first".into() })).unwrap();
    store.append(run(2)).unwrap();
    store.append(run(1)).unwrap();
    store.append(score(1, b"picture", 1.0)).unwrap();
    store.append(score(1, b"picture", 2.0)).unwrap();
    store.append(score(1, b"an older picture", 3.0)).unwrap();
    assert_eq!(all(&store), [run(1), run(2)]);
    let scores = store.scores(&cell(1).key());
    assert_eq!(scores.iter().map(|s| s.measures["rmse"]).collect::<Vec<_>>(), [2.0]);
}

#[test]
fn deleting_one_line_makes_just_that_cell_missing() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    (1..=3).for_each(|seed| store.append(run(seed)).unwrap());
    let text = fs::read_to_string(store.path()).unwrap();
    let key = cell(2).key();
    let kept: String = text.lines().filter(|l| !l.contains(key.as_str())).flat_map(|l| [l, "\n"]).collect();
    fs::write(store.path(), kept).unwrap();
    let store = Store::open(dir.path()).unwrap();
    assert_eq!(all(&store), [run(1), run(3)]);
    assert!(store.outcome(&key).is_none());
}

#[test]
fn a_torn_last_line_loses_only_itself_wherever_it_is_cut() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("results.jsonl");
    let mut store = Store::open(dir.path()).unwrap();
    store.append(run(1)).unwrap();
    let first = fs::read(&path).unwrap().len();
    store.append(run(2)).unwrap();
    let whole = fs::read(&path).unwrap();
    for cut in first..whole.len() {
        fs::write(&path, &whole[..cut]).unwrap();
        let complete = cut == whole.len() - 1;
        let torn = cut > first && !complete;

        let mut store = Store::open(dir.path()).unwrap();
        assert_eq!(store.outcomes().count(), if complete { 2 } else { 1 }, "cut at {cut}");
        assert_eq!(store.warnings().len(), usize::from(torn), "cut at {cut}");
        store.append(run(3)).unwrap();

        let store = Store::open(dir.path()).unwrap();
        assert_eq!(store.outcomes().count(), if complete { 3 } else { 2 }, "cut at {cut}");
        assert!(store.warnings().is_empty(), "the torn line was not cut off at {cut}");
        assert_eq!(store.run(&cell(3).key()).map(|r| r.receivers), Some(3));
    }
    fs::write(&path, &whole[..first + 10]).unwrap();
    let warning = &Store::open(dir.path()).unwrap().warnings()[0].clone();
    assert!(warning.contains("results.jsonl, line 2"), "{warning}");
}

#[test]
fn a_corrupt_line_is_an_error_that_names_file_and_line() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    (1..=3).for_each(|seed| store.append(run(seed)).unwrap());
    let good = fs::read_to_string(store.path()).unwrap();
    let second = good.lines().nth(1).unwrap();
    let cases = [
        (second[..40].to_owned(), "EOF"),
        (second.replace("\"seed\":2", "\"seed\":7"), "key"),
        (second.replace("\"seed\":2", "\"seed\":-2"), "u64"),
        (second.replace("\"receivers\":3,", ""), "receivers"),
        (second.replace("\"kind\":\"run\"", "\"kind\":\"ran\""), "ran"),
        ("\u{0}\u{0}".into(), "expected value"),
    ];
    for (bad, part) in cases {
        assert_ne!(bad, second);
        fs::write(store.path(), good.replace(second, &bad)).unwrap();
        let error = Store::open(dir.path()).unwrap_err();
        assert!(matches!(error, StoreError::Corrupt { line: 2, .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains("results.jsonl, line 2") && text.contains(part), "{text}");
    }
}

#[test]
fn other_schemas_are_refused_by_name_and_left_alone() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    (1..=2).for_each(|seed| store.append(run(seed)).unwrap());
    let good = fs::read_to_string(store.path()).unwrap();
    let (first, second) = good.split_once('\n').unwrap();
    for (schema, part) in [(3, "a newer Halflight"), (1, "an older Halflight")] {
        // Without its line feed it is no torn line either.
        let other = format!("{first}\n{}", second.replace("\"schema\":2", &format!("\"schema\":{schema}")));
        for text in [&other, other.trim_end()] {
            fs::write(store.path(), text).unwrap();
            let error = Store::open(dir.path()).unwrap_err();
            assert!(matches!(error, StoreError::Schema { line: 2, found, .. } if found == schema), "{error}");
            assert!(error.to_string().contains(part) && error.to_string().contains("expected 2"), "{error}");
        }
    }
}

#[test]
fn a_store_learns_what_others_append() {
    let dir = tempfile::tempdir().unwrap();
    let (mut a, mut b) = (Store::open(dir.path()).unwrap(), Store::open(dir.path()).unwrap());
    a.append(run(1)).unwrap();
    assert!(b.outcome(&cell(1).key()).is_none());
    assert!(!b.refresh().unwrap());
    assert_eq!(all(&b), [run(1)]);
    a.append(run(2)).unwrap();
    b.append(run(3)).unwrap();
    assert_eq!(all(&b), [run(1), run(2), run(3)], "in the file's order, each once");
    b.refresh().unwrap();
    assert_eq!(b.outcomes().count(), 3);
    fs::write(a.path(), "").unwrap();
    assert!(a.append(run(4)).unwrap_err().to_string().contains("shorter"));
}

#[test]
fn a_claim_is_held_by_one_until_it_is_dropped() {
    let dir = tempfile::tempdir().unwrap();
    let (a, b) = (Store::open(dir.path()).unwrap(), Store::open(dir.path()).unwrap());
    let (one, two) = (cell(1).key(), cell(2).key());
    let held = a.try_claim(&one).unwrap().unwrap();
    assert!(b.try_claim(&one).unwrap().is_none());
    assert!(b.try_claim(&two).unwrap().is_some(), "another cell is free");
    drop(held);
    drop(b.claim(&one).unwrap());
    assert!(!dir.path().join("claims").exists());
    // A killed process leaves its file, and no lock.
    fs::create_dir(dir.path().join("claims")).unwrap();
    fs::write(dir.path().join("claims").join(one.as_str()), "").unwrap();
    assert!(b.try_claim(&one).unwrap().is_some());
}

#[test]
fn who_claims_first_and_looks_then_runs_no_cell_twice() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let dir = tempfile::tempdir().unwrap();
    let worked = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let mut store = Store::open(dir.path()).unwrap();
                for seed in 0..40 {
                    let claim = store.claim(&cell(seed).key()).unwrap();
                    store.refresh().unwrap();
                    if store.outcome(&cell(seed).key()).is_none() {
                        // Long enough for another to look too, if it could.
                        std::thread::sleep(std::time::Duration::from_micros(500));
                        store.append(run(seed)).unwrap();
                        worked.fetch_add(1, Ordering::Relaxed);
                    }
                    drop(claim);
                }
            });
        }
    });
    assert_eq!(worked.load(Ordering::Relaxed), 40, "no cell is run twice");
}

#[test]
fn what_json_cannot_hold_is_refused_and_nothing_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(matches!(store.append(score(1, b"picture", bad)), Err(StoreError::Unwritable(_))));
    }
    assert!(!store.path().exists());
}

#[test]
fn many_writers_lose_nothing() {
    let dir = tempfile::tempdir().unwrap();
    // Two handles taking turns, each opened before the other has written.
    let (mut a, mut b) = (Store::open(dir.path()).unwrap(), Store::open(dir.path()).unwrap());
    a.append(run(1)).unwrap();
    b.append(run(2)).unwrap();
    a.append(run(3)).unwrap();
    // And four at once.
    std::thread::scope(|scope| {
        for writer in 1..=4u64 {
            let mut store = Store::open(dir.path()).unwrap();
            scope.spawn(move || (0..50).for_each(|i| store.append(run(writer * 1000 + i)).unwrap()));
        }
    });
    let store = Store::open(dir.path()).unwrap();
    assert_eq!(store.outcomes().count(), 3 + 4 * 50);
    assert!(store.warnings().is_empty());
}
