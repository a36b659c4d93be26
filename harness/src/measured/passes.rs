//! What passes achieve of what their device can do, where methods state their work.
//!
//! A method that knows how much a pass computes or moves counts it under `flops (PASS)` and `bytes (PASS)`, in one frame; the pass is a span of
//! that name, by the device's own clock where it has one.

use super::{Cell, Peak};
use crate::rates::{CLOCK, run_of};
use halflight_metrics::{Interval, median_interval};
use halflight_results::Times;

/// A pass of a cell with what it takes and does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pass {
    /// Its name, without where it lies.
    pub(crate) name: String,
    /// Its time, nanoseconds.
    pub(crate) time: Interval,
    /// Operations of `f32`, where the method tells.
    pub(crate) flops: Option<u64>,
    /// Bytes from and to the device's memory, where the method tells.
    pub(crate) bytes: Option<u64>,
}

/// The passes of a cell that shade and update again: those by the device's own clock, or else spans whose work is stated.
pub(crate) fn passes(cell: &Cell) -> Vec<Pass> {
    let (Some(run), Some(times)) = (run_of(&cell.outcome), &cell.times) else { return Vec::new() };
    let work = |what: &str, pass: &str| run.counters.get(&format!("{what} ({pass})")).copied();
    let clocked = times.phases.keys().any(|path| path.ends_with(CLOCK));
    let frame = times.phases.iter().filter(|(path, _)| path.starts_with("shade") || path.starts_with("update again"));
    let passes = frame.filter_map(|(path, timing)| {
        let last = path.rsplit('/').next()?;
        let name = last.strip_suffix(CLOCK).unwrap_or(last);
        let (flops, bytes) = (work("flops", name), work("bytes", name));
        let is_pass = if clocked { last.ends_with(CLOCK) } else { flops.is_some() || bytes.is_some() };
        let time = median_interval(&timing.nanoseconds)?;
        is_pass.then(|| Pass { name: name.to_owned(), time, flops, bytes })
    });
    passes.collect()
}

impl Pass {
    /// Operations a second.
    pub(crate) fn arithmetic(&self) -> Option<f64> {
        self.flops.map(|flops| flops as f64 * 1e9 / self.time.median)
    }

    /// Bytes a second.
    pub(crate) fn bandwidth(&self) -> Option<f64> {
        self.bytes.map(|bytes| bytes as f64 * 1e9 / self.time.median)
    }

    /// The shares of a device's peaks that are achieved: arithmetic, bandwidth.
    pub(crate) fn shares(&self, peak: &Peak) -> [Option<f64>; 2] {
        [self.arithmetic().map(|rate| rate / peak.flops), self.bandwidth().map(|rate| rate / peak.bytes)]
    }
}

/// The median of a span, nanoseconds.
pub(crate) fn span(times: Option<&Times>, name: &str) -> Option<Interval> {
    median_interval(&times?.phases.get(name)?.nanoseconds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::{Phase, Record, Run, Timing};

    fn cell(spans: &[(&str, f64)], counters: &[(&str, u64)]) -> Cell {
        let timing = |(name, time): &(&str, f64)| {
            let phase = if name.starts_with("shade") { Phase::Shade } else { Phase::Update };
            ((*name).to_owned(), Timing { phase, nanoseconds: vec![*time; 6] })
        };
        let counters = counters.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect();
        let run = Run { counters, ..Run::default() };
        let phases = spans.iter().map(timing).collect();
        let times = Times { run: run.cell.key(), taken: 0, beside: 1, phases, calibration: Default::default() };
        Cell { outcome: Record::Run(Box::new(run)), times: Some(times), scores: Vec::new(), twin: None }
    }

    #[test]
    fn shares_are_work_over_time_over_peak() {
        let spans = [
            ("shade", 9e5),
            ("shade/all/gather (gpu clock)", 2e5),
            ("update again/upload", 1e5),
            ("shade/all/gather", 3e5),
        ];
        let found =
            passes(&cell(&spans, &[("flops (gather)", 6_000_000), ("bytes (gather)", 100_000), ("flops (other)", 7)]));
        let [pass] = &found[..] else { panic!("one pass: {found:?}") };
        // 6e6 in 0.2 ms are 30 Gflop/s, 1e5 bytes 0.5 GB/s.
        assert_eq!((pass.name.as_str(), pass.arithmetic(), pass.bandwidth()), ("gather", Some(3e10), Some(5e8)));
        let shares = pass.shares(&Peak { flops: 6e10, bytes: 2e9 });
        assert_eq!(shares, [Some(0.5), Some(0.25)]);
    }

    #[test]
    fn without_a_clock_spans_of_stated_work_are_passes() {
        let spans = [("shade/gather", 2e5), ("shade/fit", 1e5), ("prepare/gather", 1e5)];
        let found = passes(&cell(&spans, &[("flops (gather)", 1000)]));
        assert_eq!(found.iter().map(|pass| (pass.name.as_str(), pass.bytes)).collect::<Vec<_>>(), [("gather", None)]);
        assert!(passes(&cell(&spans, &[])).is_empty());
    }
}
