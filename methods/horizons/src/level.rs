//! A level of a pyramid: heights on a grid of its own.

use std::ops::Range;

use halflight_scenes::HeightField;
use rayon::prelude::*;

use crate::grid::{Grid, Lattice};

/// Entries beyond either end of a row, which repeat the row's end: a register that begins up to [`BEYOND`] samples before the
/// row reads no farther.
pub(crate) const PAD: usize = 20;

/// How many samples before a row a register may begin; nothing differs there.
pub(crate) const BEYOND: isize = 19;

/// In cells: what rounding takes off the border is on it.
pub(crate) const NEAR: f64 = 1e-6;

/// Heights on a [`Grid`].
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub(crate) size: [usize; 2],
    pub(crate) lattice: Lattice,
    /// Row by row, padded, and 16 more, so that every entry begins 16.
    pub(crate) heights: Vec<f32>,
}

impl Level {
    /// Heights 0 on a grid.
    pub(crate) fn new(grid: &Grid) -> Self {
        let Grid { size, lattice } = *grid;
        Level { size, lattice, heights: vec![0.0; (size[0] + 2 * PAD) * size[1] + 16] }
    }

    pub(crate) fn stride(&self) -> usize {
        self.size[0] + 2 * PAD
    }

    /// A row with its padding.
    pub(crate) fn padded(&self, row: usize) -> &[f32] {
        &self.heights[row * self.stride()..][..self.stride()]
    }

    /// A row.
    pub(crate) fn row(&self, row: usize) -> &[f32] {
        &self.padded(row)[PAD..][..self.size[0]]
    }

    /// Rows with their padding, to be filled by [`fill`] each.
    pub(crate) fn rows_mut(&mut self, rows: &Range<usize>) -> &mut [f32] {
        let stride = self.stride();
        &mut self.heights[rows.start * stride..rows.end * stride]
    }

    /// The rows from the first to the last that differ from a field's of as many.
    pub(crate) fn changed(&self, field: &HeightField) -> Option<Range<usize>> {
        let columns = self.size[0];
        let differs = |row: &usize| self.row(*row) != &field.heights()[row * columns..][..columns];
        let mut rows = (0..self.size[1]).filter(differs);
        let first = rows.next()?;
        Some(first..rows.next_back().unwrap_or(first) + 1)
    }

    /// Takes rows of a field's heights.
    pub(crate) fn copy(&mut self, field: &HeightField, rows: &Range<usize>) {
        let (stride, columns) = (self.stride(), self.size[0]);
        let from = field.heights()[rows.start * columns..].chunks_exact(columns);
        for (to, from) in self.rows_mut(rows).chunks_exact_mut(stride).zip(from) {
            fill(to, |column| from[column]);
        }
    }

    /// Makes rows out of the next finer level by bilinear interpolation at the samples' centres (§6): at most twice as coarse,
    /// so that every height counts.
    pub(crate) fn decimate(&mut self, finer: &Level, rows: &Range<usize>) {
        let (stride, size) = (self.stride(), self.size);
        let columns: Vec<(usize, f32)> = (0..size[0]).map(|column| split(column, size[0], finer.size[0])).collect();
        let all = self.rows_mut(rows).par_chunks_mut(stride).enumerate();
        all.for_each_init(Vec::new, |blend, (row, to)| {
            let (below, share) = split(rows.start + row, size[1], finer.size[1]);
            let (low, high) = (finer.padded(below), finer.padded((below + 1).min(finer.size[1] - 1)));
            blend.clear();
            blend.extend(low.iter().zip(high).map(|(low, high)| mix(*low, *high, share)));
            fill(to, |column| {
                let (before, share) = columns[column];
                mix(blend[PAD + before], blend[PAD + before + 1], share)
            });
        });
    }

    /// The rows that [`Level::decimate`] makes of some rows of the next finer level.
    pub(crate) fn touched(&self, finer: &Level, rows: &Range<usize>) -> Range<usize> {
        let reads = |row: &usize| {
            let (below, _) = split(*row, self.size[1], finer.size[1]);
            below < rows.end && below + 1 >= rows.start
        };
        let mut touched = (0..self.size[1]).filter(reads);
        let first = touched.next();
        first.map_or(0..0, |first| first..touched.next_back().unwrap_or(first) + 1)
    }

    /// Of `count` points a vertex apart, from one in grid coordinates of the field on along x, those on the field.
    #[inline(always)]
    pub(crate) fn inside(&self, x: f64, y: f64, count: usize) -> Range<usize> {
        let last = self.lattice.last;
        if y < -NEAR || y > last[1] + NEAR {
            return 0..0;
        }
        let first = (-NEAR - x).ceil().clamp(0.0, count as f64);
        let end = ((last[0] + NEAR - x).floor() + 1.0).clamp(first, count as f64);
        first as usize..end as usize
    }

    /// The rows whose centres lie within reach of some rows of another level, which a B-spline reads.
    pub(crate) fn around(&self, other: &Level, rows: &Range<usize>) -> Range<usize> {
        const REACH: f64 = 3.0;
        let here = |row: f64| (row + 0.5) * self.lattice.scale[1] / other.lattice.scale[1] - 0.5;
        let (first, end) = (here(rows.start as f64 - REACH), here(rows.end as f64 + REACH));
        first.floor().max(0.0) as usize..(end.ceil().max(0.0) as usize).min(self.size[1])
    }
}

/// Writes a row by a function of its columns, and its padding.
fn fill(padded: &mut [f32], height: impl Fn(usize) -> f32) {
    let count = padded.len() - 2 * PAD;
    for (column, entry) in padded[PAD..][..count].iter_mut().enumerate() {
        *entry = height(column);
    }
    pad(padded);
}

/// Draws a row's ends out over its padding.
pub(crate) fn pad(padded: &mut [f32]) {
    let end = padded.len() - PAD;
    let ends = [padded[PAD], padded[end - 1]];
    padded[..PAD].fill(ends[0]);
    padded[end..].fill(ends[1]);
}

/// Where the centre of sample `at` of `count` lies among `finer`: the sample before it and the share of the one after that.
fn split(at: usize, count: usize, finer: usize) -> (usize, f32) {
    let centre = ((at as f64 + 0.5) * finer as f64 / count as f64 - 0.5).clamp(0.0, (finer - 1) as f64);
    (centre as usize, centre.fract() as f32)
}

fn mix(from: f32, to: f32, share: f32) -> f32 {
    from * (1.0 - share) + to * share
}
