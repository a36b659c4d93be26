//! Grids, steps and places as the shaders read them.

use crate::Azimuth;
use crate::grid::Grid;
use crate::level::NEAR;
use crate::pyramid::Scale;
use crate::shape::Shape;

/// Steps that lead farther, in cells, lead as far beyond any border.
const FARTHEST: f64 = (1 << 28) as f64;

/// Where a receiver is, in grid coordinates of a field of `[columns, rows]`, those outside moved to its border: whole numbers, then
/// fractions.
pub fn place(at: [f32; 2], size: [usize; 2]) -> [u32; 4] {
    // `max` first, so that NaN becomes 0.
    split([0, 1].map(|axis| f64::from(at[axis].max(0.0).min((size[axis] - 1) as f32))))
}

/// Whole numbers and fractions; what rounding takes off a whole number is one, so that what it leads to the border of is on it.
fn split(at: [f64; 2]) -> [u32; 4] {
    let at = at.map(|at| if (at - at.round()).abs() <= NEAR { at.round() } else { at });
    let whole = at.map(f64::floor);
    let [x, y] = [0, 1].map(|axis| ((at[axis] - whole[axis]) as f32).to_bits());
    let [i, j] = whole.map(|whole| whole as i32 as u32);
    [i, j, x, y]
}

/// Samples of grids.
pub(super) fn samples(grids: &[Grid]) -> u64 {
    grids.iter().map(|grid| (grid.size[0] * grid.size[1]) as u64).sum()
}

/// Bytes of their samples.
pub(super) fn bytes(grids: &[Grid]) -> u64 {
    4 * samples(grids)
}

/// Grids whose samples follow each other in a buffer.
pub(super) fn grids(grids: &[Grid]) -> impl Iterator<Item = u32> {
    let firsts = grids.iter().scan(0, |next, grid| {
        let first = *next;
        *next += samples(std::slice::from_ref(grid)) as u32;
        Some(first)
    });
    grids.iter().zip(firsts).flat_map(|(grid, first)| words(grid, first))
}

fn words(grid: &Grid, first: u32) -> [u32; 10] {
    let [columns, rows] = grid.size.map(|count| count as u32);
    let ([x, y], [left, down]) = (grid.lattice.scale, grid.lattice.shift);
    let halvings = |scale: f64| (-scale.log2()).round() as u32;
    let bits = |value: f64| (value as f32).to_bits();
    [columns, rows, halvings(x), halvings(y), bits(x), bits(y), bits(left), bits(down), first, 0]
}

/// The steps of azimuths, levels numbered from the coarsest that is looked at on.
pub(super) fn steps(shape: &Shape, azimuths: &[Azimuth], scale: Scale) -> Vec<[u32; 8]> {
    let coarsest = shape.coarsest();
    let of = |azimuth: &Azimuth| {
        let smooth = u32::from(scale.serving(azimuth.purpose) == Scale::BSpline);
        let word = move |step: crate::ray::Step| {
            let [i, j, x, y] = split(step.offset.map(|offset| offset.clamp(-FARTHEST, FARTHEST)));
            [i, j, x, y, (step.level - coarsest) as u32, step.inverse.to_bits(), smooth, 0]
        };
        shape.steps(azimuth.angle).into_iter().map(word)
    };
    azimuths.iter().flat_map(of).collect()
}
