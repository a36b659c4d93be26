//! Views, wedges and tables as the shaders read them.

use std::fmt::Write;

use halflight_sh::{Block, LANES, coefficients, wgsl};

use crate::plan::View;
use crate::swath::Wedge;
use crate::table::{ELEVATIONS, PER_RADIAN, Wedges};

/// What stands for the end of a boundary.
const BOUNDARY: u32 = u32::MAX;

/// The text of what adds wedges up.
pub(super) fn wedges_text(order: usize) -> String {
    let mut text = String::new();
    let numbers =
        [("ORDER", order), ("SIZE", coefficients(order)), ("QUADS", quads(order)), ("ELEVATIONS", ELEVATIONS)];
    for (name, value) in numbers {
        writeln!(text, "const {name}: u32 = {value}u;").expect("a string");
    }
    writeln!(text, "const PER_RADIAN: f32 = {:?}f;", PER_RADIAN as f32).expect("a string");
    text + include_str!("../wgsl/view.wgsl") + include_str!("../wgsl/wedges.wgsl")
}

/// The text of what shades.
pub(super) fn shade_text(order: usize) -> String {
    wgsl::algebra(order) + include_str!("../wgsl/view.wgsl") + include_str!("../wgsl/shade.wgsl")
}

/// Fours of coefficients.
fn quads(order: usize) -> usize {
    coefficients(order).div_ceil(4)
}

/// The coefficients of blocks, `rows` of them a vector, in fours.
fn packed(order: usize, blocks: &[Block<f32>]) -> impl Iterator<Item = f32> {
    let rows = crate::table::rows(order);
    let vector = move |blocks: &[Block<f32>]| {
        let values: Vec<f32> = blocks.iter().flat_map(|block| block.0).collect();
        values.into_iter().take(4 * quads(order))
    };
    const { assert!(LANES.is_multiple_of(4)) };
    blocks.chunks_exact(rows).flat_map(vector)
}

/// Tables: wedges by two angles, then boundaries.
pub(super) fn tables(tables: &Wedges) -> Vec<f32> {
    let Wedges { order, interior, boundary } = tables;
    packed(*order, interior).chain(packed(*order, boundary)).collect()
}

/// The wedges of a swath.
pub(super) fn wedges(order: usize, wedges: &[Wedge]) -> Vec<u32> {
    let words = |wedge: &Wedge| {
        let head = [wedge.start as u32, wedge.end.map_or(BOUNDARY, |end| end as u32), 0, 0];
        head.into_iter().chain(packed(order, &wedge.turn).map(f32::to_bits)).collect::<Vec<_>>()
    };
    wedges.iter().flat_map(words).collect()
}

/// A view of which so many coefficients are wanted; `follows`: after others.
pub(super) fn view(view: &View, wanted: usize, follows: bool, window: &[f32]) -> Vec<u32> {
    let order = view.tables.order;
    let head = [view.first, view.wedges.len(), wanted, usize::from(follows)].map(|value| value as u32);
    let factors = (0..order).flat_map(|l| std::iter::repeat_n(window[l], 2 * l + 1));
    head.into_iter().chain(factors.chain(view.light.iter().flatten().copied()).map(f32::to_bits)).collect()
}
