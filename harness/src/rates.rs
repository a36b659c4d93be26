//! Frame rates that papers print, and the cells of the suite `paper/rates` that stand for them.

use crate::Error;
use crate::execute::AGAIN;
use crate::ledger::{self, Setting};
use crate::plan::json;
use halflight_metrics::{Interval, median_interval};
use halflight_reports::{Rate, Reached};
use halflight_results::{Cell, Params, Phase, Record, Run, Store, Times};

/// Spans by a device's own clock end so.
pub(crate) const CLOCK: &str = " (gpu clock)";

/// A cell's outcome with its times.
pub(crate) type Outcome<'s> = (&'s Record, Option<&'s Times>);

/// Why a run has no rate that has no times.
pub(crate) const NOT_TIMED: &str = "not timed";

/// A frame rate that a paper prints.
struct Case {
    name: &'static str,
    place: &'static str,
    printed: Printed,
    /// The paper's machine, with the year.
    device: &'static str,
    scene: &'static str,
    method: &'static str,
    /// Parameters that are not at their default.
    set: &'static [(&'static str, &'static str)],
    /// Receivers of the scene, a percent more or fewer.
    receivers: usize,
    /// Spheres that are asked for; none where there are no blockers.
    spheres: Option<usize>,
}

/// Where a printed figure stands.
enum Printed {
    Here(&'static str),
    /// In a row of the ledger, under the name of its quantity.
    Ledger(&'static str, &'static str),
}

impl Printed {
    fn text(&self) -> Option<&'static str> {
        match *self {
            Printed::Here(text) => Some(text),
            Printed::Ledger(row, quantity) => ledger::ROWS.iter().find(|r| r.id == row)?.printed(quantity),
        }
    }
}

const FIG_8: Case = Case {
    name: "ground of 200×200, PS*-2",
    place: "Ren et al. 2006, Fig. 8",
    printed: Printed::Ledger("S3", "our PS*-2, order 6"),
    device: "a CPU, 2006",
    scene: "spheres-60@2.0834",
    method: "shexp/ps-star",
    set: &[("order", "6"), ("self-shadow", "paper")],
    receivers: 40_000,
    spheres: Some(60),
};

const DINO: Case = Case {
    name: "dino size, cuts",
    place: "Ren et al. 2006, Fig. 10 (b)",
    printed: Printed::Here("10.6 to 33.2 Hz"),
    device: "GeForce 7800 GTX, 2006",
    scene: "herd@1.11",
    method: "shexp/hyb",
    set: &[("cut", "20")],
    receivers: 120_000,
    spheres: Some(512),
};

const BATTLE: Case = Case {
    name: "battle size, cuts",
    place: "Ren et al. 2006, Fig. 10 (a)",
    printed: Printed::Here("15.6 to 44.5 Hz"),
    scene: "battle@1.238",
    set: &[("spheres", "61"), ("cut", "20")],
    receivers: 65_000,
    spheres: Some(244),
    ..DINO
};

const KEY: Case = Case {
    name: "heights, key light, 256²",
    place: "Snyder and Nowrouzezahrai 2008, Table 1",
    printed: Printed::Ledger("H2", "rate, key light, 256"),
    device: "GeForce 8800 Ultra, 2008",
    scene: "fractal-256-key",
    method: "horizon-wedges/partial",
    set: &[],
    receivers: 256 * 256,
    spheres: None,
};

