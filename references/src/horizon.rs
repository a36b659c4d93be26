//! The exact horizon of a height field's triangulated surface.
//!
//! Over the half-line that leaves a point along an azimuth, the surface is linear between crossings with the grid's lines and
//! the diagonals of its cells. The tangent of the elevation under which the point sees the surface is monotonic on each such
//! piece, so that its maximum is attained at a crossing: `max over t of (h(t) − z)/t`, in `f64` (Snyder and Nowrouzezahrai
//! 2008, §3, for the surface instead of samples). Directions below elevation 0 count as blocked, and beyond the border there is
//! nothing. One azimuth costs `O(columns + rows)`.
//!
//! Azimuths are in radians from +x towards +y, elevations in radians in `[0, π/2]`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};
use halflight_scenes::HeightField;
use rayon::prelude::*;

/// In cells. Crossings nearer than this are left out, since the tangent to them is rounding, and a way that rounding takes off the
/// border by less than this is still on the field.
const NEAR: f64 = 1e-9;

/// Horizons of one field.
pub struct Horizons<'f> {
    field: &'f HeightField,
    /// Its greatest height: nothing is seen above it.
    top: f64,
}

impl<'f> Horizons<'f> {
    /// Horizons of a field.
    pub fn new(field: &'f HeightField) -> Self {
        let top = field.heights().iter().copied().fold(f32::NEG_INFINITY, f32::max);
        Horizons { field, top: f64::from(top) }
    }

    /// Elevation of the horizon at a vertex.
    ///
    /// # Panics
    /// If the vertex is not one of the field's.
    pub fn at_vertex(&self, [column, row]: [usize; 2], azimuth: f64) -> f64 {
        self.elevation(DVec2::new(column as f64, row as f64), f64::from(self.field.height(column, row)), azimuth)
    }

    /// Elevation of the horizon at a point of the surface, given by its horizontal position in metres; a point off the field
    /// is moved to its border. Within a billionth of a cell from a line it counts as lying on it.
    pub fn at_point(&self, position: DVec2, azimuth: f64) -> f64 {
        let field = self.field;
        let last = DVec2::new((field.columns() - 1) as f64, (field.rows() - 1) as f64);
        let grid = (position - field.origin().as_dvec2()) / field.cell().as_dvec2();
        let grid = grid.clamp(DVec2::ZERO, last);
        self.elevation(grid, field.surface(grid.x, grid.y), azimuth)
    }

    /// Elevations at all vertices, on all cores: those of vertex `(i, j)` under every azimuth begin at entry
    /// `(j · columns + i) · azimuths.len()`.
    pub fn at_vertices(&self, azimuths: &[f64]) -> Vec<f64> {
        let columns = self.field.columns();
        let horizons = |vertex: usize| {
            let at = [vertex % columns, vertex / columns];
            azimuths.iter().map(move |azimuth| self.at_vertex(at, *azimuth))
        };
        (0..self.field.heights().len()).into_par_iter().flat_map_iter(horizons).collect()
    }

    /// Elevation of the horizon at grid coordinates and a height in metres.
    fn elevation(&self, from: DVec2, height: f64, azimuth: f64) -> f64 {
        let (sin, cos) = azimuth.sin_cos();
        let step = DVec2::new(cos, sin) / self.field.cell().as_dvec2();
        let way = Way { field: self.field, from, step, height, top: self.top };
        let steepest = way.over_columns(0.0);
        let steepest = way.over_rows(steepest);
        way.over_diagonals(steepest).atan()
    }
}

/// Fraction in `[0, 1]` of the irradiance `π` of an unblocked horizontal receiver under a sky that is uniform above elevation 0
/// and dark below, at a receiver with a unit normal that sees the sky above a horizon. `horizons` lie at evenly spread azimuths,
/// of which the first is 0. Exact in elevation, a sum in azimuth: under a horizon that is smooth but for kinks the error
/// falls with the square of their number.
pub fn sky_irradiance(normal: DVec3, horizons: &[f64]) -> f64 {
    let step = TAU / horizons.len() as f64;
    let column = |(index, horizon): (usize, &f64)| {
        let (sin, cos) = (index as f64 * step).sin_cos();
        above(DVec2::new(normal.x * cos + normal.y * sin, normal.z), *horizon)
    };
    horizons.iter().enumerate().map(column).sum::<f64>() * step / PI
}

