//! Meters that watch, and the check of what they see.

use halflight_contract::{Error, Flow, Meter, NoMeter};

use super::{Case, Outcome, Verdict, Violation, ensure};

/// Watches spans, charges and progress, and cancels at a chosen progress call.
#[derive(Default)]
pub(super) struct Watch {
    /// Spans open now.
    pub(super) open: i64,
    /// Whether a span was closed that was not open.
    pub(super) closed_too_many: bool,
    /// Progress calls so far.
    pub(super) calls: u64,
    /// The call, from 1, to which the answer is the first `Cancel`.
    pub(super) cancel_at: Option<u64>,
    /// Build times charged.
    pub(super) charges: Vec<(&'static str, u64)>,
    /// Progress that went back, beyond its total, or finished without end.
    pub(super) bad_progress: Option<String>,
}

impl Watch {
    /// A watch that cancels at the given progress call, from 1.
    pub(super) fn cancelling_at(call: u64) -> Self {
        Watch { cancel_at: Some(call), ..Watch::default() }
    }

    /// Progress calls made after the first that was answered with `Cancel`.
    pub(super) fn calls_after_cancel(&self) -> u64 {
        self.cancel_at.map_or(0, |at| self.calls.saturating_sub(at))
    }
}

impl Meter for Watch {
    fn begin(&mut self, _: &'static str) {
        self.open += 1;
    }
    fn end(&mut self) {
        self.open -= 1;
        self.closed_too_many |= self.open < 0;
    }
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, what: &'static str, done: u64, total: u64) -> Flow {
        self.calls += 1;
        if done > total {
            self.bad_progress = Some(format!("{what}: {done} of {total} done"));
        }
        match self.cancel_at {
            Some(at) if self.calls >= at => Flow::Cancel,
            _ => Flow::Continue,
        }
    }
    fn derived(&mut self, what: &'static str, nanoseconds: u64) {
        self.charges.push((what, nanoseconds));
    }
}

/// Every phase closes exactly the spans that it opens, also when it is cancelled, and reports progress within its
/// total.
pub fn meter_balanced(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("meter_balanced", || {
        let frame = &case.frames[0];
        let mut prepared = balanced("prepare", None, |meter| case.prepare(&Default::default(), meter))?;
        balanced("update", None, |meter| prepared.update(frame, meter))?;
        balanced("evaluate", None, |meter| prepared.evaluate(frame, case.quantity, meter))?;
        case.read(&mut *prepared, frame, 0.0)?;
        cancelled(case)
    })
}

/// Phases cancelled at their first progress call.
fn cancelled(case: &Case<'_>) -> Outcome {
    let frame = &case.frames[0];
    let stopped = |error: &Error| matches!(error, Error::Cancelled);
    let accept = |result: Result<(), Error>| result.or_else(|error| if stopped(&error) { Ok(()) } else { Err(error) });
    balanced("cancelled prepare", Some(1), |meter| accept(case.prepare(&Default::default(), meter).map(drop)))?;
    let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
    balanced("cancelled update", Some(1), |meter| accept(prepared.update(frame, meter)))?;
    prepared.update(frame, &mut NoMeter)?;
    balanced("cancelled evaluate", Some(1), |meter| accept(prepared.evaluate(frame, case.quantity, meter)))?;
    Ok(Verdict::Held)
}

fn balanced<T>(
    phase: &str,
    cancel_at: Option<u64>,
    work: impl FnOnce(&mut dyn Meter) -> Result<T, Error>,
) -> Result<T, super::Breach> {
    let mut watch = Watch { cancel_at, ..Watch::default() };
    let value = work(&mut watch)?;
    ensure(!watch.closed_too_many, || format!("{phase}: a span is closed that was not open"))?;
    ensure(watch.open == 0, || format!("{phase}: {} spans left open", watch.open))?;
    ensure(watch.bad_progress.is_none(), || format!("{phase}: progress {}", watch.bad_progress.unwrap_or_default()))?;
    Ok(value)
}
