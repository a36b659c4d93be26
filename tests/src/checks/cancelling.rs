//! What a method does when its caller asks it to stop.

use std::collections::BTreeSet;
use std::sync::Arc;

use halflight_contract::{Cache, Error, Meter, NoMeter, Prepared};

use super::meters::Watch;
use super::{Breach, Case, Verdict, Violation, ensure, same_bits};

/// Progress calls that a phase may still make after it was told to stop: a nested step may finish its own loop.
pub const MAX_CALLS_AFTER_CANCEL: u64 = 8;

/// A phase that is cancelled at its first, middle or last progress call stops soon with [`Error::Cancelled`], and the
/// next try that is not cancelled gives the right bits. Trivial for a method that reports no progress.
pub fn cancellation(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("cancellation", || {
        let frame = &case.frames[0];
        let expected = case.fresh(frame)?;
        let mut progress = false;
        for phase in [PhaseOf::Prepare, PhaseOf::Update, PhaseOf::Evaluate] {
            let calls = phase.calls(case)?;
            progress |= calls > 0;
            let moments = BTreeSet::from([1, calls.div_ceil(2), calls]);
            for call in moments.into_iter().filter(|call| (1..=calls).contains(call)) {
                let found = phase.stop_and_go_on(case, call).map_err(|Breach(found)| {
                    Breach(format!("{} cancelled at progress call {call} of {calls}: {found}", phase.name()))
                })?;
                let what = format_args!("{} tried again after cancelling at call {call} of {calls}", phase.name());
                same_bits(what, &expected, &found)?;
            }
        }
        Ok(if progress { Verdict::Held } else { Verdict::Exempt("it reports no progress") })
    })
}

#[derive(Clone, Copy)]
enum PhaseOf {
    Prepare,
    Update,
    Evaluate,
}

impl PhaseOf {
    fn name(self) -> &'static str {
        match self {
            PhaseOf::Prepare => "prepare",
            PhaseOf::Update => "update",
            PhaseOf::Evaluate => "evaluate",
        }
    }

    /// The cache for one try: an empty one where it decides what there is to do.
    fn cache(self, case: &Case<'_>) -> Arc<Cache> {
        match self {
            PhaseOf::Prepare => Arc::default(),
            PhaseOf::Update | PhaseOf::Evaluate => case.cache.clone(),
        }
    }

    /// Progress calls of an undisturbed run.
    fn calls(self, case: &Case<'_>) -> Result<u64, Breach> {
        let mut watch = Watch::default();
        let cache = self.cache(case);
        let mut prepared = self.ready(case, &cache)?;
        self.run(case, &cache, &mut prepared, &mut watch)?;
        Ok(watch.calls)
    }

    /// Cancels the phase at a progress call, then runs it and what follows to the end.
    fn stop_and_go_on(self, case: &Case<'_>, call: u64) -> Result<Vec<f32>, Breach> {
        let frame = &case.frames[0];
        let cache = self.cache(case);
        let mut prepared = self.ready(case, &cache)?;
        let mut watch = Watch::cancelling_at(call);
        match self.run(case, &cache, &mut prepared, &mut watch) {
            Err(Error::Cancelled) => {}
            Err(other) => return Err(other.into()),
            Ok(()) => return Err(Breach("it went on to Ok, expected Error::Cancelled".into())),
        }
        let late = watch.calls_after_cancel();
        ensure(late <= MAX_CALLS_AFTER_CANCEL, || {
            format!("{late} more progress calls before it stopped, expected at most {MAX_CALLS_AFTER_CANCEL}")
        })?;
        self.run(case, &cache, &mut prepared, &mut NoMeter)?;
        let prepared = prepared.as_mut().expect("prepared by now");
        Ok(match self {
            PhaseOf::Evaluate => case.read(&mut **prepared, frame, 0.0)?,
            PhaseOf::Update => case.shade(&mut **prepared, frame)?,
            PhaseOf::Prepare => case.run(&mut **prepared, frame)?,
        })
    }

    /// All that comes before this phase, done.
    fn ready<'a>(self, case: &Case<'a>, cache: &Cache) -> Result<Option<Box<dyn Prepared + 'a>>, Error> {
        if let PhaseOf::Prepare = self {
            return Ok(None);
        }
        let mut prepared = case.prepare(cache, &mut NoMeter)?;
        if let PhaseOf::Evaluate = self {
            prepared.update(&case.frames[0], &mut NoMeter)?;
        }
        Ok(Some(prepared))
    }

    /// The phase itself; the first one fills `prepared`.
    fn run<'a>(
        self,
        case: &Case<'a>,
        cache: &Cache,
        prepared: &mut Option<Box<dyn Prepared + 'a>>,
        meter: &mut dyn Meter,
    ) -> Result<(), Error> {
        let frame = &case.frames[0];
        match (self, prepared) {
            (PhaseOf::Update, Some(prepared)) => prepared.update(frame, meter),
            (PhaseOf::Evaluate, Some(prepared)) => prepared.evaluate(frame, case.quantity, meter),
            (_, prepared) => {
                *prepared = Some(case.prepare(cache, meter)?);
                Ok(())
            }
        }
    }
}
