//! How long cells and references may take, from the runs that are in a store.

use crate::execute::AGAIN;
use crate::plan::Group;
use halflight_results::{Cell, Environment, Phase, Record, Store, Times};
use std::collections::{HashMap, HashSet};
use std::ops::Add;

/// Times of earlier runs on as many threads, by ever fewer of the fields that decide them.
///
/// Left out is what the store does not tell: derived data that is not in the cache.
pub(crate) struct Forecast {
    /// Seconds to prepare.
    prepare: Means,
    /// Seconds of a cell that is prepared.
    cell: Means,
    /// Seconds a receiver of a reference.
    reference: Means,
}

/// A reference that is to be made.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceWork {
    pub(crate) scene_hash: String,
    /// Its id, such as `sh-light:4`.
    pub(crate) reference: String,
    pub(crate) quantity: String,
    pub(crate) receivers: usize,
}

#[derive(Default)]
struct Means(HashMap<Vec<String>, Mean>);

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Means {
    fn add(&mut self, kin: impl IntoIterator<Item = Vec<String>>, value: f64) {
        for kin in kin {
            let mean = self.0.entry(kin).or_default();
            (mean.sum, mean.count) = (mean.sum + value, mean.count + 1);
        }
    }

    fn of(&self, kin: impl IntoIterator<Item = Vec<String>>) -> Option<f64> {
        kin.into_iter().find_map(|kin| self.0.get(&kin)).map(|mean| mean.sum / mean.count as f64)
    }
}

impl Forecast {
    /// Of what the store's runs on this machine class took, for runs of so many repeats.
    pub(crate) fn new(store: &Store, environment: &Environment, repeats: usize) -> Self {
        let mut forecast = Self { prepare: Means::default(), cell: Means::default(), reference: Means::default() };
        let class = environment.class();
        for record in store.outcomes() {
            let Record::Run(run) = record else { continue };
            let Some(times) = store.times(&run.cell.key()).filter(|_| run.environment.class() == class) else {
                continue;
            };
            forecast.cell.add(kin(&run.cell), seconds(times, repeats));
            forecast.prepare.add(kin(&run.cell), median(times, Phase::Prepare.name()));
        }
        for made in store.references_made().filter(|made| made.environment.class() == class && made.receivers > 0) {
            let kin = reference_kin(&made.scene_hash, &made.reference, &made.quantity);
            forecast.reference.add(kin, made.nanoseconds * 1e-9 / made.receivers as f64);
        }
        forecast
    }

    /// Seconds that a cell may take by itself: those of the same cell under another revision or seed, or else of the method on
    /// the same scene, or else of the method anywhere; `None` if it was never run.
    pub(crate) fn seconds(&self, cell: &Cell) -> Option<f64> {
        Some(self.cell.of(kin(cell))? + self.prepare.of(kin(cell)).unwrap_or(0.0))
    }

    /// Seconds that a reference may take: by those of its kind on the same scene, or else of its kind anywhere, or else of any
    /// kind, a receiver; `None` if none was ever made.
    pub(crate) fn reference(&self, work: &ReferenceWork) -> Option<f64> {
        let kin = reference_kin(&work.scene_hash, &work.reference, &work.quantity);
        Some(self.reference.of(kin)? * work.receivers as f64)
    }

    /// Seconds that cells and references may take together, where something is known of them, and how many others there are.
    /// Cells that one `prepare` serves pay for it once.
    pub(crate) fn sum<'w>(
        &self,
        cells: impl IntoIterator<Item = (&'w Group, &'w Cell)>,
        references: impl IntoIterator<Item = &'w ReferenceWork>,
    ) -> Expected {
        let mut prepared = HashSet::new();
        let cell = |(group, cell): (&Group, &Cell)| {
            let first = prepared.insert(group.preparation());
            let prepare = if first { self.prepare.of(kin(cell)).unwrap_or(0.0) } else { 0.0 };
            Expected::of(self.cell.of(kin(cell)).map(|seconds| seconds + prepare))
        };
        let cells = cells.into_iter().map(cell).fold(Expected::default(), Add::add);
        references.into_iter().map(|work| Expected::of(self.reference(work))).fold(cells, Add::add)
    }
}

