//! How fast the machine was when times were taken, relative to what is usual: the median over the runs of its class.

use crate::Row;
use halflight_metrics::median;
use halflight_results::Calibration;
use std::collections::BTreeMap;

/// Calibrations that differ by more from the usual are told.
pub(crate) const APART: f64 = 0.1;

/// What calibrations usually take, by machine class.
pub(crate) struct Usual(BTreeMap<String, [f64; 2]>);

/// Time that the fixed work took over the time that it usually takes: above 1, the machine was slower than usual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pace {
    pub(crate) compute: f64,
    pub(crate) memory: f64,
}

impl Usual {
    pub(crate) fn of<'a>(rows: impl Iterator<Item = &'a Row>) -> Self {
        let mut classes: BTreeMap<String, [Vec<f64>; 2]> = BTreeMap::new();
        for (class, medians) in rows.filter_map(|row| Some((class(row), medians(&row.times.as_ref()?.calibration)?))) {
            classes.entry(class).or_default().iter_mut().zip(medians).for_each(|(all, median)| all.push(median));
        }
        let usual = |[compute, memory]: [Vec<f64>; 2]| Some([median(&compute)?, median(&memory)?]);
        Self(classes.into_iter().filter_map(|(class, all)| Some((class, usual(all)?))).collect())
    }

    /// None for a run without times.
    pub(crate) fn pace(&self, row: &Row) -> Option<Pace> {
        let [compute, memory] = medians(&row.times.as_ref()?.calibration)?;
        let usual = self.0.get(&class(row))?;
        Some(Pace { compute: compute / usual[0], memory: memory / usual[1] })
    }
}

impl Pace {
    pub(crate) fn is_apart(self) -> bool {
        [self.compute, self.memory].iter().any(|pace| !(1.0 - APART..=1.0 + APART).contains(pace))
    }
}

fn class(row: &Row) -> String {
    row.run.environment.class()
}

fn medians(calibration: &Calibration) -> Option<[f64; 2]> {
    Some([median(&calibration.compute)?, median(&calibration.memory)?])
}

/// A line of warning where runs were timed on an unusual machine; none where there is nothing to warn of.
pub(crate) fn warning<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Option<String> {
    let usual = Usual::of(rows.clone());
    let apart = rows.clone().filter(|row| usual.pace(row).is_some_and(Pace::is_apart)).count();
    let timed = rows.filter(|row| row.times.is_some()).count();
    (apart > 0).then(|| {
        format!(
            "{apart} of {timed} runs were timed while the machine was more than {:.0}% faster or slower than it usually \
             was: compare their normalised times, in the tables of times, or time them again",
            100.0 * APART
        )
    })
}
