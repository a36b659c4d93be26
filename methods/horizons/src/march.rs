//! Evenly spaced samples of the finest heights (§7, Fig. 10: the paper's ground truth).

use std::ops::Range;

use halflight_scenes::HeightField;
use halflight_sh_kernels::Simd;

use crate::grid::Grid;
use crate::level::Level;
use crate::pyramid::Scale;
use crate::ray::{Border, Rays, Step, steps};
use crate::runs::groups;
use crate::{Azimuth, Horizons, Made, Points, Work};

/// The paper's number of samples.
const SAMPLES: usize = 145;

/// Samples between two looks at whether a shadow is settled.
const AT_ONCE: usize = 12;

/// Horizons by marching: eq. (1) at distances that are spread evenly over the field's longer side, between vertices bilinear.
pub struct March {
    samples: usize,
    border: Border,
    simd: Simd,
    cell: [f32; 2],
    heights: Option<Level>,
    /// The greatest height in metres.
    top: f32,
    azimuths: Vec<(Azimuth, Vec<Step>)>,
}

impl Default for March {
    fn default() -> Self {
        Self::new(SAMPLES)
    }
}

impl March {
    /// A march of some samples.
    ///
    /// # Panics
    /// If there are none.
    pub fn new(samples: usize) -> Self {
        Self::on(samples, Simd::best())
    }

    /// The same by the instructions of one set, for comparisons.
    ///
    /// # Panics
    /// As [`March::new`].
    pub fn on(samples: usize, simd: Simd) -> Self {
        assert!(samples > 0, "at least one sample");
        March { samples, border: Border::Extend, simd, cell: [1.0; 2], heights: None, top: 0.0, azimuths: Vec::new() }
    }

    /// The same with something else beyond the border, where it goes on by default.
    pub fn with_border(self, border: Border) -> Self {
        March { border, ..self }
    }

    fn level(&self) -> &Level {
        self.heights.as_ref().expect("a field before receivers")
    }
}

impl Horizons for March {
    fn update(&mut self, field: &HeightField, azimuths: &[Azimuth]) -> Made {
        let size = [field.columns(), field.rows()];
        let cell = field.cell().to_array();
        let old = self.heights.take().filter(|level| level.size == size && self.cell == cell);
        if old.is_none() {
            (self.cell, self.top, self.azimuths) = (cell, 0.0, Vec::new());
        }
        let mut level = old.unwrap_or_else(|| Level::new(&Grid::new(size, size)));
        let mut made = Made::default();
        if let Some(rows) = level.changed(field) {
            level.copy(field, &rows);
            self.top = field.heights().iter().copied().fold(f32::MIN, f32::max);
            made.levels = 1;
        }
        self.heights = Some(level);
        if self.azimuths.iter().map(|(azimuth, _)| azimuth).eq(azimuths) {
            return made;
        }
        let longest = (0..2).map(|axis| size[axis] as f64 * f64::from(self.cell[axis])).fold(0.0, f64::max);
        let distances = || (1..=self.samples).map(|sample| (0, longest * sample as f64 / self.samples as f64));
        let aimed = azimuths.iter().map(|azimuth| (*azimuth, steps(azimuth.angle, self.cell, distances())));
        self.azimuths = aimed.collect();
        Made { azimuths: azimuths.len(), ..made }
    }

    fn elevations(&self, at: Points<'_>, azimuths: Range<usize>, out: &mut [f32]) {
        assert_eq!(out.len(), at.len() * azimuths.len(), "an entry for every point and azimuth");
        let level = self.level();
        let mut rays = Rays::<2>::new(std::slice::from_ref(level), self.border, self.simd);
        for group in groups(at, level.size) {
            let (first, count) = (group.first, group.count);
            rays.stand(group, 0);
            for (index, (_, steps)) in self.azimuths[azimuths.clone()].iter().enumerate() {
                let elevations = rays.look(steps, Scale::Linear);
                out[index * at.len() + first..][..count].copy_from_slice(elevations);
            }
        }
    }

    /// Looks no farther than the light's ray lies below the field's top, nor where all of a run are hidden.
    fn hidden(&self, at: Points<'_>, azimuth: usize, elevation: f32, out: &mut [bool]) {
        assert_eq!(out.len(), at.len(), "an entry for every point");
        let level = self.level();
        let (_, steps) = &self.azimuths[azimuth];
        let mut rays = Rays::<2>::new(std::slice::from_ref(level), self.border, self.simd);
        for group in groups(at, level.size) {
            let (first, count) = (group.first, group.count);
            rays.stand(group, 0);
            let out = &mut out[first..][..count];
            out.fill(false);
            // The steepest that anything at a distance could be seen under.
            let rise = self.top - rays.lowest(0);
            for near in steps.chunks(AT_ONCE) {
                if out.iter().all(|hidden| *hidden) || rise * near[0].inverse <= elevation.tan() {
                    break;
                }
                let seen = rays.look(near, Scale::Linear).iter();
                out.iter_mut().zip(seen).for_each(|(hidden, horizon)| *hidden |= *horizon > elevation);
            }
        }
    }

    fn work(&self, _azimuth: usize) -> Work {
        Work { samples: self.samples as f64, bytes: 4.0 * self.samples as f64 }
    }

    fn footprint(&self) -> usize {
        let heights = self.heights.as_ref().map_or(0, |level| size_of_val(&level.heights[..]));
        heights + self.azimuths.iter().map(|(_, steps)| size_of_val(&steps[..])).sum::<usize>()
    }
}
