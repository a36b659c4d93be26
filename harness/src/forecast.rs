//! How long cells may take, from the runs that are in a store.

use halflight_results::{Cell, Environment, Phase, Record, Store, Times};
use std::collections::HashMap;
use std::ops::Add;

/// Times of earlier runs on as many threads, by ever fewer of the fields that decide them.
///
/// Left out is what the store does not tell: derived data and references that are not in the cache.
pub(crate) struct Forecast {
    times: HashMap<Vec<String>, Mean>,
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Forecast {
    /// Of what the store's runs on this machine class took, for runs of so many repeats.
    pub(crate) fn new(store: &Store, environment: &Environment, repeats: usize) -> Self {
        let mut forecast = Self { times: HashMap::new() };
        let runs = store.outcomes().filter_map(|record| match record {
            Record::Run(run) if run.environment.class() == environment.class() => Some(run),
            _ => None,
        });
        for run in runs {
            let Some(times) = store.times(&run.cell.key()) else { continue };
            let seconds = seconds(times, repeats);
            for kin in kin(&run.cell) {
                let mean = forecast.times.entry(kin).or_default();
                (mean.sum, mean.count) = (mean.sum + seconds, mean.count + 1);
            }
        }
        forecast
    }

    /// Seconds that a cell may take: those of the same cell under another revision or seed, or else of the method on the
    /// same scene, or else of the method anywhere; `None` if it was never run.
    pub(crate) fn seconds(&self, cell: &Cell) -> Option<f64> {
        kin(cell).iter().find_map(|kin| self.times.get(kin)).map(|mean| mean.sum / mean.count as f64)
    }

    /// Seconds that cells may take together, of those of which something is known, and how many others there are.
    pub(crate) fn sum<'c>(&self, cells: impl Iterator<Item = &'c Cell>) -> Expected {
        let one = |cell| match self.seconds(cell) {
            Some(seconds) => Expected { seconds, unknown: 0 },
            None => Expected { seconds: 0.0, unknown: 1 },
        };
        cells.map(one).fold(Expected::default(), Add::add)
    }
}

/// What is expected of several cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Expected {
    pub(crate) seconds: f64,
    /// Cells of which nothing is known.
    pub(crate) unknown: usize,
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
            (true, n) => write!(f, "about {} and {n} cells of unknown time", duration(self.seconds)),
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

/// A cell's time with so many repeats: all is done once for the picture, once to be timed, and the rest again for each repeat.
fn seconds(times: &Times, repeats: usize) -> f64 {
    let median = |name: &str| {
        let samples = times.phases.get(name).map_or(&[][..], |timing| &timing.nanoseconds);
        halflight_metrics::median(samples).unwrap_or(0.0)
    };
    let twice = 2.0 * (median(Phase::Prepare.name()) + median(Phase::Update.name()));
    (twice + (repeats as f64 + 2.0) * (median(Phase::Shade.name()) + median("read"))) * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::{Calibration, Run, Timing};

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
        let both = [cell("s", "a", 3, 2), cell("s", "b", 3, 1)];
        assert_eq!(forecast.sum(both.iter()), Expected { seconds: 5.0, unknown: 1 });
        let elsewhere = Environment { cpu: "another".into(), ..Environment::default() };
        assert_eq!(Forecast::new(&store, &elsewhere, 1).seconds(&cell("s", "a", 3, 1)), None);
    }
}
