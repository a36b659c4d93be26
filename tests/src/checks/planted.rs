//! Faults planted in a shader.

use halflight_contract::{Backend, Job, Prepared, Result};

use super::Case;

/// Text of a shader, and what is put in its place.
pub type Fault = (&'static str, &'static str);

/// How far the GPU is from the CPU without a fault, and with each of these alone. `prepare` makes the method ready with a fault in its
/// shader; texts that stand for themselves are none.
///
/// # Panics
/// If the method cannot be run.
pub fn planted<'a>(
    case: &Case<'a>,
    faults: &[Fault],
    prepare: impl Fn(&Job<'a, '_>, Fault) -> Result<Box<dyn Prepared + 'a>>,
) -> (f32, Vec<f32>) {
    let cpu = case.fresh(&case.frames[0]).expect("runs on the CPU");
    let distance = |fault| {
        let job = Job::new(case.scene, &case.params, 1, Backend::GPU, &case.cache);
        let mut prepared = prepare(&job, fault).unwrap_or_else(|error| panic!("{fault:?}: {error}"));
        let gpu = case.run(&mut *prepared, &case.frames[0]).expect("runs on the GPU");
        cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max)
    };
    (distance(("", "")), faults.iter().map(|fault| distance(*fault)).collect())
}
