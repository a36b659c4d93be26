//! The levels of a pyramid over a field: their grids, and the distances for which they are looked at.

use crate::grid::Grid;
use crate::pyramid::{Settings, Storage};
use crate::ray::{Step, steps};

/// Octaves between the longest and the shortest distance at most, for cells of extreme shape.
const OCTAVES: f64 = 24.0;

/// What a pyramid is for all fields of a grid.
pub(crate) struct Shape {
    /// The field's columns and rows.
    size: [usize; 2],
    cell: [f32; 2],
    /// In metres, each with the number of the level that is looked at for it: `b^-i` of the field's longer side down to its shorter cell.
    distances: Vec<(usize, f64)>,
    /// Of the decimated levels, the coarsest first.
    pub(crate) levels: Vec<Grid>,
    /// What each is brought back to; none if they stay as they are.
    pub(crate) back: Vec<Grid>,
}

impl Shape {
    pub(crate) fn new(settings: &Settings, size: [usize; 2], cell: [f32; 2]) -> Self {
        let spans = [0, 1].map(|axis| size[axis] as f64 * f64::from(cell[axis]));
        let longest = spans[0].max(spans[1]);
        let octaves = (longest / f64::from(cell[0].min(cell[1]))).log2().min(OCTAVES);
        let per_octave = settings.levels_per_octave as f64;
        // A field of 2^i vertices has whole octaves, whatever the logarithm's last digit says.
        let count = (per_octave * octaves - 1e-6).ceil() as usize + 1;
        let distance = |level: usize| longest * (1.0 / per_octave).exp2().powi(-(level as i32));
        let samples = |level: usize, axis: usize| match level + 1 == count {
            true => size[axis],
            false => ((spans[axis] / distance(level)).round() as usize).clamp(1, size[axis]),
        };
        let levels: Vec<Grid> =
            (0..count).map(|level| Grid::new([samples(level, 0), samples(level, 1)], size)).collect();
        let back = match settings.storage {
            Storage::Decimated => Vec::new(),
            Storage::Octaves => levels.iter().map(|level| Grid::octave(level, size)).collect(),
            Storage::Full => levels.iter().map(|_| Grid::new(size, size)).collect(),
        };
        let distances = (0..count).map(|level| (looked_at(settings, level, count), distance(level))).collect();
        Shape { size, cell, distances, levels, back }
    }

    /// Whether it is that of a grid.
    pub(crate) fn fits(&self, size: [usize; 2], cell: [f32; 2]) -> bool {
        self.size == size && self.cell == cell
    }

    /// The coarsest level that is looked at.
    pub(crate) fn coarsest(&self) -> usize {
        self.distances[0].0
    }

    /// The steps of an azimuth.
    pub(crate) fn steps(&self, angle: f32) -> Vec<Step> {
        steps(angle, self.cell, self.distances.iter().copied())
    }
}

/// The level that is looked at for a distance: `min(⌈i + k·o⌉, N − 1)`.
fn looked_at(settings: &Settings, distance: usize, levels: usize) -> usize {
    let offset = (settings.levels_per_octave as f32 * settings.offset - 1e-4).ceil().max(0.0);
    (distance + offset.min(levels as f32) as usize).min(levels - 1)
}
