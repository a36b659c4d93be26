//! The meter: where a method leaves its spans, counters and progress. It never reads a clock itself.

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Continue,
    /// Stop now with [`crate::Error::Cancelled`].
    Cancel,
}

/// Receives what a phase does. Spans nest.
pub trait Meter {
    /// Opens a named span of CPU wall time.
    fn begin(&mut self, span: &'static str);
    /// Closes the innermost span.
    fn end(&mut self);
    /// Adds work done or skipped to a named counter.
    fn count(&mut self, counter: &'static str, amount: u64);
    /// Tells how far a long step is; the answer may ask to stop.
    fn progress(&mut self, what: &'static str, done: u64, total: u64) -> Flow;
    /// Time that making derived data took, now or when it was first made; charged apart from the phases.
    fn derived(&mut self, what: &'static str, nanoseconds: u64);
    /// Time that a named pass took by a graphics processor's own clock; spans around it count waiting for it too.
    fn gpu(&mut self, _pass: &'static str, _nanoseconds: u64) {}
    /// Work that a named pass did at least: arithmetic operations, a fused one counted as two, and bytes that had to come from the
    /// processor's memory or go there.
    fn work(&mut self, _pass: &'static str, _operations: u64, _bytes: u64) {}
}

/// A meter that records nothing and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMeter;

impl Meter for NoMeter {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

/// Runs `work` inside a span.
pub fn timed<T>(meter: &mut dyn Meter, span: &'static str, work: impl FnOnce(&mut dyn Meter) -> T) -> T {
    meter.begin(span);
    let result = work(meter);
    meter.end();
    result
}

/// Adds each named amount to its counter, leaving zeros out.
pub fn counted(meter: &mut dyn Meter, amounts: &[(&'static str, u64)]) {
    amounts.iter().filter(|(_, amount)| *amount > 0).for_each(|(name, amount)| meter.count(name, *amount));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes down what it is told.
    #[derive(Default)]
    struct Log(Vec<String>);

    impl Meter for Log {
        fn begin(&mut self, span: &'static str) {
            self.0.push(format!("begin {span}"));
        }
        fn end(&mut self) {
            self.0.push("end".into());
        }
        fn count(&mut self, counter: &'static str, amount: u64) {
            self.0.push(format!("{counter} {amount}"));
        }
        fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
            Flow::Cancel
        }
        fn derived(&mut self, _: &'static str, _: u64) {}
    }

    #[test]
    fn a_span_is_closed_also_when_its_work_fails() {
        let mut log = Log::default();
        let failed: Result<(), ()> = timed(&mut log, "outer", |meter| {
            timed(meter, "inner", |meter| counted(meter, &[("squares", 2), ("products", 0)]));
            Err(())
        });
        assert_eq!(failed, Err(()));
        assert_eq!(log.0, ["begin outer", "begin inner", "squares 2", "end", "end"]);
    }
}