/// What is expected of several cells and references.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Expected {
    pub(crate) seconds: f64,
    /// Cells and references of which nothing is known.
    pub(crate) unknown: usize,
}

impl Expected {
    fn of(seconds: Option<f64>) -> Self {
        Self { seconds: seconds.unwrap_or(0.0), unknown: usize::from(seconds.is_none()) }
    }
}

impl Add for Expected {
    type Output = Self;

    fn add(self, more: Self) -> Self {
        Self { seconds: self.seconds + more.seconds, unknown: self.unknown + more.unknown }
    }
}

impl std::fmt::Display for Expected {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.seconds > 0.0, self.unknown) {
            (true, 0) => write!(f, "about {}", duration(self.seconds)),
            (true, n) => write!(f, "about {} and {n} cells or references of unknown time", duration(self.seconds)),
            (false, 0) => f.write_str("no time"),
            (false, _) => f.write_str("unknown time"),
        }
    }
}

/// Seconds for people.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5970.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Nearest first.
fn kin(cell: &Cell) -> [Vec<String>; 3] {
    let of = |fields: &[&str]| fields.iter().map(|field| (*field).to_owned()).collect();
    let Cell { method, backend, quantity, scene_hash, receivers_hash, .. } = cell;
    let (params, frame) = (format!("{:?}", cell.params), cell.frame.to_string());
    [
        of(&[method, backend, quantity, scene_hash, receivers_hash, &frame, &params]),
        of(&[method, backend, quantity, scene_hash]),
        of(&[method, backend, quantity]),
    ]
}

/// Nearest first. Of a reference's id the numbers count for the first only: `sh-light:4` is of the kind of `sh-light:6`.
fn reference_kin(scene_hash: &str, reference: &str, quantity: &str) -> [Vec<String>; 4] {
    let of = |fields: &[&str]| fields.iter().map(|field| (*field).to_owned()).collect();
    let parts: Vec<&str> = reference.split('+').map(|part| part.split(':').next().unwrap_or(part)).collect();
    let kind = parts.join("+");
    [of(&[reference, quantity, scene_hash]), of(&[&kind, quantity, scene_hash]), of(&[&kind, quantity]), of(&[])]
}

/// A cell's time with so many repeats but for the `prepare` of its picture, which it may share: `prepare` is run once to be
/// timed, `update` for the picture, to be timed, and twice for each repeat, the rest again to warm up and for each repeat.
fn seconds(times: &Times, repeats: usize) -> f64 {
    let shade = median(times, Phase::Shade.name()) + median(times, "read");
    let first = median(times, Phase::Prepare.name()) + 2.0 * median(times, Phase::Update.name());
    // From another frame and back.
    let again = 2.0 * repeats as f64 * median(times, AGAIN);
    first + again + (repeats as f64 + 2.0) * shade
}

