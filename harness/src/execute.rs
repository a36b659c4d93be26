//! Running a method on a scene: prepare once; for every frame update, evaluate and read; for other settings retune as far as
//! their phases allow; everything counted. Times are taken apart, side by side with other methods (`rounds.rs`).
//!
//! **What is shared.** A phase that was carried out for another cell and serves this one too (`prepare` of the same scene, or
//! `update` of the same frame where only parameters of `evaluate` differ) is not carried out again; this cell names the
//! other. Counters and derived data are those that a cell by itself would have.
//!
//! An error or a panic of the method ends the frame at hand, not the program; the next frame is prepared anew.

use crate::recorder::{Recorded, Recorder, Steps};
use crate::sway::Motion;
use halflight_contract::{Backend, Cache, Job, Meter, Method, Output, Params, Prepared, Quantity};
use halflight_results::{Key, Phase, Storage};
use halflight_scenes::{Frame, Rgb, Scene};
use std::collections::BTreeMap;
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
    /// Phases that were carried out for another cell, by name, and that cell.
    pub(crate) shared: BTreeMap<String, Key>,
}

/// A method made ready.
pub(crate) struct Ready<'s> {
    pub(crate) method: Box<dyn Prepared + 's>,
    pub(crate) prepared: Done,
    /// The frame that it stands at.
    updated: Option<(usize, Done)>,
}

/// A phase that was carried out, what it left in the meter, and the cell that it was carried out for.
pub(crate) struct Done {
    phase: Phase,
    pub(crate) recorded: Recorded,
    cell: Key,
}

impl Done {
    /// Adds to a cell's record what the phase left, and whose it was if not this cell's.
    fn serve(&self, cell: &Key, recorded: &mut Recorded, shared: &mut BTreeMap<String, Key>) {
        recorded.add(self.recorded.clone());
        if self.cell != *cell {
            shared.insert(self.phase.name().to_owned(), self.cell.clone());
        }
    }
}

/// The state of a task between its frames and settings.
pub(crate) struct Runner<'a> {
    task: Task<'a>,
    ready: Option<Ready<'a>>,
}

impl<'a> Runner<'a> {
    pub(crate) fn new(task: Task<'a>) -> Self {
        Self { task, ready: None }
    }

    /// Goes over to other parameters of the method: what is ready is retuned where their phases allow, or else given up.
    pub(crate) fn tune(&mut self, params: &'a Params) {
        let before = std::mem::replace(&mut self.task.params, params);
        let Some(phase) = params.first_change(before, self.task.method.info().params) else { return };
        let Some(mut ready) = self.ready.take().filter(|_| phase > halflight_contract::Phase::Prepare) else { return };
        let retune = || ready.method.retune(params).map_err(text).map(|()| ready);
        // A method that cannot be retuned after all is prepared.
        self.ready = guarded(retune).ok().map(|ready| Ready {
            updated: ready.updated.filter(|_| phase == halflight_contract::Phase::Evaluate),
            ..ready
        });
    }

    /// Shades one frame as a cell; a failure says in words what went wrong.
    pub(crate) fn shade(&mut self, frame: &Frame, cell: &Key, steps: &mut Steps<'_>) -> Result<Shaded, String> {
        let ready = self.ready.take();
        let work = || {
            let mut ready = match ready {
                Some(ready) => ready,
                None => prepare_once(&self.task, cell, steps)?,
            };
            let shaded = shade(&self.task, &mut ready, frame, cell, steps)?;
            Ok((shaded, ready))
        };
        let (shaded, ready) = guarded(work)?;
        self.ready = Some(ready);
        Ok(shaded)
    }

    /// Shades one frame for its picture alone.
    pub(crate) fn picture(&mut self, frame: &Frame, steps: &mut Steps<'_>) -> Result<Shaded, String> {
        self.shade(frame, &Key::of_bytes(b"no cell"), steps)
    }

    /// Coefficients of visibility at the receivers of a frame that was shaded last, `order²` a receiver.
    pub(crate) fn visibility(&mut self, frame: &Frame, order: u8, steps: &mut Steps<'_>) -> Result<Vec<f32>, String> {
        let Some(ready) = &mut self.ready else { return Err("expected a shaded frame first".into()) };
        let quantity = Quantity::Visibility { order };
        let mut meter = Recorder::new(steps);
        ready.updated = None;
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
pub(crate) fn prepare_once<'s>(task: &Task<'s>, cell: &Key, steps: &mut Steps<'_>) -> Result<Ready<'s>, String> {
    let job = Job::new(task.scene, task.params, task.seed, task.backend, task.cache);
    let (method, prepared) = carry_out(Phase::Prepare, cell, steps, |meter| task.method.prepare(&job, meter))?;
    Ok(Ready { method, prepared, updated: None })
}

/// Carries out a whole phase for a cell.
fn carry_out<T>(
    phase: Phase,
    cell: &Key,
    steps: &mut Steps<'_>,
    work: impl FnOnce(&mut dyn Meter) -> halflight_contract::Result<T>,
) -> Result<(T, Done), String> {
    let (mut recorder, mut recorded) = (Recorder::new(steps), Recorded::default());
    let result = recorder.phase(&mut recorded, phase, phase.name(), work).map_err(text)?;
    recorder.settle(&mut recorded);
    Ok((result, Done { phase, recorded, cell: cell.clone() }))
}

fn shade(
    task: &Task<'_>,
    ready: &mut Ready<'_>,
    frame: &Frame,
    cell: &Key,
    steps: &mut Steps<'_>,
) -> Result<Shaded, String> {
    let method = &mut ready.method;
    let updated = match ready.updated.take().filter(|(index, _)| *index == frame.index) {
        Some((_, updated)) => updated,
        None => carry_out(Phase::Update, cell, steps, |meter| method.update(frame, meter))?.1,
    };
    let (mut recorded, mut shared) = (Recorded::default(), BTreeMap::new());
    ready.prepared.serve(cell, &mut recorded, &mut shared);
    updated.serve(cell, &mut recorded, &mut shared);
    ready.updated = Some((frame.index, updated));

    let mut recorder = Recorder::new(steps);
    let mut radiance = vec![Rgb::NAN; frame.receivers.len()];
    evaluate(task, method.as_mut(), frame, &mut recorder, &mut recorded, &mut radiance)?;
    recorder.settle(&mut recorded);
    match radiance.iter().position(|value| !value.is_finite()) {
        Some(receiver) => {
            Err(format!("radiance at receiver {receiver} is {}, expected finite values", radiance[receiver]))
        }
        None => Ok(Shaded { radiance, recorded, footprint: footprint(method.as_ref()), shared }),
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

/// What updates of a method are called that has shaded before: what each frame of a moving scene takes. The first one makes receivers
/// and memory ready too.
pub(crate) const AGAIN: &str = "update again";

/// Updates from one frame to another; the latter is timed.
pub(crate) fn update_again(
    ready: &mut Ready<'_>,
    Motion { from, to }: Motion<'_>,
    recorded: &mut Recorded,
) -> Result<(), String> {
    let mut silent = |_: &str, _: u64, _: u64| ();
    let mut recorder = Recorder::new(&mut silent);
    if let Some(from) = from {
        ready.method.update(from, &mut recorder).map_err(text)?;
    }
    recorder.phase(recorded, Phase::Update, AGAIN, |meter| ready.method.update(to, meter)).map_err(text)
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