/// `∫ max(0, n·(cos e, sin e)) cos e de` from a horizon to the zenith.
fn above(n: DVec2, horizon: f64) -> f64 {
    // The lit elevations are those within a right angle of the normal's.
    let normal = n.y.atan2(n.x);
    let (low, high) = (horizon.max(normal - FRAC_PI_2), FRAC_PI_2.min(normal + FRAC_PI_2));
    let antiderivative = |e: f64| n.x * (0.5 * e + 0.25 * (2.0 * e).sin()) + n.y * 0.5 * e.sin() * e.sin();
    if high > low { antiderivative(high) - antiderivative(low) } else { 0.0 }
}

/// A half-line over a field.
struct Way<'f> {
    field: &'f HeightField,
    /// Grid coordinates of its start.
    from: DVec2,
    /// Grid coordinates that it advances in a metre.
    step: DVec2,
    /// Height in metres of its start.
    height: f64,
    /// The field's greatest height in metres.
    top: f64,
}

impl Way<'_> {
    /// The greater of `steepest` and the steepest tangent to a crossing with lines of equal x.
    fn over_columns(&self, steepest: f64) -> f64 {
        let field = self.field;
        self.over(self.from.x, self.step.x, steepest, |column, at| {
            let column = within(column as i64, field.columns())?;
            let (row, weight) = split(at.y, field.rows())?;
            Some(lerp(field.height(column, row), field.height(column, row + 1), weight))
        })
    }

    /// The same with lines of equal y.
    fn over_rows(&self, steepest: f64) -> f64 {
        let field = self.field;
        self.over(self.from.y, self.step.y, steepest, |row, at| {
            let row = within(row as i64, field.rows())?;
            let (column, weight) = split(at.x, field.columns())?;
            Some(lerp(field.height(column, row), field.height(column + 1, row), weight))
        })
    }

    /// The same with the diagonals, on which x − y is whole.
    fn over_diagonals(&self, steepest: f64) -> f64 {
        let field = self.field;
        self.over(self.from.x - self.from.y, self.step.x - self.step.y, steepest, |difference, at| {
            let (column, weight) = split(at.x, field.columns())?;
            let row = within(column as i64 - difference as i64, field.rows() - 1)?;
            Some(lerp(field.height(column, row), field.height(column + 1, row + 1), weight))
        })
    }

    /// Follows the way over lines on which a coordinate is whole, one that starts at `start` and grows by `speed` in a metre,
    /// until it leaves the field or nothing farther could be steeper. `height` gives the surface's at a line and the grid
    /// coordinates of the crossing, `None` off the field.
    fn over(&self, start: f64, speed: f64, mut steepest: f64, height: impl Fn(f64, DVec2) -> Option<f64>) -> f64 {
        if speed == 0.0 {
            return steepest;
        }
        let ahead = speed.signum();
        let mut line = if speed > 0.0 { start.floor() } else { start.ceil() };
        loop {
            line += ahead;
            if (line - start).abs() < NEAR {
                continue;
            }
            let distance = (line - start) / speed;
            if self.top - self.height <= steepest * distance {
                return steepest;
            }
            let Some(height) = height(line, self.from + distance * self.step) else {
                return steepest;
            };
            steepest = steepest.max((height - self.height) / distance);
        }
    }
}

/// An index of `0..count`.
fn within(index: i64, count: usize) -> Option<usize> {
    usize::try_from(index).ok().filter(|index| *index < count)
}

/// The cell of a coordinate among `count` vertices and how far it lies from the cell's lower end; `None` off the field.
fn split(at: f64, count: usize) -> Option<(usize, f64)> {
    let last = (count - 1) as f64;
    if !(-NEAR..=last + NEAR).contains(&at) {
        return None;
    }
    let at = at.clamp(0.0, last);
    let cell = (at as usize).min(count - 2);
    Some((cell, at - cell as f64))
}

fn lerp(from: f32, to: f32, weight: f64) -> f64 {
    f64::from(from) + weight * (f64::from(to) - f64::from(from))
}
