//! The gate must fail on what is wrong, and only on that.

use crate::bench::{Bench, SCENE, methods};
use halflight::gate::{Baselines, Comparison, Instructions, Observed, Ratio, SLOWER, Verdict, compare, observe};
use halflight::{Entry, Options, Plan, Selection, Terms};
use halflight_references::Quality;
use halflight_results::{Cell, Key, Picture, Record, Run, Score, Store};
use halflight_scenes::Rgb;

/// Two scenes of two frames, and every method on them.
struct Lab {
    bench: Bench,
    entries: Vec<Entry>,
}

impl Lab {
    fn new() -> Self {
        let bench = Bench::new();
        let motion = "motion = [{ time = 0.0 }, { time = 1.0, translate = [0.4, 0.0, 0.0] }]\nalbedo";
        let moving = SCENE.replace("[4, 3]", "[12, 9]").replace("albedo", motion);
        let moving = format!("{moving}\n[frames]\ncount = 2\nfps = 1.0\n");
        bench.write("one.toml", &moving);
        bench.write("other.toml", &moving.replace("radius = 0.5", "radius = 0.6"));
        let path = |name: &str| bench.path(name).display().to_string();
        let selection = Selection {
            scenes: vec![path("one.toml"), path("other.toml")],
            references: vec!["truth".into(), "sh-light".into()],
            ..Default::default()
        };
        Lab { entries: selection.entries().unwrap(), bench }
    }

    fn plan(&self, seed: u64) -> Plan {
        Plan::new(&self.entries, &Terms { seed, timed_on: "a test".into() }).unwrap()
    }

    /// Runs a plan.
    fn run(&self, plan: &Plan, out: &str) -> Store {
        let mut store = Store::open(self.bench.path(out)).unwrap();
        let options = Options { show_progress: false, repeats: 1, ..Options::new(self.bench.path("cache")) };
        let summary = halflight::run(plan, &mut store, &options).unwrap();
        assert_eq!(summary.failed + summary.unjudged, 0);
        store
    }

    fn observed(&self, plan: &Plan, store: &Store) -> Observed {
        observe(plan, &self.entries, store, &Quality::default())
    }
}

/// The cells of a plan, or those of a method, with their runs.
fn runs(plan: &Plan, store: &Store, method: &str) -> Vec<Run> {
    let cells = plan.cells().map(|(_, cell)| cell).filter(|cell| cell.method == method);
    cells.map(|cell| store.run(&cell.key()).unwrap().clone()).collect()
}

/// Puts another picture into the place of a cell's, scored as it was.
fn replace(store: &mut Store, run: &Run, image: Key) {
    let scores: Vec<Score> = store.scores(&run.cell.key()).into_iter().cloned().collect();
    store.append(Record::Run(Box::new(Run { image: Some(image.clone()), ..run.clone() }))).unwrap();
    for score in scores {
        store.append(Record::Score(Score { image: image.clone(), ..score })).unwrap();
    }
}

/// Changes a cell's picture.
fn tamper(store: &mut Store, run: &Run, change: impl Fn(usize, Rgb) -> Rgb) {
    let picture = store.read_picture(run.image.as_ref().unwrap()).unwrap();
    let radiance = picture.radiance.iter().enumerate().map(|(i, value)| change(i, *value)).collect();
    let image = store.write_picture(&Picture { radiance, ..picture }).unwrap();
    replace(store, run, image);
}

/// Points every score of a cell against a reference to another image.
fn judge_by(store: &mut Store, cell: &Cell, reference: &str, image: &Key) {
    let scores = store.scores(&cell.key()).into_iter().filter(|score| score.reference == reference);
    for score in scores.cloned().collect::<Vec<_>>() {
        store.append(Record::Score(Score { reference_image: image.clone(), ..score })).unwrap();
    }
}

fn image_of(store: &Store, cell: &Cell, reference: &str) -> Key {
    let scores = store.scores(&cell.key());
    scores.iter().find(|score| score.reference == reference).unwrap().reference_image.clone()
}

/// What fails, each once.
fn failing(comparison: &Comparison) -> Vec<&str> {
    let fails = comparison.findings.iter().filter(|finding| finding.verdict == Verdict::Fails);
    let mut subjects: Vec<&str> = fails.map(|finding| finding.subject.as_str()).collect();
    subjects.sort_unstable();
    subjects.dedup();
    assert_eq!(comparison.passes(false), subjects.is_empty());
    subjects
}

