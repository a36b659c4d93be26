//! Visibility itself, in spherical harmonics.

use std::sync::Arc;

use halflight_contract::{Cache, Meter};
use halflight_scenes::{Frame, Scene};
use rayon::prelude::*;

use crate::estimate::visibility as blockers;
use crate::receiver::Receiver;
use crate::sampling::mix;
use crate::traced::Traced;
use crate::transport::{Plan, Visibilities};
use crate::{Quality, Reference, Request, Result};

/// The visibility of the distance at each receiver, projected into spherical harmonics over the whole sphere of directions;
/// invalid receivers hold zeros.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibilityEstimate {
    /// SH order `n`.
    pub order: usize,
    /// `n²` coefficients a receiver.
    pub mean: Vec<f32>,
    /// Variance of each.
    pub variance: Vec<f32>,
    /// Independent batches; the variance's degrees of freedom are one less.
    pub batches: u32,
}

/// Projects the visibility that a reference has, of an order in `1..=8`, with `quality.max_samples` rays a receiver. The same
/// seed gives the same bits on any number of threads.
///
/// # Errors
/// A quality out of range, a reference that visibility does not serve, or derived data that cannot be made.
pub fn visibility(
    reference: &Reference,
    order: usize,
    scene: &Scene,
    frame: &Frame,
    quality: &Quality,
    seed: u64,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<VisibilityEstimate> {
    let quantity = halflight_contract::Quantity::Visibility { order: order as u8 };
    let request = Request { reference, quantity, scene, frame, quality, seed };
    quality.check()?;
    reference.serves(quantity, scene).map_err(|reason| request.not_served(reason))?;
    let traced = Arc::new(Traced::new(scene, frame, reference));
    let visibility = blockers(&request, &traced, cache, meter)?;
    let count = order * order;
    let plan =
        Plan { batches: quality.batches, per_batch: quality.max_samples.div_ceil(quality.batches).next_power_of_two() };
    let mut result = VisibilityEstimate {
        order,
        mean: vec![0.0; count * frame.receivers.len()],
        variance: vec![0.0; count * frame.receivers.len()],
        batches: plan.batches,
    };
    let rows = result.mean.par_chunks_exact_mut(count).zip(result.variance.par_chunks_exact_mut(count));
    rows.enumerate().for_each_init(Visibilities::default, |memory, (index, (mean, variance))| {
        if frame.receivers.valid[index] {
            let receiver = Receiver::of(frame, index);
            memory.visibility(&visibility, &receiver, order, plan, mix(seed, index as u64), |i, value, error| {
                (mean[i], variance[i]) = (value as f32, error as f32);
            });
        }
    });
    Ok(result)
}
