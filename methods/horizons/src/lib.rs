//! Height fields seen as horizons: under which elevation a point of the surface sees the sky begin, azimuth by azimuth
//! (Snyder and Nowrouzezahrai 2008, §4).
//!
//! Three ways of finding them, behind one trait:
//! - [`Pyramid`], the paper's: one height difference a scale, from a level of a pyramid whose spacing is the distance;
//! - [`March`], its ground truth: evenly spaced samples of the finest heights;
//! - [`Sweep`]: convex hulls that grow along parallel lines (Timonen and Westerholm 2010), a horizon for every vertex at once.
//!
//! Beyond the border there is nothing for the sweep, while the others let the field go on as it ends there, as the paper's textures
//! do, or see nothing either ([`Border`]).
//!
//! A field has at least 2 × 2 vertices and finite heights: [`HeightField`] takes no other, and a loader says so of a file. All horizons are
//! finite and within `[0, π/2]`, whatever the heights, cells and points.
//!
//! Azimuths are in radians from +x towards +y, elevations in radians in `[0, π/2]`, distances in metres.

mod arctangent;
#[cfg(feature = "gpu")]
mod gpu;
mod grid;
mod hull;
mod level;
mod line;
mod march;
mod pyramid;
mod ray;
mod runs;
mod shape;
mod spots;
pub mod study;
mod sweep;

use std::ops::Range;

use halflight_scenes::HeightField;

#[cfg(feature = "gpu")]
pub use gpu::{Edit, GpuPyramid, place};
pub use march::March;
pub use pyramid::{Plane, Pyramid, Reconstruction, Scale, Settings, Storage};
pub use ray::Border;
pub use sweep::Sweep;

/// Receivers by grid coordinates: `(i, j)` is vertex `(i, j)`, and what lies outside is moved to the border. Where neighbours in
/// the slices are neighbours on a row of the grid, one a vertex, horizons stream.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// Along the field's columns.
    pub x: &'a [f32],
    /// Along its rows, as many as of `x`.
    pub y: &'a [f32],
}

impl Points<'_> {
    /// The number of points.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }
}

/// A direction in the horizontal plane, and what its horizon is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Azimuth {
    /// Radians from +x towards +y.
    pub angle: f32,
    /// What its horizon is for.
    pub purpose: Purpose,
}

/// The light that a horizon is to shadow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// One from few directions, whose shadows show every edge.
    Key,
    /// One from everywhere, for which a cheaper horizon serves (§6: without the B-spline in scale).
    Environment,
}

/// What a pass over receivers costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Samples of heights.
    pub samples: f64,
    /// Bytes of stored heights that a pass over all vertices reads at least.
    pub bytes: f64,
}

/// What an update made again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Made {
    /// Levels of heights of which rows were made.
    pub levels: usize,
    /// Azimuths that were aimed at, or swept under.
    pub azimuths: usize,
}

/// A height field of which horizons are asked.
pub trait Horizons: Send + Sync {
    /// Takes a field and the azimuths that will be asked. What did not change since the last call is not made again.
    fn update(&mut self, field: &HeightField, azimuths: &[Azimuth]) -> Made;

    /// Elevations of the horizon as seen from points of the surface, under some of the azimuths of the last
    /// [`Horizons::update`]: those of all points under the first azimuth, then those under the next, and so on.
    ///
    /// # Panics
    /// If an azimuth is not known, or `out` has not `at.len() · azimuths.len()` entries.
    fn elevations(&self, at: Points<'_>, azimuths: Range<usize>, out: &mut [f32]);

    /// Whether points see the horizon above an elevation in radians, so that light from there does not reach them.
    ///
    /// # Panics
    /// If the azimuth is not known, or `out` has not an entry for every point.
    fn hidden(&self, at: Points<'_>, azimuth: usize, elevation: f32, out: &mut [bool]) {
        let mut horizons = vec![0.0; at.len()];
        self.elevations(at, azimuth..azimuth + 1, &mut horizons);
        assert_eq!(out.len(), at.len(), "an entry for every point");
        out.iter_mut().zip(horizons).for_each(|(hidden, horizon)| *hidden = horizon > elevation);
    }

    /// Work of one receiver under one azimuth, on average over all vertices.
    fn work(&self, azimuth: usize) -> Work;

    /// Bytes held between frames.
    fn footprint(&self) -> usize;
}
