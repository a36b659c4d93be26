//! Sphere sets, and who makes them.

use halflight_scenes::{Mesh, Sphere};

use crate::body::{Body, Parts};
use crate::cluster::Clusters;
use crate::competitors::{medial, octree};
use crate::search::{STEPS, search};

/// Largest number of spheres in a set.
pub const MAX_COUNT: usize = 1024;

/// Number of spheres when nothing is said. More bound the object more closely but overlap more, and overlap drives truncated
/// SH products out of their domain: at order 4 the error against the light in SH grows again above 32 on the shipped scenes.
pub const DEFAULT_COUNT: usize = 32;

/// Rounds of settling with all points.
const LAST_ROUNDS: usize = 2;

/// Spheres that bound an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SphereSet {
    /// Spheres in the object's rest position; radii are not negative.
    pub spheres: Vec<Sphere>,
    /// Outside volume `Σ V(Sᵢ − T)` (Ren 2006, eq. 35) relative to the object's volume, finite. An object without an
    /// interior (a plane; a volume below a millionth of the other) is measured against the ball around its bounding
    /// box. The voxel grid adds about 1% of the volume of each sphere that touches the surface from inside.
    pub outside_volume: f32,
}

/// Who makes a sphere set. All bound the same points and are measured by the same voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Maker {
    /// Ren et al. 2006, §6.2: what [`sphere_set`] makes and methods use.
    Variational,
    /// Spheres around the cells of an octree (Hubbard 1995), for comparison.
    Octree,
    /// Maximal spheres inside, merged in pairs (after Bradshaw and O'Sullivan 2004), for comparison.
    Medial,
}

impl Maker {
    /// All makers.
    pub const ALL: [Maker; 3] = [Maker::Variational, Maker::Octree, Maker::Medial];

    /// The maker's name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Maker::Variational => "variational",
            Maker::Octree => "octree",
            Maker::Medial => "medial",
        }
    }

    /// Bounds a mesh by at most `count` spheres (taken as the nearest of 1..=[`MAX_COUNT`]).
    ///
    /// The spheres hold all positions and all triangle midpoints of the mesh, and points a 24th to an 80th of its longest
    /// side apart inside and on triangles that are larger; parts of triangles between these may look out. The result
    /// depends on the mesh and the count alone, not on the number of threads. `progress` is told steps done and in all; if
    /// it answers `false` the search ends with `None`. A mesh without positions has no spheres.
    pub fn make(self, mesh: &Mesh, count: usize, progress: &mut dyn FnMut(u64, u64) -> bool) -> Option<SphereSet> {
        progress(0, STEPS).then_some(())?;
        let count = count.clamp(1, MAX_COUNT);
        let body = match Body::new(mesh, count) {
            Ok(body) => body,
            Err(set) => return Some(set),
        };
        let parts = self.parts(&body, count, progress)?;
        progress(STEPS, STEPS).then_some(())?;
        Some(body.set(&parts))
    }

    fn parts(self, body: &Body<'_>, count: usize, progress: &mut dyn FnMut(u64, u64) -> bool) -> Option<Parts> {
        match self {
            Maker::Variational => variational(body, count, progress),
            Maker::Octree => Some(octree::parts(body, count)),
            Maker::Medial => Some(medial::parts(body, count)),
        }
    }
}

/// Bounds a mesh by at most `count` spheres of small outside volume: [`Maker::Variational`], by [`Maker::make`].
pub fn sphere_set(mesh: &Mesh, count: usize, progress: &mut dyn FnMut(u64, u64) -> bool) -> Option<SphereSet> {
    Maker::Variational.make(mesh, count, progress)
}

/// Clusters of small outside volume: searched for with the thinned points, then of all points.
fn variational(body: &Body<'_>, count: usize, progress: &mut dyn FnMut(u64, u64) -> bool) -> Option<Parts> {
    let thinned = search(&body.voxels, &body.samples, count, &mut |done| progress(done, STEPS))?;
    let held = body.shared_out(thinned.balls.len(), |point| thinned.nearest(point));
    let centers: Vec<_> = thinned.balls.iter().map(|ball| ball.center).collect();
    let mut clusters = Clusters::new(&body.voxels, &body.points, held, &centers);
    clusters.settle(LAST_ROUNDS);
    Some(Parts { balls: clusters.balls, held: clusters.held })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::shapes;

    #[test]
    fn every_sample_point_is_held_once_and_bounded() {
        for mesh in [shapes::torus(1.0, 0.3), shapes::cuboid(Vec3::new(1.0, 0.5, 0.2)), shapes::square()] {
            let body = Body::new(&mesh, 12).expect("it has a size");
            for maker in Maker::ALL {
                let parts = maker.parts(&body, 12, &mut |_, _| true).expect("nobody cancels");
                let mut times = vec![0; body.points.len()];
                for (ball, held) in parts.balls.iter().zip(&parts.held) {
                    let point = |i: u32| body.points[i as usize];
                    held.iter().for_each(|i| times[*i as usize] += 1);
                    assert!(held.iter().all(|i| ball.holds(point(*i))), "{maker:?}");
                }
                assert!(times.iter().all(|times| *times == 1), "{maker:?}");
            }
        }
    }
}
