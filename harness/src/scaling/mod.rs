//! How cost grows: times of cells that differ in one number, and the power laws that fit them.
//!
//! A series is all runs of a store that agree in everything but one number: a parameter such as `order` or `spheres`, or the
//! receivers of one scene at several resolutions (`bunny-studio@0.5`). Series of fewer than [`FEWEST`] points say little and
//! are left out.

mod fit;

use halflight_metrics::median_interval;
use halflight_reports::Scaling;
use halflight_results::{Cell, Params, Phase, Run, Store};
use std::collections::BTreeMap;

/// The fewest points that make a series.
pub const FEWEST: usize = 4;

/// The number that stands for a scene's receivers.
const RECEIVERS: &str = "receivers";

/// All series of a store with their fits, by scene, then by number, then by method.
pub fn of(store: &Store) -> Vec<Scaling> {
    let mut series: BTreeMap<(String, String, String), Scaling> = BTreeMap::new();
    for run in store.outcomes().filter_map(|record| store.run(&record.cell()?.key())) {
        let Some(time) = store.times(&run.cell.key()).and_then(|times| times.phases.get(Phase::Shade.name())) else {
            continue;
        };
        let Some(time) = median_interval(&time.nanoseconds) else { continue };
        for (over, x) in numbers(run) {
            let (scene, cell) = fixed(&run.cell, &over);
            let kin = (scene.clone(), over.clone(), format!("{} {}", cell.method, cell.key()));
            let new = || Scaling { scene, over, cell, points: Vec::new(), fit: None };
            series.entry(kin).or_insert_with(new).points.push((x, time));
        }
    }
    let mut found: Vec<Scaling> = series.into_values().collect();
    for one in &mut found {
        one.points.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        one.points.dedup_by(|(a, _), (b, _)| a == b);
        one.fit = fit::power_law(&one.points);
    }
    found.retain(|one| one.points.len() >= FEWEST && one.fit.is_some());
    found
}

/// Every number above zero that a run has.
fn numbers(run: &Run) -> Vec<(String, f64)> {
    let params = run.cell.params.iter().filter_map(|(name, value)| Some((name.clone(), value.as_f64()?)));
    params.chain([(RECEIVERS.to_owned(), run.receivers as f64)]).filter(|(_, x)| *x > 0.0).collect()
}

/// The scene's name, and all else of a cell that a series over this number holds fixed.
fn fixed(cell: &Cell, over: &str) -> (String, Cell) {
    let params: Params =
        cell.params.iter().filter(|(name, _)| *name != over).map(|(n, v)| (n.clone(), v.clone())).collect();
    let mut rest = Cell { params, ..cell.clone() };
    let mut scene = cell.scene.as_str();
    if over == RECEIVERS {
        // The same scene at another resolution has another content.
        scene = scene.split_once('@').map_or(scene, |(scene, _)| scene);
        (rest.scene_hash, rest.receivers_hash) = Default::default();
    }
    (scene.to_owned(), rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::{Calibration, Record, Times, Timing};

    fn add(store: &mut Store, scene: &str, method: &str, order: u32, receivers: usize, nanoseconds: f64) {
        let params = [("order".to_owned(), order.into()), ("guard".to_owned(), true.into())].into();
        let (receivers_hash, scene_hash) = (receivers.to_string(), scene.into());
        let cell =
            Cell { scene: scene.into(), scene_hash, method: method.into(), params, receivers_hash, ..Cell::default() };
        let samples = [1.0, 0.99, 1.01, 1.0, 1.02, 0.98].map(|factor| factor * nanoseconds).to_vec();
        let phases = [("shade".to_owned(), Timing { phase: Phase::Shade, nanoseconds: samples })].into();
        let times = Times { run: cell.key(), taken: 0, beside: 1, phases, calibration: Calibration::default() };
        store.append(Record::Run(Box::new(Run { cell, receivers, ..Run::default() }))).unwrap();
        store.append(Record::Times(Box::new(times))).unwrap();
    }

    #[test]
    fn series_are_found_and_fitted() {
        let dir = tempfile::tempdir().unwrap();
        let mut store = Store::open(dir.path()).unwrap();
        for order in [5, 3, 2, 4] {
            add(&mut store, "s", "a/b", order, 100, 7.0 * f64::from(order).powi(4));
            add(&mut store, "s", "a/c", order, 100, 7.0 * f64::from(order).powi(2));
        }
        for (resolution, receivers) in [("@0.5", 25), ("@2", 400), ("@4", 1600)] {
            add(&mut store, &format!("s{resolution}"), "a/b", 4, receivers, 17.92 * receivers as f64);
        }
        // Too few to say anything.
        (2..5).for_each(|order| add(&mut store, "t", "a/b", order, 100, 1.0));
        let found = of(&store);
        let told: Vec<_> = found.iter().map(|s| (s.scene.as_str(), s.over.as_str(), s.cell.method.as_str())).collect();
        assert_eq!(told, [("s", "order", "a/b"), ("s", "order", "a/c"), ("s", "receivers", "a/b")]);
        for (series, expected) in found.iter().zip([4.0, 2.0, 1.0]) {
            let fit = series.fit.as_ref().unwrap();
            assert!((fit.exponent - expected).abs() < 0.01 && series.points.len() == 4, "{series:?}");
        }
    }
}
