//! A level of a pyramid: heights on a grid of its own.

use std::ops::Range;

/// Entries beyond either end of a row, which repeat the row's end: a register that begins up to [`BEYOND`] samples before the
/// row reads no farther.
pub(crate) const PAD: usize = 20;

/// How many samples before a row a register may begin; nothing differs there.
pub(crate) const BEYOND: isize = 19;

/// Heights at the centres of rectangles, a whole number of which covers the field: its own are rectangles about its vertices.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub(crate) size: [usize; 2],
    /// Its samples in the length of one of the field's, along x and y; at most 1.
    pub(crate) scale: [f64; 2],
    /// Row by row, padded, and 16 more, so that every entry begins 16.
    pub(crate) heights: Vec<f32>,
}

impl Level {
    /// Heights 0 of `size`, as wide as a field of `full` vertices.
    pub(crate) fn new(size: [usize; 2], full: [usize; 2]) -> Self {
        Self::scaled(size, [0, 1].map(|axis| size[axis] as f64 / full[axis] as f64))
    }

    fn scaled(size: [usize; 2], scale: [f64; 2]) -> Self {
        Level { size, scale, heights: vec![0.0; (size[0] + 2 * PAD) * size[1] + 16] }
    }

    /// Heights 0 for bringing a level back to at least twice its own resolution: by a power of two of the field's, at least an
    /// eighth, so that registers of receivers lie alike among samples.
    pub(crate) fn octave(of: &Level, full: [usize; 2]) -> Self {
        let halved =
            |axis: usize| (0..3).take_while(|halvings| of.scale[axis] * 2.0 * f64::from(2 << halvings) <= 1.0).count();
        let halvings = [0, 1].map(halved);
        let size = [0, 1].map(|axis| full[axis].div_ceil(1 << halvings[axis]));
        Self::scaled(size, halvings.map(|halvings| 1.0 / f64::from(1 << halvings)))
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

    /// The rows that depend on some rows of the next finer level.
    pub(crate) fn touched(&self, finer: &Level, rows: &Range<usize>) -> Range<usize> {
        let reads = |row: usize| {
            let (below, _) = split(row, self.size[1], finer.size[1]);
            below < rows.end && (below + 1).min(finer.size[1] - 1) >= rows.start
        };
        let mut touched = (0..self.size[1]).filter(|row| reads(*row));
        let first = touched.next();
        first.map_or(0..0, |first| first..touched.next_back().unwrap_or(first) + 1)
    }
}

/// Writes a row by a function of its columns, and its padding.
pub(crate) fn fill(padded: &mut [f32], height: impl Fn(usize) -> f32) {
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
pub(crate) fn split(at: usize, count: usize, finer: usize) -> (usize, f32) {
    let centre = ((at as f64 + 0.5) * finer as f64 / count as f64 - 0.5).clamp(0.0, (finer - 1) as f64);
    (centre as usize, centre.fract() as f32)
}

/// The next coarser level by bilinear interpolation at its samples' centres (§6): at most twice as coarse, so that every height
/// counts.
pub(crate) struct Decimation {
    columns: Vec<(usize, f32)>,
    count: [usize; 2],
}

impl Decimation {
    pub(crate) fn new(finer: &Level, coarser: &Level) -> Self {
        let columns = (0..coarser.size[0]).map(|column| split(column, coarser.size[0], finer.size[0])).collect();
        Decimation { columns, count: [finer.size[1], coarser.size[1]] }
    }

    /// A padded row of the coarser level.
    pub(crate) fn row(&self, finer: &Level, row: usize, to: &mut [f32], scratch: &mut Vec<f32>) {
        let (below, share) = split(row, self.count[1], self.count[0]);
        let (low, high) = (finer.padded(below), finer.padded((below + 1).min(self.count[0] - 1)));
        scratch.clear();
        scratch.extend(low.iter().zip(high).map(|(low, high)| mix(*low, *high, share)));
        fill(to, |column| {
            let (before, share) = self.columns[column];
            mix(scratch[PAD + before], scratch[PAD + before + 1], share)
        });
    }
}

fn mix(from: f32, to: f32, share: f32) -> f32 {
    from * (1.0 - share) + to * share
}
