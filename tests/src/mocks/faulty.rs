//! A wrapper that breaks one thing at a time.

use std::sync::atomic::{AtomicU64, Ordering};

use halflight_contract::{
    Error, Footprint, Info, Job, Meter, Method, Output, Params, Prepared, Quantity, Request, Result, Support,
};
use halflight_scenes::{Frame, Rgb, SceneFacts};

use super::Cancellable;

/// What [`Faulty`] breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Results keep the output's content at invalid receivers.
    SkipsInvalid,
    /// The second read gives zeros.
    ReadsOnce,
    /// Every evaluation is brighter than the one before.
    Accumulates,
    /// Divides by what may be nothing.
    DividesByZero,
    /// The receiver's number shows in its result.
    CountsReceivers,
    /// The first frame is kept for good.
    KeepsFirstFrame,
    /// The first light is kept for good.
    KeepsFirstLight,
    /// New parameters are ignored.
    IgnoresRetune,
    /// Of several new parameters the first alone is taken.
    RetunesOneParam,
    /// Parameters that need another `prepare` are taken.
    TakesPrepareParams,
    /// A cancel is told to nobody.
    HidesCancel,
    /// Progress is reported long after a cancel.
    LingersAfterCancel,
    /// An evaluation after a cancelled one gives zeros.
    SulksAfterCancel,
    /// Every `prepare` builds its data anew.
    BuildsAnew,
    /// Brightness is not linear in light.
    SquaresLight,
    /// A span is never closed.
    LeavesSpanOpen,
    /// A span is closed twice.
    ClosesSpanTwice,
    /// Memory is not counted.
    HidesMemory,
}

impl Fault {
    /// Every fault, with the check that must reject it.
    pub const ALL: [(Fault, &'static str); 18] = [
        (Fault::SkipsInvalid, "dirty_output"),
        (Fault::ReadsOnce, "repeated_evaluation"),
        (Fault::Accumulates, "repeated_evaluation"),
        (Fault::DividesByZero, "finite_output"),
        (Fault::CountsReceivers, "permuted_receivers"),
        (Fault::KeepsFirstFrame, "fresh_equals_updated"),
        (Fault::KeepsFirstLight, "turning_light"),
        (Fault::IgnoresRetune, "retuned_equals_fresh"),
        (Fault::RetunesOneParam, "retuned_equals_fresh"),
        (Fault::TakesPrepareParams, "retuned_equals_fresh"),
        (Fault::HidesCancel, "cancellation"),
        (Fault::LingersAfterCancel, "cancellation"),
        (Fault::SulksAfterCancel, "cancellation"),
        (Fault::BuildsAnew, "shared_derived_data"),
        (Fault::SquaresLight, "linear_in_light"),
        (Fault::LeavesSpanOpen, "meter_balanced"),
        (Fault::ClosesSpanTwice, "meter_balanced"),
        (Fault::HidesMemory, "footprint_counts_results"),
    ];
}

/// An honest mock with one fault.
pub struct Faulty {
    /// What is broken.
    pub fault: Fault,
    builds: AtomicU64,
}

impl Faulty {
    /// A method with this fault.
    pub fn new(fault: Fault) -> Self {
        Faulty { fault, builds: AtomicU64::new(0) }
    }
}

impl Method for Faulty {
    fn info(&self) -> &'static Info {
        Cancellable::HONEST.info()
    }

    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        Cancellable::HONEST.supports(facts, request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        if self.fault == Fault::BuildsAnew {
            meter.derived("build", self.builds.fetch_add(1, Ordering::Relaxed));
        }
        Ok(Box::new(Ready {
            fault: self.fault,
            inner: Cancellable::HONEST.prepare(job, meter)?,
            params: job.params.clone(),
            first: None,
            valid: Vec::new(),
            evaluations: 0,
            reads: 0,
            was_cancelled: false,
        }))
    }
}

struct Ready<'s> {
    fault: Fault,
    inner: Box<dyn Prepared + 's>,
    params: Params,
    first: Option<Frame>,
    valid: Vec<bool>,
    evaluations: u32,
    reads: u32,
    was_cancelled: bool,
}

impl Prepared for Ready<'_> {
    fn footprint(&self) -> Footprint {
        match self.fault {
            Fault::HidesMemory => Footprint::default(),
            _ => self.inner.footprint(),
        }
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        match self.fault {
            Fault::IgnoresRetune => params.retune(&mut self.params, Cancellable::HONEST.info().params),
            Fault::RetunesOneParam => self.retune_one(params),
            Fault::TakesPrepareParams => self.inner.retune(params).or(Ok(())),
            _ => self.inner.retune(params),
        }
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        let first = self.first.get_or_insert_with(|| frame.clone());
        match self.fault {
            Fault::KeepsFirstFrame => self.inner.update(first, meter),
            _ => self.inner.update(frame, meter),
        }
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        match self.fault {
            Fault::LeavesSpanOpen => meter.begin("open"),
            Fault::ClosesSpanTwice => meter.end(),
            _ => {}
        }
        self.valid.clone_from(&frame.receivers.valid);
        (self.evaluations, self.reads) = (self.evaluations + 1, 0);
        let lights = self.first.as_ref().map_or_else(Vec::new, |first| first.lights.clone());
        let result = match self.fault {
            Fault::KeepsFirstLight => self.inner.evaluate(&Frame { lights, ..frame.clone() }, quantity, meter),
            _ => self.inner.evaluate(frame, quantity, meter),
        };
        self.was_cancelled |= matches!(result, Err(Error::Cancelled));
        match (self.fault, &result) {
            (Fault::HidesCancel, Err(Error::Cancelled)) => Ok(()),
            (Fault::LingersAfterCancel, Err(Error::Cancelled)) => {
                for i in 0..100 {
                    let _ = meter.progress("lingering", i, 100);
                }
                result
            }
            _ => result,
        }
    }

    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()> {
        let Output::Radiance(out) = out else { return self.inner.read(out, meter) };
        let mut results = vec![Rgb::ZERO; out.len()];
        self.inner.read(Output::Radiance(&mut results), meter)?;
        self.reads += 1;
        for (i, result) in results.into_iter().enumerate() {
            if self.valid[i] {
                out[i] = self.spoiled(i, result);
            } else if self.fault != Fault::SkipsInvalid {
                out[i] = result;
            }
        }
        Ok(())
    }
}

impl Ready<'_> {
    fn retune_one(&mut self, params: &Params) -> Result<()> {
        let specs = Cancellable::HONEST.info().params;
        let first = params.iter().zip(self.params.iter()).find(|(new, old)| new != old).map(|((name, _), _)| name);
        let text: Vec<(&str, String)> = (self.params.iter().zip(params.iter()))
            .map(|((name, old), (_, new))| (name, if Some(name) == first { new.to_string() } else { old.to_string() }))
            .collect();
        let settings = text.iter().map(|(name, value)| (*name, value.as_str()));
        let one = Params::resolve(specs, settings).expect("both were in range");
        self.inner.retune(&one)?;
        self.params = one;
        Ok(())
    }

    /// The result that is given for receiver `i` in place of the right one.
    fn spoiled(&self, i: usize, result: Rgb) -> Rgb {
        match self.fault {
            Fault::ReadsOnce if self.reads > 1 => Rgb::ZERO,
            Fault::SulksAfterCancel if self.was_cancelled => Rgb::ZERO,
            Fault::Accumulates => result * self.evaluations as f32,
            Fault::DividesByZero => result / result.x,
            Fault::CountsReceivers => result + i as f32,
            Fault::SquaresLight => result * result,
            _ => result,
        }
    }
}