const CASES: &[Case] = &[
    BATTLE,
    Case { name: "battle size, every sphere", set: &[("spheres", "61")], ..BATTLE },
    DINO,
    Case { name: "dino size, every sphere", set: &[], ..DINO },
    Case {
        printed: Printed::Ledger("S3", "our PS*-2, order 3"),
        set: &[("order", "3"), ("self-shadow", "paper")],
        ..FIG_8
    },
    Case {
        printed: Printed::Ledger("S3", "our PS*-2, order 4"),
        set: &[("order", "4"), ("self-shadow", "paper")],
        ..FIG_8
    },
    Case {
        printed: Printed::Ledger("S3", "our PS*-2, order 5"),
        set: &[("order", "5"), ("self-shadow", "paper")],
        ..FIG_8
    },
    FIG_8,
    Case {
        name: "ground of 200×200, product",
        printed: Printed::Ledger("S3", "plain product, order 6"),
        method: "sh-product/ordered",
        ..FIG_8
    },
    KEY,
    Case {
        name: "heights, key light, 512²",
        printed: Printed::Ledger("H2", "rate, key light, 512"),
        scene: "fractal-512-key",
        receivers: 512 * 512,
        ..KEY
    },
    Case {
        name: "heights, key light, 1024²",
        printed: Printed::Ledger("H2", "rate, key light, 1024"),
        scene: "fractal-1024-key",
        receivers: 1024 * 1024,
        ..KEY
    },
    Case {
        name: "heights, key light and sky, 256²",
        printed: Printed::Ledger("H2", "rate, key light and sky, 256"),
        scene: "fractal-256",
        ..KEY
    },
    Case {
        name: "heights, key light and sky, 512²",
        printed: Printed::Ledger("H2", "rate, key light and sky, 512"),
        scene: "fractal-512",
        receivers: 512 * 512,
        ..KEY
    },
    Case {
        name: "heights, key light and sky, 1024²",
        printed: Printed::Ledger("H2", "rate, key light and sky, 1024"),
        scene: "fractal-1024",
        receivers: 1024 * 1024,
        ..KEY
    },
];

impl Case {
    /// All parameters, as cells have them.
    fn params(&self) -> Result<Params, Error> {
        let Setting { params, .. } = Setting::new(self.method, self.set)?;
        Ok(params.iter().map(|(name, value)| (name.to_owned(), json(value))).collect())
    }

    fn is(&self, cell: &Cell, params: &Params) -> bool {
        cell.scene == self.scene && cell.method == self.method && cell.quantity == "direct" && cell.params == *params
    }

    /// What is computed, in words.
    fn work(&self, params: &Params) -> String {
        let order = params.get("order").map_or(String::new(), |order| format!(", order {order}"));
        let spheres = self.spheres.map_or(String::new(), |spheres| format!(", {spheres} spheres"));
        format!("{} receivers{spheres}{order}", self.receivers)
    }

    fn rate(&self, params: &Params, reached: Vec<Reached>) -> Rate {
        let set: String = self.set.iter().map(|(name, value)| format!(" {name}={value}")).collect();
        Rate {
            case: self.name.into(),
            place: self.place.into(),
            work: self.work(params),
            printed: self.printed.text().unwrap_or("–").into(),
            device: self.device.into(),
            setting: format!("{} · {}{set}", self.scene, self.method),
            reached,
        }
    }
}

/// The papers' rates beside those of a store; none where it has no such cells.
pub(crate) fn of(store: &Store) -> Vec<Rate> {
    let times = |record: &Record| record.cell().and_then(|cell| store.times(&cell.key()));
    among(&store.outcomes().map(|record| (record, times(record))).collect::<Vec<_>>())
}

