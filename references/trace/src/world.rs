//! The traced world: geometries built once into bounding volume hierarchies, then asked in batches.

use glam::Vec3;
use rayon::prelude::*;

use crate::sphere::{Sphere, SpherePacket};
use crate::traced_ray::TracedRay;
use crate::triangle::{Triangle, TrianglePacket};
use crate::wide::{Hierarchy, Id, Stack};

/// One geometry of a [`World`], borrowed while the world is built.
#[derive(Clone, Copy, Debug)]
pub enum Geometry<'a> {
    /// Triangles as indices into positions.
    Triangles {
        /// Corner positions, finite.
        positions: &'a [Vec3],
        /// Three indices a triangle.
        triangles: &'a [[u32; 3]],
    },
    /// Exact spheres.
    Spheres(&'a [Sphere]),
}

/// A ray segment `origin + t·direction` with `t_min < t < t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start point.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Lower end of the segment, exclusive, not negative.
    pub t_min: f32,
    /// Upper end of the segment, exclusive; may be infinite.
    pub t_max: f32,
}

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    /// Index of the geometry in the slice that the world was built from.
    pub geometry: u32,
    /// Triangle or sphere index within that geometry.
    pub primitive: u32,
    /// Barycentric weights of the triangle's second and third corner (0 for spheres).
    pub barycentrics: [f32; 2],
}

/// Rays a task: enough to outweigh its start, few enough to share the work evenly.
const CHUNK: usize = 512;

/// Geometry ready to be traced. Rays that are not finite hit nothing.
pub struct World {
    triangles: Hierarchy<TrianglePacket>,
    spheres: Hierarchy<SpherePacket>,
}

impl World {
    /// Builds the hierarchies over all geometries. Triangles without area and whatever is not finite are never hit.
    ///
    /// # Panics
    /// If a triangle's index lies beyond its positions.
    pub fn build(geometries: &[Geometry<'_>]) -> Self {
        let (triangles, spheres) = proper(geometries);
        World { triangles: Hierarchy::build(&triangles), spheres: Hierarchy::build(&spheres) }
    }

    /// For each ray, whether anything lies on its segment. Uses all cores when the batch is large.
    /// `blocked` has the length of `rays`.
    pub fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        in_chunks(rays, blocked, |ray, stack| self.any(ray, stack));
    }

    /// Occlusion of a bundle of rays that leave one receiver, on the calling thread.
    /// `blocked` has the length of `directions`.
    pub fn occluded_from(&self, origin: Vec3, t_min: f32, directions: &[Vec3], blocked: &mut [bool]) {
        assert_eq!(directions.len(), blocked.len(), "one answer a direction");
        let mut stack = Stack::default();
        for (direction, answer) in directions.iter().zip(blocked) {
            *answer = self.any(&Ray { origin, direction: *direction, t_min, t_max: f32::INFINITY }, &mut stack);
        }
    }

    /// For each ray, its closest hit. Uses all cores when the batch is large.
    /// `hits` has the length of `rays`.
    pub fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        in_chunks(rays, hits, |ray, stack| self.nearest(ray, stack));
    }

    fn any(&self, ray: &Ray, stack: &mut Stack) -> bool {
        TracedRay::new(ray.origin, ray.direction, ray.t_min).is_some_and(|traced| {
            self.triangles.any(&traced, ray.t_max, stack) || self.spheres.any(&traced, ray.t_max, stack)
        })
    }

    fn nearest(&self, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
        let traced = TracedRay::new(ray.origin, ray.direction, ray.t_min)?;
        let triangle = self.triangles.closest(&traced, ray.t_max, stack);
        let limit = triangle.map_or(ray.t_max, |(found, _)| found.t);
        let (found, id) = self.spheres.closest(&traced, limit, stack).or(triangle)?;
        Some(Hit { t: found.t, geometry: id.geometry, primitive: id.primitive, barycentrics: found.barycentrics })
    }
}

type Named<P> = Vec<(P, Id)>;

/// What can be hit. Nothing else may reach the builder, which an infinite corner can crash.
fn proper(geometries: &[Geometry<'_>]) -> (Named<Triangle>, Named<Sphere>) {
    let mut triangles = Vec::new();
    let mut spheres = Vec::new();
    for (geometry, content) in (0..).zip(geometries) {
        let id = |primitive| Id { geometry, primitive };
        match content {
            Geometry::Triangles { positions, triangles: indices } => {
                let corners = indices.iter().map(|triple| Triangle(triple.map(|i| positions[i as usize])));
                triangles.extend((0..).zip(corners).filter(|(_, t)| t.is_proper()).map(|(i, t)| (t, id(i))));
            }
            Geometry::Spheres(all) => {
                spheres.extend((0..).zip(*all).filter(|(_, s)| s.is_proper()).map(|(i, s)| (*s, id(i))));
            }
        }
    }
    (triangles, spheres)
}

/// Answers every ray; each answer depends on its ray alone, so the split changes no bit.
fn in_chunks<A: Send>(rays: &[Ray], answers: &mut [A], ask: impl Fn(&Ray, &mut Stack) -> A + Sync) {
    assert_eq!(rays.len(), answers.len(), "one answer a ray");
    let run = |(rays, answers): (&[Ray], &mut [A])| {
        let mut stack = Stack::default();
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = ask(ray, &mut stack);
        }
    };
    if rays.len() <= CHUNK {
        run((rays, answers));
    } else {
        rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).for_each(run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_can_be_hit_reaches_the_builder() {
        let positions =
            [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY), Vec3::X * 2.0];
        let triangles = [[0, 1, 3], [0, 1, 4], [0, 1, 5], [1, 1, 2], [0, 1, 2]];
        let sphere = |x, radius| Sphere { center: Vec3::X * x, radius };
        let spheres = [
            sphere(f32::NAN, 1.0),
            sphere(0.0, -1.0),
            sphere(0.0, 0.0),
            sphere(0.0, f32::NAN),
            sphere(0.0, f32::INFINITY),
            sphere(f32::MAX, f32::MAX),
            sphere(1.0, 2.0),
        ];
        let geometries =
            [Geometry::Spheres(&spheres), Geometry::Triangles { positions: &positions, triangles: &triangles }];
        let (triangles, spheres) = proper(&geometries);
        assert_eq!(triangles.iter().map(|(_, id)| (id.geometry, id.primitive)).collect::<Vec<_>>(), [(1, 4)]);
        assert_eq!(spheres.iter().map(|(_, id)| (id.geometry, id.primitive)).collect::<Vec<_>>(), [(0, 6)]);
    }
}