fn wrong(baselines: &Baselines, observed: &Observed) -> Vec<String> {
    failing(&compare(baselines, observed, false)).into_iter().map(str::to_owned).collect()
}

#[test]
fn a_bias_of_one_percent_in_any_method_is_caught() {
    let lab = Lab::new();
    let plan = lab.plan(1);
    let mut store = lab.run(&plan, "out");
    let right = lab.observed(&plan, &store).measured;
    assert_eq!(right.cells.len(), 4 * methods().len());
    let rescored = lab.plan(2);
    let mut again = lab.run(&rescored, "again");
    for method in methods() {
        for scale in [0.99, 1.01] {
            for (plan, store) in [(&plan, &mut store), (&rescored, &mut again)] {
                let honest = runs(plan, store, method);
                honest.iter().for_each(|run| tamper(store, run, |_, value| value * scale));
                let wrong = wrong(&right, &lab.observed(plan, store));
                assert_eq!(wrong.len(), 4, "{wrong:?}");
                assert!(wrong.iter().all(|cell| cell.contains(method)), "{wrong:?}");
                // A thousandth of that is rounding.
                honest.iter().for_each(|run| tamper(store, run, |_, value| value * (1.0 + 0.001 * (scale - 1.0))));
                assert_eq!(self::wrong(&right, &lab.observed(plan, store)), [""; 0]);
                honest.iter().for_each(|run| replace(store, run, run.image.clone().unwrap()));
                assert_eq!(self::wrong(&right, &lab.observed(plan, store)), [""; 0]);
            }
        }
    }
}

#[test]
fn changes_that_cancel_within_blocks_are_caught_by_the_error() {
    let lab = Lab::new();
    let plan = lab.plan(1);
    let mut store = lab.run(&plan, "out");
    let right = lab.observed(&plan, &store).measured;
    let run = &runs(&plan, &store, "shexp/hyb")[0];
    // Neighbours in a row of a block of three by three.
    tamper(&mut store, run, |i, value| value + [0.05, -0.05, 0.0][i % 12 % 3]);
    let comparison = compare(&right, &lab.observed(&plan, &store), false);
    let told: Vec<_> = comparison.findings.iter().map(|finding| finding.told.as_str()).collect();
    assert!(!told.is_empty() && told.iter().all(|told| told.starts_with("RMSE against one · ")), "{told:?}");
}

#[test]
fn a_reference_of_another_scene_is_caught() {
    let lab = Lab::new();
    let right = lab.observed(&lab.plan(1), &lab.run(&lab.plan(1), "out")).measured;
    // With the very key that it was blessed with, and estimated anew.
    for (seed, out) in [(1, "out"), (2, "again")] {
        let plan = lab.plan(seed);
        let mut store = lab.run(&plan, out);
        let of = |scene: &str| {
            plan.cells().map(|(_, cell)| cell).filter(|c| c.scene == scene && c.frame == 0).collect::<Vec<_>>()
        };
        let strange = image_of(&store, of("other")[0], "truth");
        of("one").into_iter().for_each(|cell| judge_by(&mut store, cell, "truth", &strange));
        let wrong = wrong(&right, &lab.observed(&plan, &store));
        assert!(wrong.contains(&"one · truth · direct · frame 0".to_owned()), "seed {seed}: {wrong:?}");
        assert!(!wrong.iter().any(|subject| subject.contains("frame 1") || subject.starts_with("other")), "{wrong:?}");
    }
}

