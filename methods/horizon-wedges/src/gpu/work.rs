//! What the passes did: for `Meter::work`.

use halflight_contract::Meter;
use halflight_sh::{coefficients, wgsl};

use crate::plan::{Plan, View};

/// Operations on a coefficient of a wedge between two angles: three steps from an entry to the next, two fused sums.
const INTERIOR: u64 = 13;
/// On one of a boundary: a step and two fused sums.
const BOUNDARY: u64 = 7;
/// On one of a visibility: a fused sum and the window.
const TURN: u64 = 3;

/// Wedges of a view summed up at so many receivers, so many coefficients of visibility written.
fn wedges(view: &View, receivers: u64, written: u64) -> [u64; 2] {
    let (size, tables) = (coefficients(view.tables.order) as u64, view.tables.bytes() as u64);
    let interior = view.wedges.iter().filter(|wedge| wedge.end.is_some()).count() as u64;
    let boundaries = view.wedges.len() as u64 - interior;
    let operations = size * (INTERIOR * interior + BOUNDARY * boundaries) + TURN * written;
    [receivers * operations, receivers * (4 * view.azimuths as u64 + 4 * written) + tables]
}

/// A view's light at so many receivers: transfer, three dot products, albedo; visibility, receiver and result, read again after the first.
fn shade(order: usize, follows: bool, receivers: u64) -> [u64; 2] {
    let (each, size) = (wgsl::operations(order), coefficients(order) as u64);
    let operations = each.rotate_zonal + each.product + 6 * size + 6;
    let results = if follows { 24 } else { 12 };
    [receivers * operations, receivers * (4 * size + 32 + results)]
}

/// Visibility through the last view.
pub(super) fn tell_seen(plan: &Plan, receivers: u64, written: u64, meter: &mut dyn Meter) {
    if let Some(view) = plan.views.last() {
        let [operations, bytes] = wedges(view, receivers, written);
        meter.work("wedges", operations, bytes);
    }
}

/// Light through all views.
pub(super) fn tell_lit(plan: &Plan, receivers: u64, meter: &mut dyn Meter) {
    for (number, view) in plan.views.iter().enumerate() {
        let order = view.tables.order;
        let [operations, bytes] = wedges(view, receivers, coefficients(order) as u64);
        meter.work("wedges", operations, bytes);
        let [operations, bytes] = shade(order, number > 0, receivers);
        meter.work("shade", operations, bytes);
    }
}
