//! Methods at work on fields that move, timed.

use std::time::Instant;

use glam::Quat;
use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, Params, Prepared, Quantity};
use halflight_horizon_wedges::Variant;
use halflight_scenes::{Frame, HeightField, Light, PosedLight, PosedObject, Revision, Scene, Shape};

/// A method with parameters on a scene.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) scene: Scene,
    pub(crate) method: Variant,
    pub(crate) params: Vec<(&'static str, &'static str)>,
    pub(crate) motion: Motion,
    /// Under which horizons are sought, with those parameters' defaults.
    pub(crate) azimuths: usize,
}

/// A shipped scene.
pub(crate) fn scene(name: &str) -> Scene {
    halflight_scenes::find(name).expect("a shipped scene")
}

/// Its key lights alone.
pub(crate) fn keys(mut scene: Scene) -> Scene {
    scene.lights.retain(|light| matches!(light.rest, Light::Key(_)));
    scene
}

/// What differs from one frame to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    /// All heights.
    Heights,
    /// Heights of a few rows.
    Rows,
    /// The azimuths of key lights.
    Lights,
}

/// The first frame, and one that differs.
fn moving(scene: &Scene, motion: Motion) -> [Frame; 2] {
    let first = scene.frame(0);
    let mut second = first.clone();
    match motion {
        Motion::Lights => second.lights.iter_mut().for_each(turn),
        Motion::Heights | Motion::Rows => {
            second.objects.iter_mut().for_each(|posed| rise(posed, motion == Motion::Heights));
        }
    }
    [first, second]
}

fn turn(posed: &mut PosedLight) {
    if let Light::Key(key) = &mut posed.light {
        key.direction = Quat::from_rotation_z(0.02) * key.direction;
        posed.revision = Revision(posed.revision.0 ^ 1);
    }
}

fn rise(posed: &mut PosedObject, everywhere: bool) {
    /// Rows that differ if not all do.
    const ROWS: std::ops::Range<usize> = 100..108;
    if let Shape::Heights(field) = &*posed.shape {
        let size = [field.columns(), field.rows()];
        let risen = |(vertex, height): (usize, &f32)| {
            if everywhere || ROWS.contains(&(vertex / size[0])) { 1.01 * height } else { *height }
        };
        let heights = field.heights().iter().enumerate().map(risen).collect();
        let field = HeightField::new(size, field.origin(), field.cell(), heights);
        posed.shape = std::sync::Arc::new(Shape::Heights(field));
        posed.revision = Revision(posed.revision.0 ^ 1);
    }
}

/// Milliseconds of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Times {
    pub(crate) update: f64,
    pub(crate) evaluate: f64,
    /// Of all threads' processors.
    pub(crate) processors: f64,
}

/// A case made ready.
pub(crate) struct Running<'s> {
    pub(crate) case: &'s Case,
    pub(crate) frames: [Frame; 2],
    prepared: Box<dyn Prepared + 's>,
    pub(crate) times: Vec<Times>,
}

impl<'s> Running<'s> {
    pub(crate) fn new(case: &'s Case, cache: &Cache) -> Self {
        let params = Params::resolve(case.method.info().params, case.params.iter().copied()).expect("settings");
        let job = Job::new(&case.scene, &params, 1, Backend::Cpu, cache);
        let prepared = case.method.prepare(&job, &mut Silent).expect("a scene for the method");
        let mut running = Running { case, frames: moving(&case.scene, case.motion), prepared, times: Vec::new() };
        running.round(); // not timed: memory is touched
        running.times.clear();
        running
    }

    /// Both frames once.
    pub(crate) fn round(&mut self) {
        for frame in &self.frames {
            let (spent, start) = (processor_time(), Instant::now());
            self.prepared.update(frame, &mut Silent).expect("a frame of the scene");
            let middle = Instant::now();
            self.prepared.evaluate(frame, Quantity::Direct, &mut Silent).expect("direct light");
            let [update, evaluate] = [middle - start, middle.elapsed()].map(|time| 1e3 * time.as_secs_f64());
            self.times.push(Times { update, evaluate, processors: processor_time() - spent });
        }
    }

    /// The number of receivers that are shaded.
    pub(crate) fn receivers(&self) -> usize {
        self.frames[0].receivers.valid.iter().filter(|valid| **valid).count()
    }

    /// Milliseconds of all threads' processors a frame: the mean, since the system counts in steps of some milliseconds.
    pub(crate) fn processors(&self) -> f64 {
        self.times.iter().map(|times| times.processors).sum::<f64>() / self.times.len() as f64
    }

    /// What a share of the frames takes at most.
    pub(crate) fn quantile(&self, share: f64, value: impl Fn(&Times) -> f64) -> f64 {
        let mut values: Vec<f64> = self.times.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values[((values.len() - 1) as f64 * share).round() as usize]
    }
}

/// Milliseconds that all threads have run, 0 where the system does not tell.
pub(crate) fn processor_time() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let told = threads.filter_map(|thread| std::fs::read_to_string(thread.path().join("schedstat")).ok());
    told.filter_map(|text| text.split(' ').next()?.parse::<f64>().ok()).sum::<f64>() * 1e-6
}

/// Nobody is told.
struct Silent;

impl Meter for Silent {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}
