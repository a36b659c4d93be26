//! The traced world, asked in batches: what stands still as one body, what moves as instances of bodies.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use crate::body::{Body, Geometry};
use crate::instance::{Instance, InstancePacket};
use crate::traced_ray::TracedRay;
use crate::wide::{BUNDLE, Bundle, Hierarchy, Id, Stack};

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
        in_chunks(rays, blocked, |rays, blocked, stacks| {
            for (rays, blocked) in rays.chunks(BUNDLE).zip(blocked.chunks_mut(BUNDLE)) {
                self.any_of(rays.len(), |i| rays[i], blocked, stacks);
            }
        });
    }

    /// Occlusion of a bundle of rays that leave one receiver, on the calling thread.
    /// `blocked` has the length of `directions`.
    pub fn occluded_from(&self, origin: Vec3, t_min: f32, directions: &[Vec3], blocked: &mut [bool]) {
        assert_eq!(directions.len(), blocked.len(), "one answer a direction");
        let mut stacks = Stacks::default();
        let ray = |direction| Ray { origin, direction, t_min, t_max: f32::INFINITY };
        for (directions, blocked) in directions.chunks(BUNDLE).zip(blocked.chunks_mut(BUNDLE)) {
            self.any_of(directions.len(), |i| ray(directions[i]), blocked, &mut stacks);
        }
    }

    /// For each ray, its closest hit. Uses all cores when the batch is large.
    /// `hits` has the length of `rays`.
    pub fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        in_chunks(rays, hits, |rays, hits, stacks| {
            rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.nearest(ray, stacks));
        });
    }

    /// For up to [`BUNDLE`] rays.
    fn any_of(&self, count: usize, ray: impl Fn(usize) -> Ray, blocked: &mut [bool], stacks: &mut Stacks) {
        let mut traced = [TracedRay::NONE; BUNDLE];
        let mut ends = [0.0; BUNDLE];
        let mut open = 0;
        for i in 0..count {
            let Ray { origin, direction, t_min, t_max } = ray(i);
            if let Some(ray) = TracedRay::new(origin, direction, t_min) {
                traced[i] = ray;
                open |= 1 << i;
            }
            ends[i] = t_max;
        }
        let bundle = Bundle { rays: &traced, ends: &ends, open };
        let mut hit = self.fixed.any_of(bundle, &mut stacks.scratch);
        hit |= self.moving.any_of(Bundle { open: open & !hit, ..bundle }, stacks);
        blocked.iter_mut().enumerate().for_each(|(i, blocked)| *blocked = hit >> i & 1 == 1);
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
fn in_chunks<A: Send>(rays: &[Ray], answers: &mut [A], ask: impl Fn(&[Ray], &mut [A], &mut Stacks) + Sync) {
    assert_eq!(rays.len(), answers.len(), "one answer a ray");
    let run = |(rays, answers): (&[Ray], &mut [A])| ask(rays, answers, &mut Stacks::default());
    if rays.len() <= CHUNK {
        run((rays, answers));
    } else {
        rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).for_each(run);
    }
}
