//! Convex hulls that grow along parallel lines (Timonen and Westerholm 2010).

use std::ops::Range;

use halflight_scenes::HeightField;
use rayon::prelude::*;

use crate::arctangent::arctangent;
use crate::{Azimuth, Horizons, Points, Work};

/// Horizons by sweeping: for each azimuth, parallel lines through the field, one a vertex across; along each line a stack holds
/// the upper convex hull of what lies ahead, whose tangent from a sample is the horizon there, at an amortised constant cost.
///
/// Along a line the horizon is exact for the heights where it crosses the grid's lines (those of columns, or of rows where
/// the azimuth is nearer to y), with heights between vertices linear. A vertex lies between two lines and gets a mean of their
/// elevations by its distances to them; only where lines pass through vertices, at multiples of 45° of the grid, is it
/// exact for the surface of triangles too.
#[derive(Default)]
pub struct Sweep {
    size: [usize; 2],
    cell: [f32; 2],
    heights: Vec<f32>,
    maps: Vec<(Azimuth, Vec<f32>)>,
}

impl Sweep {
    /// A sweep without a field.
    pub fn new() -> Self {
        Self::default()
    }

    /// Elevations at all vertices under an azimuth of the last update, row by row.
    pub fn map(&self, azimuth: usize) -> &[f32] {
        &self.maps[azimuth].1
    }
}

impl Horizons for Sweep {
    fn update(&mut self, field: &HeightField, azimuths: &[Azimuth]) {
        let size = [field.columns(), field.rows()];
        let cell = field.cell().to_array();
        let same = self.size == size && self.cell == cell && self.heights == field.heights();
        let angles = |azimuth: &Azimuth| azimuth.angle;
        if same && self.maps.iter().map(|(azimuth, _)| angles(azimuth)).eq(azimuths.iter().map(angles)) {
            return;
        }
        (self.size, self.cell) = (size, cell);
        self.heights.clear();
        self.heights.extend_from_slice(field.heights());
        let heights = &self.heights;
        let sweep = |azimuth: &Azimuth| (*azimuth, Lines::new(size, cell, azimuth.angle).horizons(heights));
        self.maps = azimuths.par_iter().map(sweep).collect();
    }

    fn elevations(&self, at: Points<'_>, azimuths: Range<usize>, out: &mut [f32]) {
        assert_eq!(out.len(), at.len() * azimuths.len(), "an entry for every point and azimuth");
        let [columns, rows] = self.size;
        let split = |at: f32, count: usize| {
            let at = at.max(0.0).min((count - 1) as f32);
            let cell = (at as usize).min(count - 2);
            (cell, at - cell as f32)
        };
        for (index, (_, map)) in self.maps[azimuths].iter().enumerate() {
            let out = &mut out[index * at.len()..][..at.len()];
            for (point, out) in out.iter_mut().enumerate() {
                let ((i, u), (j, v)) = (split(at.x[point], columns), split(at.y[point], rows));
                let row = |j: usize| map[j * columns + i] * (1.0 - u) + map[j * columns + i + 1] * u;
                *out = row(j) * (1.0 - v) + row(j + 1) * v;
            }
        }
    }

    fn work(&self, _azimuth: usize) -> Work {
        Work { samples: 1.0, bytes: 4.0 }
    }

    fn footprint(&self) -> usize {
        size_of_val(&self.heights[..]) + self.maps.iter().map(|(_, map)| size_of_val(&map[..])).sum::<usize>()
    }
}

/// Parallel lines over a grid. "Along" is the axis that the azimuth is nearer to in grid coordinates, "across" the other: line
/// `l` passes `i` along at `l + i · slope` across.
struct Lines {
    /// Vertices along and across.
    size: [usize; 2],
    /// Entries from a vertex to the next, along and across.
    strides: [usize; 2],
    slope: f64,
    /// Metres along a line from one crossing to the next, negative where the azimuth looks back along the axis.
    step: f64,
    /// The first line.
    first: i64,
    /// How many lines there are.
    count: usize,
}

impl Lines {
    fn new([columns, rows]: [usize; 2], cell: [f32; 2], angle: f32) -> Self {
        let (sin, cos) = f64::from(angle).sin_cos();
        let [x, y] = [cos / f64::from(cell[0]), sin / f64::from(cell[1])];
        let (size, strides, [along, across]) = match x.abs() >= y.abs() {
            true => ([columns, rows], [1, columns], [x, y]),
            false => ([rows, columns], [columns, 1], [y, x]),
        };
        let slope = across / along;
        let end = -slope * (size[0] - 1) as f64;
        let first = end.min(0.0).floor() as i64;
        let last = (end.max(0.0) + (size[1] - 1) as f64).floor() as i64 + 1;
        Lines { size, strides, slope, step: 1.0 / along, first, count: (last - first + 1) as usize }
    }

    /// Elevations at all vertices.
    fn horizons(&self, heights: &[f32]) -> Vec<f32> {
        let [along, across] = self.size;
        let mut swept = vec![0.0; self.count * along];
        let mut hull = Vec::with_capacity(along);
        for (line, out) in swept.chunks_exact_mut(along).enumerate() {
            self.sweep(heights, self.first + line as i64, &mut hull, out);
        }
        let mut map = vec![0.0; along * across];
        for j in 0..across {
            for i in 0..along {
                let at = j as f64 - i as f64 * self.slope;
                let below = at.floor();
                let (line, share) = ((below as i64 - self.first) as usize, (at - below) as f32);
                let [low, high] = [line, line + 1].map(|line| swept[line * along + i]);
                map[i * self.strides[0] + j * self.strides[1]] = low * (1.0 - share) + high * share;
            }
        }
        map
    }

    /// Elevations where a line crosses, with the field's border drawn out by a cell for the vertices there.
    fn sweep(&self, heights: &[f32], line: i64, hull: &mut Vec<(f64, f64)>, out: &mut [f32]) {
        let [along, across] = self.size;
        hull.clear();
        for index in 0..along {
            // What lies ahead comes first.
            let i = if self.step > 0.0 { along - 1 - index } else { index };
            let at = line as f64 + i as f64 * self.slope;
            if at <= -1.0 || at >= across as f64 {
                continue;
            }
            let at = at.clamp(0.0, (across - 1) as f64);
            let below = (at as usize).min(across - 2);
            let entry = i * self.strides[0] + below * self.strides[1];
            let [low, high] = [heights[entry], heights[entry + self.strides[1]]].map(f64::from);
            let height = low + (at - below as f64) * (high - low);
            let tangent = push(hull, i as f64 * self.step, height);
            out[i] = arctangent(tangent as f32).max(0.0);
        }
    }
}

/// Adds a sample before all others to their upper convex hull, and gives the tangent from it to the hull, 0 if there was none.
fn push(hull: &mut Vec<(f64, f64)>, at: f64, height: f64) -> f64 {
    while let [.., (far, second), (near, first)] = hull[..] {
        if (first - height) * (far - at) > (second - height) * (near - at) {
            break;
        }
        hull.pop();
    }
    let tangent = hull.last().map_or(0.0, |(near, first)| (first - height) / (near - at));
    hull.push((at, height));
    tangent
}
