//! Frames that follow each other: how errors change, what pops, and what a frame costs.

pub(super) mod changes;
pub(super) mod tables;
pub(super) mod times;

use halflight_reports::{Axis, Mark, Plot, Series};

/// A value a frame, from a first one on.
pub(super) fn frames(name: &str, values: &[f64], first: usize) -> Series {
    Series::new(name, Mark::Line, values.iter().enumerate().map(|(t, value)| ((t + first) as f64, *value)))
}

/// Radiance over frames.
pub(super) fn plot(title: &str, series: Vec<Series>) -> Plot {
    Plot { title: title.into(), across: Axis::linear("frame"), upwards: Axis::linear("radiance"), series }
}
