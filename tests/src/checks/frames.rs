//! What `update` carries from frame to frame.

use halflight_contract::{Coupling, NoMeter};
use halflight_scenes::Frame;

use super::altered::with_receivers;
use super::{Case, Verdict, Violation, same_bits};

/// Whatever frames came before, going on, going back, jumping, or with fewer receivers, a frame's result has the bits
/// of a method made ready for that frame alone.
pub fn fresh_equals_updated(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("fresh_equals_updated", || {
        let frames = walk(case);
        let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
        let mut before = String::from("start");
        for frame in &frames {
            let found = case.run(&mut *prepared, frame)?;
            let now = format!("frame {} with {} receivers", frame.index, frame.receivers.len());
            same_bits(format_args!("{now} after {before}"), &case.fresh(frame)?, &found)?;
            before = now;
        }
        Ok(Verdict::Held)
    })
}

/// On through all frames, back to the first, a jump to the last that passes the first without evaluation, and, where
/// receivers may be chosen freely, a frame with half of them and all again.
fn walk(case: &Case<'_>) -> Vec<Frame> {
    let (first, last) = (&case.frames[0], &case.frames[case.frames.len() - 1]);
    let on = case.frames.iter();
    let back = case.frames.iter().rev().skip(1);
    let mut frames: Vec<Frame> = on.chain(back).chain([last, first]).cloned().collect();
    if case.method.coupling(&case.params) != Coupling::Grid {
        let half: Vec<usize> = (0..first.receivers.len()).step_by(2).collect();
        frames.extend([with_receivers(first, &half), first.clone()]);
    }
    frames
}
