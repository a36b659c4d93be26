//! Tables of canonical wedges by their horizon angles.

use std::f64::consts::FRAC_PI_2;

use halflight_contract::{Derived, Job, Meter, Result};
use halflight_scenes::Scene;
use halflight_sh::{Block, LANES, coefficients};
use rayon::prelude::*;

use crate::wedge::Projector;

/// Elevations from 0 to π/2 at which wedges are tabulated.
pub(crate) const ELEVATIONS: usize = 256;

/// Table entries a radian.
pub(crate) const PER_RADIAN: f64 = (ELEVATIONS - 1) as f64 / FRAC_PI_2;

/// Wedges of one extent, each in [`Wedges::rows`] blocks whose entries beyond `n²` are 0.
pub(crate) struct Wedges {
    /// SH order.
    pub(crate) order: usize,
    /// Wedges that begin at azimuth 0, of the full extent, by the entries of the angles at their start and end:
    /// `(start · ELEVATIONS + end) · rows`.
    pub(crate) interior: Vec<Block<f32>>,
    /// Wedges that begin at azimuth 0, of half the extent, over which the horizon rises to the zenith, by the entry of the angle at their
    /// start. The boundary that ends at azimuth 0 is its mirror image.
    pub(crate) boundary: Vec<Block<f32>>,
}

/// Blocks that a wedge takes.
pub(crate) fn rows(order: usize) -> usize {
    coefficients(order).div_ceil(LANES)
}

fn elevation(entry: usize) -> f64 {
    entry as f64 / PER_RADIAN
}

impl Wedges {
    /// Tables of an order for wedges of so many radians. `boundaries`: whether those of half the extent are made.
    pub(crate) fn new(order: usize, extent: f64, boundaries: bool) -> Wedges {
        Wedges {
            order,
            interior: interior(order, extent),
            boundary: if boundaries { boundary(order, extent) } else { Vec::new() },
        }
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.interior[..]) + size_of_val(&self.boundary[..])
    }
}

fn interior(order: usize, extent: f64) -> Vec<Block<f32>> {
    let (rows, last) = (rows(order), ELEVATIONS - 1);
    let projector = Projector::new(order, extent);
    let rise = |index: usize| elevation(index) - elevation(last);
    let ramps: Vec<_> = (0..=2 * last).into_par_iter().map(|index| projector.ramp(rise(index))).collect();
    let mut table = vec![Block::ZERO; ELEVATIONS * ELEVATIONS * rows];
    table.par_chunks_exact_mut(ELEVATIONS * rows).enumerate().for_each(|(start, table)| {
        let mut wedge = vec![0.0; coefficients(order)];
        for (end, entry) in table.chunks_exact_mut(rows).enumerate() {
            projector.project(elevation(start), &ramps[last + end - start], &mut wedge);
            write(&wedge, entry);
        }
    });
    table
}

fn boundary(order: usize, extent: f64) -> Vec<Block<f32>> {
    let rows = rows(order);
    let projector = Projector::new(order, 0.5 * extent);
    let mut table = vec![Block::ZERO; ELEVATIONS * rows];
    let mut wedge = vec![0.0; coefficients(order)];
    for (start, entry) in table.chunks_exact_mut(rows).enumerate() {
        let from = elevation(start);
        projector.project(from, &projector.ramp(FRAC_PI_2 - from), &mut wedge);
        write(&wedge, entry);
    }
    table
}

fn write(wedge: &[f64], entry: &mut [Block<f32>]) {
    wedge.iter().enumerate().for_each(|(i, value)| entry[i / LANES].0[i % LANES] = *value as f32);
}

/// Recipe for [`Wedges`], which depend on no scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WedgesOf {
    pub(crate) order: usize,
    /// Radians.
    pub(crate) extent: f64,
    pub(crate) boundaries: bool,
}

impl Derived for WedgesOf {
    type Value = Wedges;
    const NAME: &'static str = "wedge-tables";
    const REVISION: &'static str = "1";

    fn key(&self, _: &Scene) -> String {
        format!("{}:{:x}:{}", self.order, self.extent.to_bits(), self.boundaries)
    }

    fn make(&self, _: &Job<'_, '_>, _: &mut dyn Meter) -> Result<Wedges> {
        Ok(Wedges::new(self.order, self.extent, self.boundaries))
    }
}
