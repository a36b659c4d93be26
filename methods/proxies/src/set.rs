//! From a mesh to its sphere set.

use glam::{DVec3, Vec3};
use halflight_scenes::{Mesh, Sphere};
use rayon::prelude::*;

use crate::cluster::{Ball, Clusters};
use crate::samples::{Samples, midpoint, surface_points};
use crate::search::{STEPS, search};
use crate::voxels::{Voxels, ball_volume, bounds};

/// Largest number of spheres in a set.
pub const MAX_COUNT: usize = 1024;

/// Number of spheres when nothing is said. More bound the object more closely but overlap more, and overlap drives truncated
/// SH products out of their domain: at order 4 the error against the light in SH grows again above 32 on the shipped scenes.
pub const DEFAULT_COUNT: usize = 32;

/// Voxels along the longest side of the bounding box.
const VOXELS: u32 = 64;
/// Cells of sample points inside the mesh that are aimed at: in all, and for each sphere.
const CELLS: [usize; 2] = [12_000, 30];
/// Fewest and most cells along the longest side.
const CELLS_ALONG: [f32; 2] = [24.0, 80.0];
/// Rounds of settling with all points.
const LAST_ROUNDS: usize = 2;
/// Smallest radius relative to the longest side.
const SMALLEST: f64 = 1e-6;
/// Below this share of the bounding box's ball the mesh has no interior to speak of.
const NO_INTERIOR: f32 = 1e-6;

/// Spheres that bound an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SphereSet {
    /// Spheres in the object's rest position; radii are positive.
    pub spheres: Vec<Sphere>,
    /// Outside volume `Σ V(Sᵢ − T)` (Ren 2006, eq. 35) relative to the object's volume, finite. An object without an
    /// interior (a plane; a volume below a millionth of the other) is measured against the ball around its bounding
    /// box. The voxel grid adds about 1% of the volume of each sphere that touches the surface from inside.
    pub outside_volume: f32,
}

/// Bounds a mesh by at most `count` spheres (taken as the nearest of 1..=[`MAX_COUNT`]).
///
/// The spheres hold all positions and all triangle midpoints of the mesh, and points a 24th to an 80th of its longest
/// side apart on triangles that are larger; parts of triangles between these may look out. The result depends on the
/// mesh and the count alone, not on the number of threads. `progress` is told steps done and in all; if it answers `false` the search ends with `None`. A
/// mesh without positions has no spheres.
pub fn sphere_set(mesh: &Mesh, count: usize, progress: &mut dyn FnMut(u64, u64) -> bool) -> Option<SphereSet> {
    progress(0, STEPS).then_some(())?;
    let Some(frame) = UnitFrame::around(&mesh.positions) else { return Some(SphereSet::default()) };
    if frame.size == 0.0 {
        let sphere = Sphere { center: mesh.positions[0], radius: frame.padding.max(f32::MIN_POSITIVE) };
        return Some(SphereSet { spheres: vec![sphere], outside_volume: 0.0 });
    }
    let count = count.clamp(1, MAX_COUNT);
    let positions: Vec<Vec3> = mesh.positions.iter().map(|p| frame.enter(*p)).collect();
    let voxels = Voxels::new(&positions, &mesh.triangles, VOXELS);
    let cells = CELLS[0].max(CELLS[1] * count) as f32;
    let spacing = (cells / voxels.volume()).cbrt().clamp(CELLS_ALONG[0], CELLS_ALONG[1]).recip();
    let surface = surface_points(&positions, &mesh.triangles, spacing);
    let samples = Samples::new(&surface, &voxels, spacing);
    let clusters = search(&voxels, &samples, count, &mut |done| progress(done, STEPS))?;
    let points: Vec<Vec3> = surface.iter().chain(&samples.interior).copied().collect();
    let clusters = bound_all(&voxels, &points, &clusters);
    progress(STEPS, STEPS).then_some(())?;
    Some(frame.leave_all(mesh, &clusters, &voxels))
}

/// Clusters of all points, not of the thinned ones alone.
fn bound_all<'a>(voxels: &'a Voxels, points: &'a [Vec3], thinned: &Clusters<'_>) -> Clusters<'a> {
    let taken: Vec<usize> = points.par_iter().map(|point| thinned.nearest(*point)).collect();
    let mut held = vec![Vec::new(); thinned.balls.len()];
    taken.iter().enumerate().for_each(|(point, ball)| held[*ball].push(point as u32));
    let centers: Vec<Vec3> = thinned.balls.iter().map(|ball| ball.center).collect();
    let mut clusters = Clusters::new(voxels, points, held, &centers);
    clusters.settle(LAST_ROUNDS);
    clusters
}

/// The frame in which the search works: the bounding box's centre is the origin and its longest side 1, so that
/// neither the size nor the place of a mesh matters.
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

    /// The set in the mesh's own frame. `clusters` holds positions, midpoints and further points, in this order; the
    /// first two are bounded anew where they really are.
    fn leave_all(&self, mesh: &Mesh, clusters: &Clusters<'_>, voxels: &Voxels) -> SphereSet {
        let exact = |i: usize| match i.checked_sub(mesh.positions.len()) {
            None => Some(mesh.positions[i]),
            Some(i) => mesh.triangles.get(i).map(|t| midpoint(t.map(|corner| mesh.positions[corner as usize]))),
        };
        let sphere = |(ball, held): (&Ball, &Vec<u32>)| {
            let center = self.leave(ball.center);
            let distances =
                held.iter().filter_map(|i| exact(*i as usize)).map(|p| p.as_dvec3().distance(center.as_dvec3()));
            let radius = distances.fold(f64::from(ball.radius) * self.size, f64::max);
            // Never a point: what casts a shadow has a size.
            let radius = radius.max(SMALLEST * self.size) as f32 + self.padding;
            Sphere { center, radius: radius.next_up().clamp(f32::MIN_POSITIVE, f32::MAX) }
        };
        let bounded = clusters.balls.iter().zip(&clusters.held).filter(|(_, held)| !held.is_empty());
        let spheres: Vec<Sphere> = bounded.map(sphere).collect();
        let outside =
            |sphere: &Sphere| voxels.outside(self.enter(sphere.center), (f64::from(sphere.radius) / self.size) as f32);
        let outside_volume = spheres.iter().map(outside).sum::<f32>() / reference_volume(voxels, self, mesh);
        SphereSet { spheres, outside_volume }
    }
}

/// What outside volumes are relative to, in the unit frame.
fn reference_volume(voxels: &Voxels, frame: &UnitFrame, mesh: &Mesh) -> f32 {
    let (low, high) = bounds(&mesh.positions);
    let around = ball_volume(0.5 * frame.enter(low).distance(frame.enter(high)));
    if voxels.volume() > NO_INTERIOR * around { voxels.volume() } else { around }
}
