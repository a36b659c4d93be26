//! A mesh as the makers of sphere sets see it: in its unit frame, on voxels, as points to be bounded.

use glam::{DVec3, Vec3};
use halflight_scenes::{Mesh, Sphere};
use rayon::prelude::*;

use crate::SphereSet;
use crate::cluster::Ball;
use crate::samples::{Samples, midpoint, surface_points};
use crate::voxels::{Voxels, ball_volume, bounds};

/// Voxels along the longest side of the bounding box.
const VOXELS: u32 = 64;
/// Cells of sample points inside the mesh that are aimed at: in all, and for each sphere.
const CELLS: [usize; 2] = [12_000, 30];
/// Fewest and most cells along the longest side.
const CELLS_ALONG: [f32; 2] = [24.0, 80.0];
/// Smallest radius relative to the longest side.
const SMALLEST: f64 = 1e-6;
/// Below this share of the bounding box's ball the mesh has no interior to speak of.
const NO_INTERIOR: f32 = 1e-6;

/// What all makers of sphere sets start from, and end with: [`Body::set`]. Lengths are relative to the longest side of the
/// bounding box, whose centre is the origin.
pub(crate) struct Body<'a> {
    mesh: &'a Mesh,
    frame: UnitFrame,
    pub(crate) voxels: Voxels,
    /// Points thinned, by cell.
    pub(crate) samples: Samples,
    /// All points: positions, midpoints of triangles, further points of the surface, points inside.
    pub(crate) points: Vec<Vec3>,
}

/// Balls and the points that each holds, as indices into [`Body::points`]; every point is held by a ball.
pub(crate) struct Parts {
    pub(crate) balls: Vec<Ball>,
    pub(crate) held: Vec<Vec<u32>>,
}

impl<'a> Body<'a> {
    /// Points dense enough for `count` spheres. A mesh that has no size is a set already.
    pub(crate) fn new(mesh: &'a Mesh, count: usize) -> Result<Self, SphereSet> {
        let Some(frame) = UnitFrame::around(&mesh.positions) else { return Err(SphereSet::default()) };
        if frame.size == 0.0 {
            let sphere = Sphere { center: mesh.positions[0], radius: frame.padding.max(f32::MIN_POSITIVE) };
            return Err(SphereSet { spheres: vec![sphere], outside_volume: 0.0 });
        }
        let positions: Vec<Vec3> = mesh.positions.iter().map(|p| frame.enter(*p)).collect();
        let voxels = Voxels::new(&positions, &mesh.triangles, VOXELS);
        let cells = CELLS[0].max(CELLS[1] * count) as f32;
        let spacing = (cells / voxels.volume()).cbrt().clamp(CELLS_ALONG[0], CELLS_ALONG[1]).recip();
        let mut points = surface_points(&positions, &mesh.triangles, spacing);
        let samples = Samples::new(&points, &voxels, spacing);
        points.extend(&samples.interior);
        Ok(Body { mesh, frame, voxels, samples, points })
    }

    /// For each ball the points that are given to it, by `taker`.
    pub(crate) fn shared_out(&self, balls: usize, taker: impl Fn(Vec3) -> usize + Sync) -> Vec<Vec<u32>> {
        let taken: Vec<usize> = self.points.par_iter().map(|point| taker(*point)).collect();
        let mut held = vec![Vec::new(); balls];
        taken.iter().enumerate().for_each(|(point, ball)| held[*ball].push(point as u32));
        held
    }

    /// The set in the mesh's own frame. Positions and midpoints are bounded anew where they really are.
    pub(crate) fn set(&self, parts: &Parts) -> SphereSet {
        let bounded = parts.balls.iter().zip(&parts.held).filter(|(_, held)| !held.is_empty());
        let spheres: Vec<Sphere> = bounded.map(|(ball, held)| self.sphere(ball, held)).collect();
        let size = self.frame.size;
        let outside = |s: &Sphere| self.voxels.outside(self.frame.enter(s.center), (f64::from(s.radius) / size) as f32);
        let outside_volume = spheres.iter().map(outside).sum::<f32>() / self.reference_volume();
        SphereSet { spheres, outside_volume }
    }

    fn sphere(&self, ball: &Ball, held: &[u32]) -> Sphere {
        let UnitFrame { size, padding, .. } = self.frame;
        let center = self.frame.leave(ball.center);
        let distances =
            held.iter().filter_map(|i| self.exact(*i as usize)).map(|p| p.as_dvec3().distance(center.as_dvec3()));
        let radius = distances.fold(f64::from(ball.radius) * size, f64::max);
        // Never a point: what casts a shadow has a size.
        let radius = radius.max(SMALLEST * size) as f32 + padding;
        Sphere { center, radius: radius.next_up().clamp(f32::MIN_POSITIVE, f32::MAX) }
    }

    /// A position or midpoint in the mesh's own frame; none for other points.
    fn exact(&self, point: usize) -> Option<Vec3> {
        let positions = &self.mesh.positions;
        match point.checked_sub(positions.len()) {
            None => Some(positions[point]),
            Some(i) => self.mesh.triangles.get(i).map(|t| midpoint(t.map(|corner| positions[corner as usize]))),
        }
    }

    /// What outside volumes are relative to, in the unit frame.
    fn reference_volume(&self) -> f32 {
        let (low, high) = bounds(&self.mesh.positions);
        let around = ball_volume(0.5 * self.frame.enter(low).distance(self.frame.enter(high)));
        if self.voxels.volume() > NO_INTERIOR * around { self.voxels.volume() } else { around }
    }
}

/// The frame in which sets are made: the bounding box's centre is the origin and its longest side 1, so that neither the
/// size nor the place of a mesh matters.
struct UnitFrame {
    center: DVec3,
    size: f64,
    /// Rounding error of single precision where the mesh lies.
    padding: f32,
}

impl UnitFrame {
    fn around(positions: &[Vec3]) -> Option<UnitFrame> {
        let (low, high) = bounds(positions);
        let farthest = low.abs().max(high.abs()).max_element();
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let frame = UnitFrame {
            center: 0.5 * (low + high),
            size: (high - low).max_element(),
            padding: 4.0 * f32::EPSILON * farthest,
        };
        (!positions.is_empty()).then_some(frame)
    }

    fn enter(&self, point: Vec3) -> Vec3 {
        ((point.as_dvec3() - self.center) / self.size).as_vec3()
    }

    fn leave(&self, point: Vec3) -> Vec3 {
        (point.as_dvec3() * self.size + self.center).as_vec3()
    }
}