/// The papers' rates beside those of cells with their times.
pub(crate) fn among(outcomes: &[Outcome<'_>]) -> Vec<Rate> {
    let rates = CASES.iter().filter_map(|case| {
        let params = case.params().ok()?;
        let cells = outcomes.iter().filter(|(record, _)| record.cell().is_some_and(|cell| case.is(cell, &params)));
        let mut by_processor: Vec<(String, Vec<Outcome<'_>>)> = Vec::new();
        for (record, times) in cells {
            let on = processor(record);
            match by_processor.iter_mut().find(|(other, _)| *other == on) {
                Some((_, frames)) => frames.push((record, *times)),
                None => by_processor.push((on, vec![(record, *times)])),
            }
        }
        let reached = by_processor.into_iter().map(|(on, frames)| reached(on, &frames)).collect::<Vec<_>>();
        (!reached.is_empty()).then(|| case.rate(&params, reached))
    });
    rates.collect()
}

/// Where a cell ran, or was to run.
pub(crate) fn processor(record: &Record) -> String {
    let backend = record.cell().map_or("", |cell| &cell.backend);
    match (backend.strip_prefix("gpu"), record) {
        (Some(adapter), _) => adapter.strip_prefix(": ").unwrap_or("GPU").to_owned(),
        (None, Record::Run(run)) => format!("{}, {} threads", run.environment.cpu, run.environment.threads),
        (None, _) => "CPU".to_owned(),
    }
}

fn reached(on: String, frames: &[Outcome<'_>]) -> Reached {
    let why = frames.iter().find_map(|(record, times)| match record {
        Record::Skip(skip) => Some(format!("skipped: {}", skip.reason)),
        Record::Failure(failure) => Some(format!("failed: {}", failure.error)),
        Record::Run(run) if run.cell.is_software() => Some(halflight_results::CORRECTNESS_ONLY.to_owned()),
        Record::Run(_) if times.is_none() => Some(NOT_TIMED.to_owned()),
        _ => None,
    });
    let pooled = |rates: fn(&Times) -> Vec<f64>| -> Option<Interval> {
        median_interval(&frames.iter().filter_map(|(_, times)| *times).flat_map(rates).collect::<Vec<_>>())
    };
    let (frames, passes) = match why {
        Some(why) => (Err(why), None),
        None => (pooled(frame_rates).ok_or_else(|| NOT_TIMED.to_owned()), pooled(pass_rates)),
    };
    Reached { on, frames, passes }
}

/// Frames a second, update and shade, round by round.
fn frame_rates(times: &Times) -> Vec<f64> {
    let samples = |name: &str| times.phases.get(name).map_or(&[][..], |timing| &timing.nanoseconds);
    let rounds = samples(AGAIN).iter().zip(samples(Phase::Shade.name()));
    rounds.map(|(update, shade)| 1e9 / (update + shade)).collect()
}

/// Shadings a second by the device's own clock, round by round.
fn pass_rates(times: &Times) -> Vec<f64> {
    let clocked = times.phases.iter().filter(|(name, timing)| name.ends_with(CLOCK) && timing.phase == Phase::Shade);
    let mut sums: Vec<f64> = Vec::new();
    for (_, timing) in clocked {
        sums.resize(sums.len().max(timing.nanoseconds.len()), 0.0);
        sums.iter_mut().zip(&timing.nanoseconds).for_each(|(sum, time)| *sum += time);
    }
    sums.into_iter().map(|sum| 1e9 / sum).collect()
}

/// The run of an outcome.
pub(crate) fn run_of(record: &Record) -> Option<&Run> {
    if let Record::Run(run) = record { Some(run) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Plan, Suite, Terms};
    use halflight_results::{Environment, Skip, Timing};
    use halflight_scenes::{Layout, Shape};

    /// Planned once, since that takes seconds: a million receivers and more.
    #[test]
    fn the_suite_has_every_case_at_its_size_and_poses_no_more_frames_than_it_takes() {
        let terms = Terms { seed: 1, timed_on: "a test".into() };
        let plan = Plan::new(&Suite::find("paper/rates").unwrap().entries, &terms).unwrap();
        for case in CASES {
            let params = case.params().unwrap();
            let (group, _) = plan.cells().find(|(_, cell)| case.is(cell, &params)).expect(case.name);
            let stage = &plan.scenes[group.scene];
            let receivers = &stage.frames[0].receivers;
            let valid = receivers.valid.iter().filter(|valid| **valid).count();
            let apart = (valid as f64 / case.receivers as f64 - 1.0).abs();
            assert!(apart < 0.01, "{}: {valid} receivers, {} stated", case.name, case.receivers);
            assert!(matches!(receivers.layout, Layout::Image { .. }), "{}", case.name);
            let asked = params.get("spheres").map_or(0, |spheres| spheres.as_u64().unwrap() as usize);
            let spheres = stage.scene.objects.iter().filter(|object| object.casts).map(|object| match &*object.shape {
                Shape::Mesh(_) => asked,
                Shape::Spheres(spheres) => spheres.len(),
                Shape::Heights(_) => 0,
            });
            assert_eq!(case.spheres.unwrap_or(0), spheres.sum::<usize>(), "{}", case.name);
            assert!(
                !matches!(group.support, halflight_contract::Support::Skip(_)),
                "{}: {:?}",
                case.name,
                group.support
            );
            assert!(case.printed.text().is_some_and(|printed| printed.ends_with(" Hz")), "{}", case.name);
        }
        let battle = plan.scenes.iter().find(|stage| stage.scene.name == BATTLE.scene).unwrap();
        assert_eq!((battle.frames.len(), battle.scene.frame_count), (3, 45));
        let cells = plan.groups.iter().filter(|group| plan.scenes[group.scene].scene.name == BATTLE.scene);
        assert!(cells.clone().count() == 4 && cells.clone().all(|group| group.cells.len() == 3));
    }

    fn record(case: &Case, backend: &str) -> Record {
        let (scene, method, quantity) = (case.scene.into(), case.method.into(), "direct".into());
        let cell = Cell {
            scene,
            method,
            quantity,
            params: case.params().unwrap(),
            backend: backend.into(),
            ..Cell::default()
        };
        let environment = Environment { cpu: "a CPU".into(), threads: 2, ..Environment::default() };
        Record::Run(Box::new(Run { cell, environment, ..Run::default() }))
    }

    fn times(record: &Record, spans: &[(&str, Phase, [f64; 6])]) -> Times {
        let timing = |(name, phase, samples): &(&str, Phase, [f64; 6])| {
            ((*name).to_owned(), Timing { phase: *phase, nanoseconds: samples.to_vec() })
        };
        let (run, phases) = (record.cell().unwrap().key(), spans.iter().map(timing).collect());
        Times { run, taken: 0, beside: 1, phases, calibration: Default::default() }
    }

    #[test]
    fn a_rate_is_of_updates_and_shading_round_by_round() {
        let run = record(&DINO, "cpu");
        let spans = [
            ("update", Phase::Update, [1e12; 6]),
            (AGAIN, Phase::Update, [4e6, 5e6, 5e6, 5e6, 5e6, 6e6]),
            ("shade", Phase::Shade, [6e6, 5e6, 5e6, 5e6, 5e6, 14e6]),
            ("read", Phase::Shade, [1e12; 6]),
        ];
        let times = times(&run, &spans);
        let [rate] = &among(&[(&run, Some(&times))])[..] else { panic!("one case") };
        assert_eq!((rate.case.as_str(), rate.printed.as_str()), ("dino size, cuts", "10.6 to 33.2 Hz"));
        let [reached] = &rate.reached[..] else { panic!("one processor") };
        let frames = reached.frames.as_ref().unwrap();
        assert_eq!(
            (reached.on.as_str(), frames.median, frames.low, frames.high),
            ("a CPU, 2 threads", 100.0, 50.0, 100.0)
        );
        assert!(reached.passes.is_none());
    }

    #[test]
    fn passes_of_shading_alone_have_a_rate_of_their_own() {
        let run = record(&DINO, "gpu: Real 9000");
        let spans = [
            (AGAIN, Phase::Update, [1e6; 6]),
            ("update again/upload (gpu clock)", Phase::Update, [1e12; 6]),
            ("shade", Phase::Shade, [1e6; 6]),
            ("shade/gather (gpu clock)", Phase::Shade, [1e5; 6]),
            ("shade/product (gpu clock)", Phase::Shade, [3e5; 6]),
        ];
        let times = times(&run, &spans);
        let reached = among(&[(&run, Some(&times))])[0].reached[0].clone();
        assert_eq!((reached.frames.unwrap().median, reached.passes.unwrap().median), (500.0, 2500.0));
        assert_eq!(reached.on, "Real 9000");
    }

    #[test]
    fn what_has_no_rate_says_why() {
        let software = record(&DINO, "gpu: pipe, correctness only");
        let lied = times(&software, &[(AGAIN, Phase::Update, [1.0; 6]), ("shade", Phase::Shade, [1.0; 6])]);
        let untimed = record(&DINO, "cpu");
        let skip = Record::Skip(Skip { cell: record(&DINO, "gpu: x").cell().unwrap().clone(), reason: "cuts".into() });
        let rates = among(&[(&software, Some(&lied)), (&untimed, None), (&skip, None)]);
        let why: Vec<_> = rates[0].reached.iter().map(|reached| reached.frames.clone().unwrap_err()).collect();
        assert_eq!(why, ["correctness only", "not timed", "skipped: cuts"]);
        assert!(among(&[]).is_empty());
    }
}