#[test]
fn swapped_frames_are_caught() {
    let lab = Lab::new();
    let plan = lab.plan(1);
    let mut store = lab.run(&plan, "out");
    let right = lab.observed(&plan, &store).measured;
    let pair: Vec<Run> = runs(&plan, &store, "shexp/hyb").into_iter().filter(|run| run.cell.scene == "one").collect();
    for (here, there) in [(0, 1), (1, 0)] {
        replace(&mut store, &pair[here], pair[there].image.clone().unwrap());
    }
    let both = ["one · shexp/hyb · direct · frame 0", "one · shexp/hyb · direct · frame 1"];
    assert_eq!(wrong(&right, &lab.observed(&plan, &store)), both);

    // References too, for all methods: errors are then what they were, but for the other frame.
    let cells =
        |frame: u32| plan.cells().map(|(_, cell)| cell).filter(move |cell| cell.scene == "one" && cell.frame == frame);
    let [first, second] = [0, 1].map(|frame| image_of(&store, cells(frame).next().unwrap(), "truth"));
    cells(0).for_each(|cell| judge_by(&mut store, cell, "truth", &second));
    cells(1).for_each(|cell| judge_by(&mut store, cell, "truth", &first));
    let wrong = wrong(&right, &lab.observed(&plan, &store));
    for subject in ["one · truth · direct · frame 0", "one · truth · direct · frame 1", both[0], both[1]] {
        assert!(wrong.iter().any(|wrong| wrong == subject), "{subject}: {wrong:?}");
    }
}

#[test]
fn nan_and_what_is_missing_fail() {
    let lab = Lab::new();
    let plan = lab.plan(1);
    let mut store = lab.run(&plan, "out");
    let observed = lab.observed(&plan, &store);
    let right = observed.measured.clone();
    let cell = "one · shexp/hyb · direct · frame 0";
    assert_eq!(wrong(&right, &observed), [""; 0]);

    let mut unknown = right.clone();
    unknown.cells.remove(cell);
    assert_eq!(wrong(&unknown, &observed), [cell]);
    let mut unknown = right.clone();
    unknown.references.remove("one · truth · direct · frame 0");
    assert!(wrong(&unknown, &observed).contains(&"one · truth · direct · frame 0".to_owned()));

    // A plan that lacks it.
    let mut fewer = lab.plan(1);
    fewer.groups.retain(|group| group.method.info().id != "shexp/hyb");
    assert_eq!(wrong(&right, &lab.observed(&fewer, &store)).len(), 4);
    assert!(compare(&right, &lab.observed(&fewer, &store), true).passes(true), "a part is well");
    fewer.groups.clear();
    let nothing = lab.observed(&fewer, &store);
    for (baselines, partial) in [(&right, true), (&right, false), (&Baselines::new(), false)] {
        assert!(!compare(baselines, &nothing, partial).passes(false), "an empty list of checks");
    }

    // Runs without scores, and without anything.
    let mut scoreless = Store::open(lab.bench.path("scoreless")).unwrap();
    assert!(wrong(&right, &lab.observed(&plan, &scoreless)).contains(&cell.to_owned()));
    for run in methods().into_iter().flat_map(|method| runs(&plan, &store, method)) {
        let picture = store.read_picture(run.image.as_ref().unwrap()).unwrap();
        scoreless.write_picture(&picture).unwrap();
        scoreless.append(Record::Run(Box::new(run))).unwrap();
    }
    let comparison = compare(&right, &lab.observed(&plan, &scoreless), false);
    let told = comparison.findings.iter().filter(|finding| finding.told.contains("the reference is missing"));
    assert!(told.count() >= 8 && !comparison.passes(false));

    let run = &runs(&plan, &store, "shexp/hyb")[0];
    tamper(&mut store, run, |i, value| if i == 7 { Rgb::NAN } else { value });
    let comparison = compare(&right, &lab.observed(&plan, &store), false);
    assert_eq!(failing(&comparison), [cell]);
    assert!(comparison.findings[0].told.contains("radiance at receiver 7 is not finite"), "{comparison:?}");
}

