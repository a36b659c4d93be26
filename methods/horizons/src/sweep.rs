//! Convex hulls that grow along parallel lines (Timonen and Westerholm 2010).

use std::ops::Range;
use std::sync::LazyLock;

use halflight_scenes::HeightField;
use halflight_sh_kernels::Simd;
use rayon::prelude::*;

use crate::hull::Lines;
use crate::runs::{Run, runs};
use crate::{Azimuth, Horizons, Made, Points, Work};

/// Horizons by sweeping: for each azimuth, parallel lines through the field, one a vertex across; along each line a stack holds
/// the upper convex hull of what lies ahead, whose tangent from a sample is the horizon there, at an amortised constant cost.
///
/// Along a line the horizon is exact for the heights where it crosses the grid's lines (those of columns, or of rows where
/// the azimuth is nearer to y), with heights between vertices linear. A vertex lies between two lines and gets a mean of their
/// elevations by its distances to them; only where lines pass through vertices, at multiples of 45° of the grid, is it
/// exact for the surface of triangles too.
pub struct Sweep {
    simd: Simd,
    size: [usize; 2],
    cell: [f32; 2],
    heights: Vec<f32>,
    maps: Vec<(Azimuth, Vec<f32>)>,
}

impl Default for Sweep {
    fn default() -> Self {
        Self::new()
    }
}

impl Sweep {
    /// A sweep without a field.
    pub fn new() -> Self {
        Self::on(Simd::best())
    }

    /// The same by the instructions of one set, for comparisons.
    pub fn on(simd: Simd) -> Self {
        Sweep { simd, size: [0; 2], cell: [0.0; 2], heights: Vec::new(), maps: Vec::new() }
    }

    /// Elevations at all vertices under an azimuth of the last update, row by row.
    pub fn map(&self, azimuth: usize) -> &[f32] {
        &self.maps[azimuth].1
    }
}

impl Horizons for Sweep {
    fn update(&mut self, field: &HeightField, azimuths: &[Azimuth]) -> Made {
        let (size, simd) = ([field.columns(), field.rows()], self.simd);
        let cell = field.cell().to_array();
        if self.size != size || self.cell != cell || self.heights != field.heights() {
            (self.size, self.cell) = (size, cell);
            self.heights.clear();
            self.heights.extend_from_slice(field.heights());
            self.maps.clear();
        }
        let mut known = std::mem::take(&mut self.maps);
        let kept = azimuths.iter().map(|azimuth| {
            let place = known.iter().position(|(known, _)| known.angle == azimuth.angle);
            (*azimuth, place.map(|place| known.swap_remove(place).1))
        });
        let maps: Vec<(Azimuth, Option<Vec<f32>>)> = kept.collect();
        let made = maps.iter().filter(|(_, map)| map.is_none()).count();
        let heights = &self.heights;
        let turned = LazyLock::new(|| transposed(heights, size));
        let sweep = |azimuth: Azimuth| {
            let [x, y] = direction(azimuth.angle, cell);
            match x.abs() >= y.abs() {
                true => transposed(&Lines::new(size, [x, y]).horizons(&turned, simd), [size[1], size[0]]),
                false => Lines::new([size[1], size[0]], [y, x]).horizons(heights, simd),
            }
        };
        let all = maps.into_par_iter().map(|(azimuth, map)| (azimuth, map.unwrap_or_else(|| sweep(azimuth))));
        self.maps = all.collect();
        Made { levels: 0, azimuths: made }
    }

    fn elevations(&self, at: Points<'_>, azimuths: Range<usize>, out: &mut [f32]) {
        assert_eq!(out.len(), at.len() * azimuths.len(), "an entry for every point and azimuth");
        for run in runs(at, self.size) {
            for (index, (_, map)) in self.maps[azimuths.clone()].iter().enumerate() {
                self.look_up(map, run, &mut out[index * at.len() + run.first..][..run.count]);
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

impl Sweep {
    /// A run's elevations out of a map, bilinear between vertices.
    fn look_up(&self, map: &[f32], run: Run, out: &mut [f32]) {
        let [columns, rows] = self.size;
        let split = |at: f64, count: usize| {
            let cell = (at as usize).min(count - 2);
            (cell, (at - cell as f64) as f32)
        };
        let (j, v) = split(run.start[1], rows);
        if run.start.iter().all(|at| at.fract() == 0.0) {
            out.copy_from_slice(&map[run.start[1] as usize * columns + run.start[0] as usize..][..run.count]);
            return;
        }
        for (receiver, out) in out.iter_mut().enumerate() {
            let (i, u) = split(run.start[0] + receiver as f64, columns);
            let row = |j: usize| map[j * columns + i] * (1.0 - u) + map[j * columns + i + 1] * u;
            *out = row(j) * (1.0 - v) + row(j + 1) * v;
        }
    }
}

/// What an azimuth advances in grid coordinates in a metre.
fn direction(angle: f32, cell: [f32; 2]) -> [f64; 2] {
    let (sin, cos) = f64::from(angle).sin_cos();
    [cos / f64::from(cell[0]), sin / f64::from(cell[1])]
}

/// Rows of `[columns, rows]` as columns, by squares that fit into the nearest cache.
fn transposed(rows: &[f32], [columns, count]: [usize; 2]) -> Vec<f32> {
    const SIDE: usize = 16;
    let mut turned = vec![0.0; rows.len()];
    for j in (0..count).step_by(SIDE) {
        for i in (0..columns).step_by(SIDE) {
            for i in i..(i + SIDE).min(columns) {
                for j in j..(j + SIDE).min(count) {
                    turned[i * count + j] = rows[j * columns + i];
                }
            }
        }
    }
    turned
}
