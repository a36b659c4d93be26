//! Timing methods side by side: every round times each of them once, so that what slows the machine for a while slows all,
//! and their ratios stay right.
//!
//! Each is prepared and updated, once each and timed, and shades once to warm up. Then come the rounds: in each the
//! calibration's fixed work, then every method's `update` from another frame, told apart as `update again`, its `shade` (one `evaluate`) and
//! `read`. In a round where preparing anew is cheap, `prepare` and `update` are timed again on an instance that is thrown away. A method that is to use other threads
//! than the rest runs in a pool of its own.

use crate::calibrate::Calibrator;
use crate::execute::{Ready, Task, evaluate, guarded, prepare_once, update, update_again};
use crate::recorder::{Recorded, Recorder};
use crate::sway::Motion;
use halflight_results::{Calibration, Key, Phase, Timing};
use halflight_scenes::{Frame, Rgb};
use rayon::ThreadPool;
use std::collections::BTreeMap;

/// Preparing and updating again is cheap up to so many nanoseconds.
const CHEAP: f64 = 10e6;

/// A method that is timed.
pub(crate) struct Entrant<'a> {
    task: Task<'a>,
    /// Where it runs; wherever the caller does if nothing is said.
    pool: Option<&'a ThreadPool>,
    ready: Option<Ready<'a>>,
}

/// Times of one method on one frame.
pub(crate) struct Timed {
    pub(crate) phases: BTreeMap<String, Timing>,
    pub(crate) calibration: Calibration,
}

/// A method on its way through the rounds of a frame.
struct Running<'e, 'a> {
    entrant: &'e mut Entrant<'a>,
    recorded: Recorded,
    radiance: Vec<Rgb>,
    calibration: Calibration,
}

impl<'a> Entrant<'a> {
    pub(crate) fn new(task: Task<'a>, pool: Option<&'a ThreadPool>) -> Self {
        Self { task, pool, ready: None }
    }
}

/// Times these methods on a frame, updated from another one if there is any; a failure says in words what went wrong, and leaves the others to go on.
pub(crate) fn side_by_side(
    entrants: Vec<&mut Entrant<'_>>,
    motion: Motion<'_>,
    repeats: usize,
    calibrator: &Calibrator,
) -> Vec<Result<Timed, String>> {
    let warm_up = |entrant| Running::begin(entrant, motion.to);
    let mut all: Vec<_> = entrants.into_iter().map(warm_up).collect();
    for _ in 0..repeats {
        let mut measured: Vec<(usize, [f64; 2])> = Vec::new();
        for one in &mut all {
            let Ok(running) = one else { continue };
            if let Err(error) = running.round(motion, calibrator, &mut measured) {
                *one = Err(error);
            }
        }
    }
    all.into_iter().map(|one| one.map(Running::end)).collect()
}

impl<'e, 'a> Running<'e, 'a> {
    /// Makes a method ready for the rounds.
    fn begin(entrant: &'e mut Entrant<'a>, frame: &Frame) -> Result<Self, String> {
        let radiance = vec![Rgb::NAN; frame.receivers.len()];
        let mut running =
            Self { entrant, recorded: Recorded::default(), radiance, calibration: Calibration::default() };
        running.act(|task, ready, recorded, radiance| {
            let mut first = match ready.take() {
                Some(ready) => ready,
                None => prepare_once(task, &nobody(), &mut silent)?,
            };
            *recorded = Recorded { phases: first.prepared.recorded.phases.clone(), ..Recorded::default() };
            update(&mut first, frame, &mut Recorder::new(&mut silent), recorded)?;
            let mut warm_up = Recorded::default();
            evaluate(task, first.method.as_mut(), frame, &mut Recorder::new(&mut silent), &mut warm_up, radiance)?;
            *ready = Some(first);
            Ok(())
        })?;
        Ok(running)
    }

    /// One round; the calibration is measured once a round and number of threads.
    fn round(
        &mut self,
        Motion { from, to: frame }: Motion<'_>,
        calibrator: &Calibrator,
        measured: &mut Vec<(usize, [f64; 2])>,
    ) -> Result<(), String> {
        let threads = self.entrant.pool.map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
        let known = measured.iter().find(|(of, _)| *of == threads).map(|(_, sample)| *sample);
        let [compute, memory] = known.unwrap_or_else(|| {
            let sample = self.entrant.pool.map_or_else(|| calibrator.sample(), |p| p.install(|| calibrator.sample()));
            measured.push((threads, sample));
            sample
        });
        self.calibration.compute.push(compute);
        self.calibration.memory.push(memory);
        let again = self.is_cheap();
        self.act(|task, ready, recorded, radiance| {
            if again {
                let mut anew = prepare_once(task, &nobody(), &mut silent)?;
                recorded.add(std::mem::take(&mut anew.prepared.recorded));
                update(&mut anew, frame, &mut Recorder::new(&mut silent), recorded)?;
            }
            let Some(ready) = ready else { return Err("expected a method that is ready".into()) };
            update_again(ready, Motion { from, to: frame }, recorded)?;
            evaluate(task, ready.method.as_mut(), frame, &mut Recorder::new(&mut silent), recorded, radiance)
        })
    }

    /// Whether preparing and updating took little time.
    fn is_cheap(&self) -> bool {
        let first = |phase: Phase| self.recorded.phases.get(phase.name()).map_or(0.0, |timing| timing.nanoseconds[0]);
        first(Phase::Prepare) + first(Phase::Update) <= CHEAP
    }

    /// Does work in the entrant's pool; what fails or panics is given up.
    fn act(
        &mut self,
        work: impl FnOnce(&Task<'a>, &mut Option<Ready<'a>>, &mut Recorded, &mut [Rgb]) -> Result<(), String> + Send,
    ) -> Result<(), String> {
        let Self { entrant: Entrant { task, pool, ready }, recorded, radiance, .. } = self;
        let result = {
            let (task, ready) = (&*task, &mut *ready);
            let act = move || guarded(|| work(task, ready, recorded, radiance));
            match pool {
                Some(pool) => pool.install(act),
                None => act(),
            }
        };
        if result.is_err() {
            *ready = None;
        }
        result
    }

    fn end(self) -> Timed {
        Timed { phases: self.recorded.phases, calibration: self.calibration }
    }
}

/// What is timed is done for no cell's picture.
fn nobody() -> Key {
    Key::of_bytes(b"no cell")
}

/// Rounds are short and many: nobody is told of their steps.
fn silent(_: &str, _: u64, _: u64) {}
