//! Running a method on a scene: prepare once; for every frame update, evaluate and read; everything counted. Times are taken
//! apart, side by side with other methods (`rounds.rs`).
//!
//! An error or a panic of the method ends the frame at hand, not the program; the next frame is prepared anew.

use crate::recorder::{Recorded, Recorder, Steps};
use halflight_contract::{Backend, Cache, Job, Meter, Method, Output, Params, Prepared, Quantity};
use halflight_results::{Phase, Storage};
use halflight_scenes::{Frame, Rgb, Scene};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A method to run on a scene.
pub(crate) struct Task<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) method: &'static dyn Method,
    pub(crate) params: &'a Params,
    pub(crate) quantity: Quantity,
    pub(crate) backend: Backend,
    pub(crate) seed: u64,
    pub(crate) cache: &'a Cache,
}

/// What came of a frame.
pub(crate) struct Shaded {
    pub(crate) radiance: Vec<Rgb>,
    pub(crate) recorded: Recorded,
    pub(crate) footprint: Vec<Storage>,
}

/// A method made ready, with what `prepare` left in the meter.
pub(crate) struct Ready<'s> {
    pub(crate) method: Box<dyn Prepared + 's>,
    pub(crate) recorded: Recorded,
}

/// The state of a task between its frames.
pub(crate) struct Runner<'a> {
    task: Task<'a>,
    ready: Option<Ready<'a>>,
}

impl<'a> Runner<'a> {
    pub(crate) fn new(task: Task<'a>) -> Self {
        Self { task, ready: None }
    }

    /// Shades one frame; a failure says in words what went wrong.
    pub(crate) fn shade(&mut self, frame: &Frame, steps: &mut Steps<'_>) -> Result<Shaded, String> {
        let ready = self.ready.take();
        let work = || {
            let mut ready = match ready {
                Some(ready) => ready,
                None => prepare_once(&self.task, steps)?,
            };
            let shaded = shade(&self.task, &mut ready, frame, steps)?;
            Ok((shaded, ready))
        };
        let (shaded, ready) = guarded(work)?;
        self.ready = Some(ready);
        Ok(shaded)
    }

    /// Coefficients of visibility at the receivers of a frame that was shaded last, `order²` a receiver.
    pub(crate) fn visibility(&mut self, frame: &Frame, order: u8, steps: &mut Steps<'_>) -> Result<Vec<f32>, String> {
        let Some(ready) = &mut self.ready else { return Err("expected a shaded frame first".into()) };
        let quantity = Quantity::Visibility { order };
        let mut meter = Recorder::new(steps);
        guarded(|| {
            let mut out = vec![f32::NAN; frame.receivers.len() * quantity.channels()];
            let prepared = &mut ready.method;
            prepared.update(frame, &mut meter).map_err(text)?;
            prepared.evaluate(frame, quantity, &mut meter).map_err(text)?;
            prepared.read(Output::Coefficients(&mut out), &mut meter).map_err(text)?;
            match out.iter().position(|v| !v.is_finite()) {
                Some(i) => Err(format!("coefficient {} is not finite", i % quantity.channels())),
                None => Ok(out),
            }
        })
    }
}

/// With a job of its own, since a job charges each piece of derived data once.
pub(crate) fn prepare_once<'s>(task: &Task<'s>, steps: &mut Steps<'_>) -> Result<Ready<'s>, String> {
    let job = Job::new(task.scene, task.params, task.seed, task.backend, task.cache);
    let mut recorder = Recorder::new(steps);
    let mut recorded = Recorded::default();
    let work = |meter: &mut dyn Meter| task.method.prepare(&job, meter);
    let method = recorder.phase(&mut recorded, Phase::Prepare, Phase::Prepare.name(), work).map_err(text)?;
    recorder.settle(&mut recorded);
    Ok(Ready { method, recorded })
}

fn shade(task: &Task<'_>, ready: &mut Ready<'_>, frame: &Frame, steps: &mut Steps<'_>) -> Result<Shaded, String> {
    let mut recorder = Recorder::new(steps);
    let mut recorded = ready.recorded.clone();
    let mut radiance = vec![Rgb::NAN; frame.receivers.len()];
    update(ready, frame, &mut recorder, &mut recorded)?;
    let method = &mut ready.method;
    evaluate(task, method.as_mut(), frame, &mut recorder, &mut recorded, &mut radiance)?;
    recorder.settle(&mut recorded);
    match radiance.iter().position(|value| !value.is_finite()) {
        Some(receiver) => {
            Err(format!("radiance at receiver {receiver} is {}, expected finite values", radiance[receiver]))
        }
        None => Ok(Shaded { radiance, recorded, footprint: footprint(method.as_ref()) }),
    }
}

/// All that a moving scene forces, timed.
pub(crate) fn update(
    ready: &mut Ready<'_>,
    frame: &Frame,
    recorder: &mut Recorder<'_>,
    recorded: &mut Recorded,
) -> Result<(), String> {
    let update = |meter: &mut dyn Meter| ready.method.update(frame, meter);
    recorder.phase(recorded, Phase::Update, Phase::Update.name(), update).map_err(text)
}

/// One evaluation and reading its result, timed.
pub(crate) fn evaluate(
    task: &Task<'_>,
    method: &mut dyn Prepared,
    frame: &Frame,
    recorder: &mut Recorder<'_>,
    recorded: &mut Recorded,
    radiance: &mut [Rgb],
) -> Result<(), String> {
    let evaluate = |meter: &mut dyn Meter| method.evaluate(frame, task.quantity, meter);
    recorder.phase(recorded, Phase::Shade, Phase::Shade.name(), evaluate).map_err(text)?;
    let read = |meter: &mut dyn Meter| method.read(Output::Radiance(radiance), meter);
    recorder.phase(recorded, Phase::Shade, "read", read).map_err(text)
}

fn footprint(method: &dyn Prepared) -> Vec<Storage> {
    let entries = method.footprint().entries;
    let storage = |(purpose, host_bytes, device_bytes): (&str, u64, u64)| Storage {
        purpose: purpose.to_owned(),
        host_bytes,
        device_bytes,
    };
    entries.into_iter().map(storage).collect()
}

/// Runs work and makes a panic an error. What the work had in hand is given up with it, so nothing half done is
/// seen afterwards.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Err(format!("panicked: {}", said.unwrap_or("without a message")))
    })
}

fn text(error: halflight_contract::Error) -> String {
    error.to_string()
}
