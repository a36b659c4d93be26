//! The traced world, asked in batches: what stands still as one body, what moves as instances of bodies.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use crate::body::{Body, Geometry};
use crate::instance::{Instance, InstancePacket};
use crate::traced_ray::TracedRay;
use crate::wide::{Hierarchy, Id, Stack};

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
    /// Index of the geometry in the slice that its body was built from, plus that of its instance.
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
    fixed: Arc<Body>,
    moving: Hierarchy<InstancePacket>,
}

/// For the instances, and in it for the bodies.
type Stacks = Stack<Stack>;

impl World {
    /// Builds one body of all geometries and holds that alone.
    ///
    /// # Panics
    /// As [`Body::build`].
    pub fn build(geometries: &[Geometry<'_>]) -> Self {
        World::new(Arc::new(Body::build(geometries)), &[])
    }

    /// A body at rest, at the cost of nothing, and instances of others, at the cost of a small hierarchy over them.
    /// Rays in a world without instances take the same time as rays in the body alone.
    pub fn new(fixed: Arc<Body>, instances: &[Instance]) -> Self {
        let held = instances.iter().filter(|instance| instance.is_proper());
        let named = held.map(|instance| (instance.clone(), Id { geometry: instance.geometry, primitive: 0 }));
        World { fixed, moving: Hierarchy::build(&named.collect::<Vec<_>>()) }
    }

    /// For each ray, whether anything lies on its segment. Uses all cores when the batch is large.
    /// `blocked` has the length of `rays`.
    pub fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        in_chunks(rays, blocked, |ray, stacks| self.any(ray, stacks));
    }

    /// Occlusion of a bundle of rays that leave one receiver, on the calling thread.
    /// `blocked` has the length of `directions`.
    pub fn occluded_from(&self, origin: Vec3, t_min: f32, directions: &[Vec3], blocked: &mut [bool]) {
        assert_eq!(directions.len(), blocked.len(), "one answer a direction");
        let mut stacks = Stacks::default();
        for (direction, answer) in directions.iter().zip(blocked) {
            *answer = self.any(&Ray { origin, direction: *direction, t_min, t_max: f32::INFINITY }, &mut stacks);
        }
    }

    /// For each ray, its closest hit. Uses all cores when the batch is large.
    /// `hits` has the length of `rays`.
    pub fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        in_chunks(rays, hits, |ray, stacks| self.nearest(ray, stacks));
    }

    fn any(&self, ray: &Ray, stacks: &mut Stacks) -> bool {
        TracedRay::new(ray.origin, ray.direction, ray.t_min).is_some_and(|traced| {
            self.fixed.any(&traced, ray.t_max, &mut stacks.scratch) || self.moving.any(&traced, ray.t_max, stacks)
        })
    }

    fn nearest(&self, ray: &Ray, stacks: &mut Stacks) -> Option<Hit> {
        let traced = TracedRay::new(ray.origin, ray.direction, ray.t_min)?;
        let fixed = self.fixed.closest(&traced, ray.t_max, &mut stacks.scratch);
        let limit = fixed.map_or(ray.t_max, |hit| hit.t);
        let moving = self.moving.closest(&traced, limit, stacks).map(|(found, _)| found.detail);
        moving.or(fixed)
    }
}

/// Answers every ray; each answer depends on its ray alone, so the split changes no bit.
fn in_chunks<A: Send>(rays: &[Ray], answers: &mut [A], ask: impl Fn(&Ray, &mut Stacks) -> A + Sync) {
    assert_eq!(rays.len(), answers.len(), "one answer a ray");
    let run = |(rays, answers): (&[Ray], &mut [A])| {
        let mut stacks = Stacks::default();
        for (ray, answer) in rays.iter().zip(answers) {
            *answer = ask(ray, &mut stacks);
        }
    };
    if rays.len() <= CHUNK {
        run((rays, answers));
    } else {
        rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).for_each(run);
    }
}
