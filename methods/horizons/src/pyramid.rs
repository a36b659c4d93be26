//! The multi-resolution pyramid (§4, §6).

use std::ops::Range;

use halflight_scenes::HeightField;
use halflight_sh_kernels::Simd;
use rayon::prelude::*;

use crate::level::Level;
use crate::ray::{Border, Rays, Step, sample};
use crate::runs::groups;
use crate::shape::Shape;
use crate::{Azimuth, Horizons, Made, Points, Purpose, Work};

/// Between scales: how angles at the pyramid's distances become a function of distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Greatest at one of the distances, so that the arctangent is taken once.
    Linear,
    /// The cubic B-spline (eq. 4), its maximum sought at knots and half knots.
    BSpline,
}

impl Scale {
    /// What serves a purpose where this is chosen for key lights.
    pub(crate) fn serving(self, purpose: Purpose) -> Scale {
        match purpose {
            Purpose::Key => self,
            Purpose::Environment => Scale::Linear,
        }
    }
}

/// In the plane: how samples of a level become a function of position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// Bilinear; passes through the samples.
    Bilinear,
    /// Bicubic B-spline; smooths.
    BSpline,
}

/// The variants of Fig. 9.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reconstruction {
    /// Between scales.
    pub scale: Scale,
    /// In the plane.
    pub plane: Plane,
}

/// Where the reconstruction in the plane happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Every level is brought back once to at least twice its own resolution, by a power of two of the field's, and looked at
    /// bilinearly ("multiple image arrays", §6): about 14 times the field's size at 4 levels an
    /// octave.
    Octaves,
    /// Levels stay decimated and are reconstructed where they are looked at: about 3.4 times.
    Decimated,
    /// Every level is brought back to the field's resolution, as the paper's GPU does: once a level.
    Full,
}

/// What a [`Pyramid`] is made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Levels an octave `k`, at least 1.
    pub levels_per_octave: usize,
    /// Level offset `o` in octaves, at least 0: by how much finer than the distance the levels are that are looked at.
    pub offset: f32,
    /// How samples become functions.
    pub reconstruction: Reconstruction,
    /// Where.
    pub storage: Storage,
}

impl Default for Settings {
    fn default() -> Self {
        let reconstruction = Reconstruction { scale: Scale::BSpline, plane: Plane::BSpline };
        Settings { levels_per_octave: 4, offset: 2.0, reconstruction, storage: Storage::Octaves }
    }
}

/// Horizons by multi-scale derivatives.
pub struct Pyramid {
    settings: Settings,
    border: Border,
    simd: Simd,
    shape: Option<Shape>,
    /// The decimated levels, the coarsest first. With [`Storage::Full`] their samples are brought back into `full`.
    levels: Vec<Level>,
    full: Vec<Level>,
    azimuths: Vec<(Azimuth, Vec<Step>)>,
}

impl Pyramid {
    /// A pyramid without a field.
    ///
    /// # Panics
    /// If there is no level an octave, or the offset is negative or not finite.
    pub fn new(settings: Settings) -> Self {
        Self::on(settings, Simd::best())
    }

    /// The same by the instructions of one set, for comparisons.
    ///
    /// # Panics
    /// As [`Pyramid::new`].
    pub fn on(settings: Settings, simd: Simd) -> Self {
        assert!(settings.levels_per_octave > 0, "at least one level an octave");
        assert!(settings.offset >= 0.0 && settings.offset.is_finite(), "a level offset of at least 0");
        Pyramid {
            settings,
            border: Border::Extend,
            simd,
            shape: None,
            levels: Vec::new(),
            full: Vec::new(),
            azimuths: Vec::new(),
        }
    }

    /// The same with something else beyond the border, where it goes on by default.
    pub fn with_border(self, border: Border) -> Self {
        Pyramid { border, ..self }
    }

    /// Levels, `k · log2 n + 1` for a square field of `n` vertices a side.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Columns and rows of a level, the coarsest first.
    pub fn level_size(&self, level: usize) -> [usize; 2] {
        self.levels[level].size
    }

    /// A row of a decimated level's samples in metres.
    pub fn level_row(&self, level: usize, row: usize) -> &[f32] {
        self.levels[level].row(row)
    }

    /// Elevations as [`Horizons::elevations`] gives them, with a reconstruction in scale of the caller's choice.
    ///
    /// # Panics
    /// As [`Horizons::elevations`].
    pub fn elevations_by(&self, scale: Scale, at: Points<'_>, azimuths: Range<usize>, out: &mut [f32]) {
        self.look(at, azimuths, out, |_| scale);
    }

    fn look(&self, at: Points<'_>, azimuths: Range<usize>, out: &mut [f32], scale: impl Fn(Azimuth) -> Scale) {
        assert_eq!(out.len(), at.len() * azimuths.len(), "an entry for every point and azimuth");
        match (self.settings.storage, self.settings.reconstruction.plane) {
            (Storage::Octaves | Storage::Full, _) => self.over::<2>(&self.full, at, azimuths, out, scale),
            (Storage::Decimated, Plane::Bilinear) => self.over::<2>(&self.levels, at, azimuths, out, scale),
            (Storage::Decimated, Plane::BSpline) => self.over::<4>(&self.levels, at, azimuths, out, scale),
        }
    }