#[test]
fn memory_work_and_time_are_held() {
    let lab = Lab::new();
    let plan = lab.plan(1);
    let store = lab.run(&plan, "out");
    let observed = lab.observed(&plan, &store);
    let name = "one · shexp/hyb · direct · frame 0".to_owned();
    let with = |change: &dyn Fn(&mut Observed)| {
        let mut changed = observed.clone();
        change(&mut changed);
        changed
    };
    let mut right = observed.measured.clone();
    right.paces = [("shexp/hyb".to_owned(), 0.5)].into();
    let verdicts = |right: &Baselines, observed: &Observed| {
        let comparison = compare(right, observed, false);
        let verdicts: Vec<_> = comparison.findings.iter().map(|finding| finding.verdict).collect();
        assert_eq!(
            (comparison.passes(false), comparison.passes(true)),
            (!verdicts.contains(&Verdict::Fails), verdicts.is_empty())
        );
        verdicts
    };
    let memory = |bytes: i64| {
        with(&|observed| {
            let held = observed.measured.cells.get_mut(&name).unwrap().memory.values_mut().next().unwrap();
            *held = held.strict_add_signed(bytes);
        })
    };
    assert_eq!(verdicts(&right, &memory(0)), []);
    assert_eq!(verdicts(&right, &memory(1)), [Verdict::Fails]);
    assert_eq!(verdicts(&right, &memory(-1)), [Verdict::Improves]);

    let work = |kernels: &str, more: u64| {
        with(&|observed| {
            observed.measured.kernels = kernels.to_owned();
            let work = &mut observed.measured.cells.get_mut(&name).unwrap().work;
            *work.get_mut("squares").unwrap() += more;
        })
    };
    let same = observed.measured.kernels.as_str();
    assert_eq!(verdicts(&right, &work(same, 1)), [Verdict::Fails]);
    assert_eq!(verdicts(&right, &work("of another processor", 1)), []);
    assert_eq!(verdicts(&right, &work("of another processor", 2)), [Verdict::Fails]);

    let counted = |with_what: &str, method: &str, count: u64| {
        let counts = [(method.to_owned(), count)].into();
        with(&|observed| observed.counted(Instructions { with: with_what.into(), counts: Clone::clone(&counts) }))
    };
    let mut known = right.clone();
    known.instructions = counted("a compiler", "shexp/hyb", 1_000_000).measured.instructions;
    assert_eq!(verdicts(&known, &observed), [], "not asked for");
    for (compiler, method, count, expected) in [
        ("a compiler", "shexp/hyb", 1_009_999, &[][..]),
        ("a compiler", "shexp/hyb", 1_010_001, &[Verdict::Fails]),
        ("a compiler", "shexp/hyb", 989_999, &[Verdict::Improves]),
        ("another compiler", "shexp/hyb", 2_000_000, &[]),
        // One is new, one is gone.
        ("a compiler", "shexp/eigen", 1_000_000, &[Verdict::Fails, Verdict::Fails]),
    ] {
        assert_eq!(verdicts(&known, &counted(compiler, method, count)), expected, "{compiler} {method} {count}");
    }

    let pace = |ratio: f64| {
        with(&|observed| {
            let ratio = Ratio { ratio, low: 0.9 * ratio, high: 1.1 * ratio };
            observed.ratios = [("shexp/hyb".to_owned(), ratio)].into();
        })
    };
    for (ratio, expected) in
        [(1.0, None), (SLOWER, Some(Verdict::Fails)), (0.5 / SLOWER / 1.2, Some(Verdict::Improves))]
    {
        assert_eq!(verdicts(&right, &pace(ratio)), Vec::from_iter(expected), "{ratio}");
    }
}

#[test]
fn twenty_references_estimated_anew_pass_and_their_errors_are_honest() {
    let lab = Lab::new();
    let plan = lab.plan(1);
    let right = lab.observed(&plan, &lab.run(&plan, "out")).measured;
    let (mut squares, mut count) = (0.0, 0);
    for seed in 2..22 {
        let plan = lab.plan(seed);
        let observed = lab.observed(&plan, &lab.run(&plan, "out"));
        let comparison = compare(&right, &observed, false);
        assert!(comparison.statistical >= 8 * 2 + 8 * 12, "{comparison:?}");
        assert!(comparison.passes(true), "seed {seed}: {:#?}", comparison.findings);
        for (name, reference) in &observed.measured.references {
            let pairs = right.references[name].blocks.iter().zip(&reference.blocks);
            for (old, new) in pairs.filter_map(|(old, new)| Some((old.as_ref()?, new.as_ref()?))) {
                let error = old.1[0].hypot(new.1[0]);
                if error > 0.0 {
                    squares += ((new.0[0] - old.0[0]) / error).powi(2);
                    count += 1;
                }
            }
        }
    }
    // The baselines' own errors are common to all seeds: half of the variance is that of few blocks.
    let spread = (squares / f64::from(count)).sqrt();
    assert!(count > 500 && (0.7..1.4).contains(&spread), "{spread} over {count}");
}