/// The median time of a span, seconds; 0 if there is none.
fn median(times: &Times, name: &str) -> f64 {
    let samples = times.phases.get(name).map_or(&[][..], |timing| &timing.nanoseconds);
    halflight_metrics::median(samples).unwrap_or(0.0) * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Plan, Terms};
    use crate::select::Selection;
    use halflight_results::{Calibration, Key, ReferenceMade, Run, Timing};

    fn cell(scene: &str, method: &str, order: u32, seed: u64) -> Cell {
        let params = [("order".to_owned(), order.into())].into();
        Cell { scene_hash: scene.into(), method: method.into(), params, seed, ..Cell::default() }
    }

    /// A run with its times.
    fn run(store: &mut Store, cell: Cell, shade: f64) {
        let timing = |phase, seconds: f64| Timing { phase, nanoseconds: vec![seconds * 1e9; 3] };
        let (prepare, shade) = (timing(Phase::Prepare, 1.0), timing(Phase::Shade, shade));
        let phases = [("prepare".to_owned(), prepare), ("shade".to_owned(), shade)].into();
        let times = Times { run: cell.key(), taken: 0, beside: 1, phases, calibration: Calibration::default() };
        store.append(Record::Run(Box::new(Run { cell, ..Run::default() }))).unwrap();
        store.append(Record::Times(Box::new(times))).unwrap();
    }

    #[test]
    fn the_nearest_kin_tell() {
        let dir = tempfile::tempdir().unwrap();
        let mut store = Store::open(dir.path()).unwrap();
        run(&mut store, cell("s", "a", 3, 1), 1.0);
        run(&mut store, cell("s", "a", 5, 1), 3.0);
        run(&mut store, cell("t", "a", 5, 1), 8.0);
        let forecast = Forecast::new(&store, &Environment::default(), 1);
        // Twice to prepare; shaded thrice: for the picture, to warm up, timed.
        assert_eq!(forecast.seconds(&cell("s", "a", 3, 2)), Some(5.0));
        assert_eq!(forecast.seconds(&cell("s", "a", 4, 1)), Some((5.0 + 11.0) / 2.0));
        assert_eq!(forecast.seconds(&cell("u", "a", 4, 1)), Some((5.0 + 11.0 + 26.0) / 3.0));
        assert_eq!(forecast.seconds(&cell("s", "b", 3, 1)), None);
        let elsewhere = Environment { cpu: "another".into(), ..Environment::default() };
        assert_eq!(Forecast::new(&store, &elsewhere, 1).seconds(&cell("s", "a", 3, 1)), None);
    }

    #[test]
    fn one_prepare_is_paid_for_once() {
        let selection = Selection {
            scenes: vec!["sphere-plane".into()],
            methods: vec!["shexp/hyb".into()],
            set: ["order=3,4", "self-shadow=all"].map(|set| set.parse().unwrap()).to_vec(),
            ..Selection::default()
        };
        let plan = Plan::new(&selection.entries().unwrap(), &Terms { seed: 1, timed_on: String::new() }).unwrap();
        let dir = tempfile::tempdir().unwrap();
        let mut store = Store::open(dir.path()).unwrap();
        for group in &plan.groups[..4] {
            run(&mut store, group.cells[0].clone(), 1.0);
        }
        let forecast = Forecast::new(&store, &Environment::default(), 1);
        // Two orders are prepared for their pictures, six cells prepared to be timed and shaded thrice.
        assert_eq!(forecast.sum(plan.cells(), []), Expected { seconds: 2.0 + 6.0 * 4.0, unknown: 0 });
    }

    #[test]
    fn references_tell_by_their_receivers() {
        let dir = tempfile::tempdir().unwrap();
        let mut store = Store::open(dir.path()).unwrap();
        let work = |scene: &str, reference: &str, receivers| ReferenceWork {
            scene_hash: scene.into(),
            reference: reference.into(),
            quantity: "direct".into(),
            receivers,
        };
        let none = Forecast::new(&store, &Environment::default(), 1);
        let truth = work("s", "truth", 100);
        assert_eq!(none.reference(&truth), None);
        assert_eq!(none.sum([], [&truth]), Expected { seconds: 0.0, unknown: 1 });
        for (scene, reference, seconds) in [("s", "truth", 1.0), ("s", "sh-light:3", 4.0), ("t", "truth", 3.0)] {
            let made = ReferenceMade {
                scene: scene.into(),
                scene_hash: scene.into(),
                frame: 0,
                reference: reference.into(),
                reference_key: Key::of_bytes(format!("{scene}{reference}").as_bytes()),
                quantity: "direct".into(),
                receivers: 100,
                nanoseconds: seconds * 1e9,
                environment: Environment::default(),
            };
            store.append(Record::Reference(made)).unwrap();
        }
        let forecast = Forecast::new(&store, &Environment::default(), 1);
        let close = |work: &ReferenceWork, expected: f64| {
            let found = forecast.reference(work).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-9, "{work:?}: {found}");
        };
        close(&truth, 1.0);
        close(&work("s", "truth", 50), 0.5);
        close(&work("s", "sh-light:6", 100), 4.0);
        close(&work("u", "truth", 100), 2.0);
        close(&work("u", "sphere-proxies:8:paper", 300), 8.0);
    }
}