    fn over<const T: usize>(
        &self,
        levels: &[Level],
        at: Points<'_>,
        azimuths: Range<usize>,
        out: &mut [f32],
        scale: impl Fn(Azimuth) -> Scale,
    ) {
        let (Some(shape), Some(finest)) = (&self.shape, self.levels.last()) else {
            panic!("a field before receivers");
        };
        let mut rays = Rays::<T>::new(levels, self.border, self.simd);
        for group in groups(at, finest.size) {
            let (first, count) = (group.first, group.count);
            rays.stand(group, shape.coarsest());
            for (index, (azimuth, steps)) in self.azimuths[azimuths.clone()].iter().enumerate() {
                let elevations = rays.look(steps, scale(*azimuth));
                out[index * at.len() + first..][..count].copy_from_slice(elevations);
            }
        }
    }

    /// Levels for a field's grid.
    fn lay_out(&mut self, size: [usize; 2], cell: [f32; 2]) -> Shape {
        let shape = Shape::new(&self.settings, size, cell);
        self.levels = shape.levels.iter().map(Level::new).collect();
        self.full = shape.back.iter().map(Level::new).collect();
        self.azimuths.clear();
        shape
    }

    /// Takes the rows of heights that differ, and makes again what depends on them: rows of so many levels.
    fn take(&mut self, field: &HeightField, mut rows: Range<usize>) -> usize {
        let mut made = 0;
        for index in (0..self.levels.len()).rev() {
            let (coarser, finer) = self.levels.split_at_mut(index + 1);
            let level = &mut coarser[index];
            match finer.first() {
                None => level.copy(field, &rows),
                Some(finer) => {
                    rows = level.touched(finer, &rows);
                    level.decimate(finer, &rows);
                }
            }
            if let Some(back) = self.full.get_mut(index) {
                bring_back(level, &rows, self.settings.reconstruction.plane, self.simd, back);
            }
            made += usize::from(!rows.is_empty());
        }
        made
    }
}

/// Brings what depends on some rows of a level back to the resolution that it is looked at with.
fn bring_back(level: &Level, rows: &Range<usize>, plane: Plane, simd: Simd, back: &mut Level) {
    let (stride, lattice) = (back.stride(), back.lattice);
    let rows = back.around(level, rows);
    let all = back.rows_mut(&rows).par_chunks_mut(stride).enumerate();
    match plane {
        Plane::Bilinear => all.for_each(|(row, to)| sample::<2>(level, &lattice, rows.start + row, simd, to)),
        Plane::BSpline => all.for_each(|(row, to)| sample::<4>(level, &lattice, rows.start + row, simd, to)),
    }
}

impl Horizons for Pyramid {
    fn update(&mut self, field: &HeightField, azimuths: &[Azimuth]) -> Made {
        let (size, cell) = ([field.columns(), field.rows()], field.cell().to_array());
        let (shape, changed) = match self.shape.take().filter(|shape| shape.fits(size, cell)) {
            Some(shape) => (shape, self.levels[self.levels.len() - 1].changed(field)),
            None => (self.lay_out(size, cell), Some(0..field.rows())),
        };
        let mut made = Made { levels: changed.map_or(0, |rows| self.take(field, rows)), azimuths: 0 };
        if !self.azimuths.iter().map(|(azimuth, _)| azimuth).eq(azimuths) {
            self.azimuths = azimuths.iter().map(|azimuth| (*azimuth, shape.steps(azimuth.angle))).collect();
            made.azimuths = azimuths.len();
        }
        self.shape = Some(shape);
        made
    }

    fn elevations(&self, at: Points<'_>, azimuths: Range<usize>, out: &mut [f32]) {
        let chosen = self.settings.reconstruction.scale;
        self.look(at, azimuths, out, |azimuth| chosen.serving(azimuth.purpose));
    }

    fn work(&self, azimuth: usize) -> Work {
        let (_, steps) = &self.azimuths[azimuth];
        let levels = if self.full.is_empty() { &self.levels } else { &self.full };
        let vertices: usize = self.levels.last().map_or(0, |finest| finest.size[0] * finest.size[1]);
        let share = |step: &Step| (levels[step.level].size[0] * levels[step.level].size[1]) as f64 / vertices as f64;
        Work { samples: steps.len() as f64, bytes: 4.0 * steps.iter().map(share).sum::<f64>() }
    }

    fn footprint(&self) -> usize {
        let levels = self.levels.iter().chain(&self.full).map(|level| size_of_val(&level.heights[..])).sum::<usize>();
        levels + self.azimuths.iter().map(|(_, steps)| size_of_val(&steps[..])).sum::<usize>()
    }
}
