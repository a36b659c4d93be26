//! The meter that records: it reads the clock, so that methods need not.

use halflight_contract::{Flow, Meter};
use halflight_results::{Phase, Timing};
use std::collections::BTreeMap;
use std::time::Instant;

/// Told of the progress within a step: what is done, how much, of how much.
pub(crate) type Steps<'p> = dyn FnMut(&str, u64, u64) + 'p;

/// Spans, counters and derived data of a method's work, phase by phase.
pub(crate) struct Recorder<'p> {
    steps: &'p mut Steps<'p>,
    open: Vec<(&'static str, Instant)>,
    /// Nanoseconds of the present phase by the path of span names.
    spans: BTreeMap<String, f64>,
    counters: BTreeMap<String, u64>,
    derived: BTreeMap<String, f64>,
}

/// What was recorded, in the form of a result line.
#[derive(Clone, Debug, Default)]
pub(crate) struct Recorded {
    pub(crate) phases: BTreeMap<String, Timing>,
    pub(crate) counters: BTreeMap<String, u64>,
    pub(crate) derived: BTreeMap<String, f64>,
}

impl<'p> Recorder<'p> {
    pub(crate) fn new(steps: &'p mut Steps<'p>) -> Self {
        Self { steps, open: Vec::new(), spans: BTreeMap::new(), counters: BTreeMap::new(), derived: BTreeMap::new() }
    }

    /// Runs a piece of work as `name` of a phase and adds its time, and that of the spans inside, to `recorded`.
    ///
    /// The name is the phase's own for the whole of it; a span inside is called by its path, such as `shade/accumulate`.
    pub(crate) fn phase<T>(
        &mut self,
        recorded: &mut Recorded,
        phase: Phase,
        name: &str,
        work: impl FnOnce(&mut dyn Meter) -> T,
    ) -> T {
        self.open.clear();
        self.spans.clear();
        let start = Instant::now();
        let result = work(self);
        recorded.time(phase, name.to_owned(), start.elapsed().as_nanos() as f64);
        for (path, nanoseconds) in std::mem::take(&mut self.spans) {
            recorded.time(phase, format!("{name}/{path}"), nanoseconds);
        }
        result
    }

    /// Moves the counters and derived data met so far to `recorded`, adding to what is there.
    pub(crate) fn settle(&mut self, recorded: &mut Recorded) {
        for (name, amount) in std::mem::take(&mut self.counters) {
            *recorded.counters.entry(name).or_default() += amount;
        }
        for (name, nanoseconds) in std::mem::take(&mut self.derived) {
            *recorded.derived.entry(name).or_default() += nanoseconds;
        }
    }
}

impl Recorded {
    /// Takes in what was recorded elsewhere.
    pub(crate) fn add(&mut self, more: Recorded) {
        for (name, timing) in more.phases {
            let held = self.phases.entry(name).or_insert(Timing { phase: timing.phase, nanoseconds: Vec::new() });
            held.nanoseconds.extend(timing.nanoseconds);
        }
        for (name, amount) in more.counters {
            *self.counters.entry(name).or_default() += amount;
        }
        for (name, nanoseconds) in more.derived {
            *self.derived.entry(name).or_default() += nanoseconds;
        }
    }

    fn time(&mut self, phase: Phase, name: String, nanoseconds: f64) {
        let timing = self.phases.entry(name).or_insert(Timing { phase, nanoseconds: Vec::new() });
        timing.nanoseconds.push(nanoseconds);
    }
}

impl Meter for Recorder<'_> {
    fn begin(&mut self, span: &'static str) {
        self.open.push((span, Instant::now()));
    }

    fn end(&mut self) {
        let path = self.open.iter().map(|(name, _)| *name).collect::<Vec<_>>().join("/");
        if let Some((_, start)) = self.open.pop() {
            *self.spans.entry(path).or_default() += start.elapsed().as_nanos() as f64;
        }
    }

    fn count(&mut self, counter: &'static str, amount: u64) {
        *self.counters.entry(counter.to_owned()).or_default() += amount;
    }

    fn progress(&mut self, what: &'static str, done: u64, total: u64) -> Flow {
        (self.steps)(what, done, total);
        Flow::Continue
    }

    fn gpu(&mut self, pass: &'static str, nanoseconds: u64) {
        let open = self.open.iter().map(|(name, _)| format!("{name}/")).collect::<String>();
        *self.spans.entry(format!("{open}{pass} (gpu clock)")).or_default() += nanoseconds as f64;
    }

    fn work(&mut self, pass: &'static str, operations: u64, bytes: u64) {
        for (unit, amount) in [("flops", operations), ("bytes", bytes)] {
            *self.counters.entry(format!("{unit} ({pass})")).or_default() += amount;
        }
    }

    fn derived(&mut self, what: &'static str, nanoseconds: u64) {
        *self.derived.entry(what.to_owned()).or_default() += nanoseconds as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_contract::timed;

    #[test]
    fn spans_bear_their_path_and_repeats_stay_apart() {
        let mut silent = |_: &str, _: u64, _: u64| ();
        let (mut recorder, mut recorded) = (Recorder::new(&mut silent), Recorded::default());
        for _ in 0..3 {
            recorder.phase(&mut recorded, Phase::Shade, "shade", |meter| {
                for _ in 0..2 {
                    timed(meter, "outer", |meter| timed(meter, "inner", |meter| meter.count("work", 5)));
                }
                meter.end(); // one too many: of no consequence
            });
        }
        recorder.settle(&mut recorded);
        let names: Vec<_> = recorded.phases.keys().map(String::as_str).collect();
        assert_eq!(names, ["shade", "shade/outer", "shade/outer/inner"]);
        assert!(recorded.phases.values().all(|t| t.nanoseconds.len() == 3 && t.phase == Phase::Shade));
        let sum = |name: &str| recorded.phases[name].nanoseconds.iter().sum::<f64>();
        assert!(sum("shade") >= sum("shade/outer") && sum("shade/outer") >= sum("shade/outer/inner"));
        assert_eq!(recorded.counters["work"], 30);
        recorder.settle(&mut recorded);
        assert_eq!(recorded.counters["work"], 30);
    }
}
