//! Visibility itself, in spherical harmonics.

use std::sync::Arc;

use halflight_contract::{Cache, Meter, Quantity};
use halflight_sh::MAX_ORDER;
use rayon::prelude::*;

use crate::estimate::visibility as blockers;
use crate::receiver::Receiver;
use crate::sampling::mix;
use crate::traced::Traced;
use crate::transport::{Plan, Visibilities};
use crate::{Request, Result};

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

/// Projects the visibility that a reference has, with `quality.max_samples` rays a receiver. The same seed gives the same bits
/// on any number of threads.
///
/// # Errors
/// As [`Request::check`], a quantity other than visibility of an order in `1..=8`, or derived data that cannot be made.
pub fn visibility(request: &Request<'_>, cache: &Cache, meter: &mut dyn Meter) -> Result<VisibilityEstimate> {
    request.check()?;
    let Request { quality, frame, seed, .. } = *request;
    let order = match request.quantity {
        Quantity::Visibility { order } if (1..=MAX_ORDER).contains(&usize::from(order)) => usize::from(order),
        _ => return Err(request.not_served(format!("expected visibility of an order from 1 to {MAX_ORDER}"))),
    };
    let traced = Arc::new(Traced::new(request.scene, frame, request.reference));
    let visibility = blockers(request, &traced, cache, meter)?;
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
