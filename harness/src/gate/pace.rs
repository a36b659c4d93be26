//! Time as ratios in one run: machines and days drop out.

use halflight_metrics::{Interval, median, median_interval};
use halflight_results::{Phase, Times};
use std::collections::BTreeMap;

/// The method, at its defaults, whose shading time on the same scene sets the pace.
pub const PACE: &str = "sh-product/ordered";

/// Shading that takes less is not judged: clock and scheduler count for too much.
const SHORTEST: f64 = 1e6;

/// A method's shading time relative to the pace: the median over scenes, with the median of the intervals' ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The ratio.
    pub ratio: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Shading times of one place: a scene's frame and quantity.
#[derive(Default)]
struct Place {
    pace: Option<Interval>,
    others: Vec<(String, Interval)>,
}

/// Collects shading times.
#[derive(Default)]
pub(super) struct Paces(BTreeMap<String, Place>);

impl Paces {
    /// Notes the times of a method with these settings.
    pub(super) fn add(&mut self, place: &str, method: &str, times: &Times) {
        let Some(time) = times.phases.get(Phase::Shade.name()).and_then(|timing| median_interval(&timing.nanoseconds))
        else {
            return;
        };
        let place = self.0.entry(place.to_owned()).or_default();
        if method == PACE {
            place.pace = Some(time);
        } else {
            place.others.push((method.to_owned(), time));
        }
    }

    /// The ratios by method.
    pub(super) fn ratios(&self) -> BTreeMap<String, Ratio> {
        let mut by_method: BTreeMap<&str, [Vec<f64>; 3]> = BTreeMap::new();
        for place in self.0.values() {
            let Some(pace) = place.pace.filter(|pace| pace.median >= SHORTEST) else { continue };
            for (method, time) in place.others.iter().filter(|(_, time)| time.median >= SHORTEST) {
                let ratios = [time.median / pace.median, time.low / pace.high, time.high / pace.low];
                by_method.entry(method).or_default().iter_mut().zip(ratios).for_each(|(all, ratio)| all.push(ratio));
            }
        }
        let of = |[ratio, low, high]: [Vec<f64>; 3]| {
            Some(Ratio { ratio: median(&ratio)?, low: median(&low)?, high: median(&high)? })
        };
        by_method.into_iter().filter_map(|(method, ratios)| Some((method.to_owned(), of(ratios)?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::{Calibration, Key, Timing};

    fn times(milliseconds: &[f64]) -> Times {
        let nanoseconds = milliseconds.iter().map(|ms| ms * 1e6).collect();
        let phases = [("shade".to_owned(), Timing { phase: Phase::Shade, nanoseconds })].into();
        let (run, calibration) = (Key::of_bytes(b""), Calibration::default());
        Times { run, taken: 0, beside: 1, phases, calibration }
    }

    #[test]
    fn ratios_are_medians_over_places_and_short_times_do_not_count() {
        let mut paces = Paces::default();
        for (place, pace, other) in [("a", 10.0, 5.0), ("b", 20.0, 20.0), ("c", 10.0, 30.0), ("d", 0.1, 9.0)] {
            paces.add(place, PACE, &times(&[pace; 3]));
            paces.add(place, "other", &times(&[other, other, 2.0 * other]));
            paces.add(place, "short", &times(&[0.9]));
        }
        paces.add("e", "other", &times(&[9.0]));
        let ratios = paces.ratios();
        assert_eq!(ratios.keys().collect::<Vec<_>>(), ["other"]);
        assert_eq!(ratios["other"], Ratio { ratio: 1.0, low: 1.0, high: 2.0 });
    }
}
