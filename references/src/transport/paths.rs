//! Indirect light: paths from the receiver over diffuse surfaces, with the lights sampled at every one of them.

use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use halflight_trace::{Hit, Ray};

use super::{Batches, Bundle, Plan, Scratch, Term};
use crate::emission::Emission;
use crate::emitters::{Emitters, Weights};
use crate::receiver::Receiver;
use crate::sampling::{CosineLobe, Sobol, mix};
use crate::traced::{Surface, Traced};

/// Light that was reflected 1 to `bounces` times before it arrives. Surfaces reflect diffusely on both sides, about their
/// geometric normal: interpolated normals are what receivers are shaded with, and would let light through solids here.
///
/// At each surface one point on the lights and one direction of the cosine lobe are sampled, weighed by the balance heuristic
/// (Veach 1995); the latter goes on. Long paths end by Russian roulette.
pub(crate) struct Paths {
    pub(crate) traced: Arc<Traced>,
    pub(crate) emission: Arc<Emission>,
    pub(crate) emitters: Arc<Emitters>,
    pub(crate) bounces: u8,
    /// Whether no distant light comes from below the horizontal plane.
    pub(crate) upper_sky: bool,
    /// Whether the way from the first surface to the receiver is free whatever lies on it.
    pub(crate) unoccluded: bool,
}

/// Paths that are followed together.
#[derive(Default)]
pub(crate) struct Front {
    paths: Vec<Path>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    arrived: Vec<(Path, Surface)>,
    shadow_rays: Vec<Ray>,
    /// What each shadow ray brings to its batch if nothing is on it.
    light: Vec<(u32, Vec3)>,
    blocked: Vec<bool>,
    weights: Weights,
}

#[derive(Clone, Copy)]
struct Path {
    batch: u32,
    /// Its number among the batch's.
    index: u32,
    seed: u64,
    /// What of the light along the ray reaches the receiver, over the chance of the path.
    throughput: Vec3,
    /// One over the batch's paths.
    share: f32,
    /// Where the ray starts, and the normal there.
    from: Vec3,
    normal: Vec3,
}

/// Reflections after which paths may end by chance.
const SURE: u32 = 3;

/// Pairs of random dimensions at every reflection.
#[derive(Clone, Copy)]
enum Use {
    Lobe,
    Distant,
    Emitter,
    Roulette,
}

impl Term for Paths {
    fn sample(&self, receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch) {
        let from = self.traced.lift(receiver.object, receiver.position, receiver.geometric_normal);
        let lobe = CosineLobe::new(receiver.normal);
        let Scratch { batches, paths: front, .. } = scratch;
        for batch in 0..plan.batches {
            let seed = mix(seed, u64::from(batch));
            let sobol = Sobol::new(seed);
            for index in 0..plan.per_batch {
                let share = 1.0 / plan.per_batch as f32;
                let direction = lobe.direction(sobol.point(index));
                if receiver.normal.dot(direction) > 0.0 {
                    front.rays.push(Ray { origin: from, direction, t_min: 0.0, t_max: f32::INFINITY });
                    let (throughput, normal) = (Vec3::ONE, receiver.normal);
                    front.paths.push(Path { batch, index, seed, throughput, share, from, normal });
                }
            }
            if front.rays.len() >= Bundle::FULL {
                self.follow(front, batches);
            }
        }
        self.follow(front, batches);
    }

    fn known(&self, _: &Receiver, _: &mut Scratch) -> DVec3 {
        DVec3::ZERO
    }
}

impl Paths {
    /// Follows all paths to their ends.
    fn follow(&self, front: &mut Front, batches: &mut Batches) {
        match self.unoccluded {
            true => self.pass_through(front, batches),
            // What the first rays meet at once is direct light.
            false => self.arrive(front, batches, false),
        }
        for reflections in 1..=u32::from(self.bounces) {
            if front.arrived.is_empty() {
                break;
            }
            self.reflect(front, reflections);
            self.connect(front, batches);
            self.arrive(front, batches, true);
        }
        front.arrived.clear();
    }

    /// Traces the rays to where they arrive; if it is `counted`, with the light that is there.
    fn arrive(&self, front: &mut Front, batches: &mut Batches, counted: bool) {
        self.trace(front, batches);
        front.arrived.clear();
        for ((path, ray), hit) in front.paths.iter().zip(&front.rays).zip(&front.hits) {
            let surface = hit.map(|hit| self.traced.surface(ray, &hit));
            if counted {
                let light = match &surface {
                    Some(surface) if surface.emission == Vec3::ZERO => Vec3::ZERO,
                    Some(surface) => self.emitted(path, ray, surface, &mut front.weights),
                    None => self.distant(path, ray),
                };
                add(batches, path, light);
            }
            front.arrived.extend(surface.map(|surface| (*path, surface)));
        }
        front.paths.clear();
        front.rays.clear();
    }

    /// Arrives at every front that lies on the rays.
    fn pass_through(&self, front: &mut Front, batches: &mut Batches) {
        front.arrived.clear();
        while !front.rays.is_empty() {
            self.trace(front, batches);
            let mut kept = 0;
            for i in 0..front.rays.len() {
                let Some(hit) = front.hits[i] else { continue };
                let (path, ray) = (front.paths[i], front.rays[i]);
                let surface = self.traced.surface(&ray, &hit);
                if surface.front {
                    front.arrived.push((path, surface));
                }
                front.paths[kept] = path;
                front.rays[kept] = Ray { t_min: hit.t * (1.0 + 4.0 * f32::EPSILON), ..ray };
                kept += 1;
            }
            front.paths.truncate(kept);
            front.rays.truncate(kept);
        }
    }

    fn trace(&self, front: &mut Front, batches: &mut Batches) {
        front.hits.clear();
        front.hits.resize(front.rays.len(), None);
        self.traced.world.closest(&front.rays, &mut front.hits);
        batches.count(front.rays.len());
    }

    /// At each surface: a shadow ray to the distance, one to an emitter, and the ray that goes on.
    fn reflect(&self, front: &mut Front, reflections: u32) {
        let Front { paths, rays, arrived, shadow_rays, light, weights, .. } = front;
        for (path, surface) in arrived.drain(..) {
            let throughput = path.throughput * surface.albedo;
            let mut path = Path { throughput, from: surface.start, normal: surface.normal, ..path };
            if throughput == Vec3::ZERO {
                continue;
            }
            let (seed, index) = (path.seed, path.index);
            let point = |part| random(seed, index, reflections, part);
            if self.emission.strategies()[1] {
                let direction = self.emission.direction(point(Use::Distant));
                let cos = surface.normal.dot(direction);
                if cos > 0.0 && !(self.upper_sky && direction.z < 0.0) {
                    let (radiance, density) = self.emission.look(direction);
                    let value = radiance * cos * FRAC_1_PI / (density + CosineLobe::density(cos));
                    shadow_rays.push(Ray { origin: surface.start, direction, t_min: 0.0, t_max: f32::INFINITY });
                    light.push((path.batch, path.share * throughput * value));
                }
            }
            if !self.emitters.is_empty() {
                self.emitters.weigh(surface.start, surface.normal, weights);
                if let Some(towards) = self.emitters.sample(weights, surface.start, point(Use::Emitter)) {
                    let (direction, cos) = (towards.direction, surface.normal.dot(towards.direction));
                    if cos > 0.0 {
                        let other = if towards.solid { CosineLobe::density(cos) } else { 0.0 };
                        let value = towards.radiance * cos * FRAC_1_PI / (towards.density + other);
                        shadow_rays.push(Ray { origin: surface.start, direction, t_min: 0.0, t_max: towards.distance });
                        light.push((path.batch, path.share * throughput * value));
                    }
                }
            }
            if reflections > SURE {
                let survival = throughput.max_element().min(0.95);
                if point(Use::Roulette)[0] >= survival {
                    continue;
                }
                path.throughput = throughput / survival;
            }
            let direction = CosineLobe::new(surface.normal).direction(point(Use::Lobe));
            if surface.normal.dot(direction) > 0.0 {
                rays.push(Ray { origin: surface.start, direction, t_min: 0.0, t_max: f32::INFINITY });
                paths.push(path);
            }
        }
    }

    /// Traces the shadow rays and adds what is not blocked.
    fn connect(&self, front: &mut Front, batches: &mut Batches) {
        front.blocked.clear();
        front.blocked.resize(front.shadow_rays.len(), false);
        self.traced.world.occluded(&front.shadow_rays, &mut front.blocked);
        batches.count(front.shadow_rays.len());
        for ((batch, value), blocked) in front.light.iter().zip(&front.blocked) {
            if !blocked && value.is_finite() {
                batches.add(*batch, *value);
            }
        }
        front.shadow_rays.clear();
        front.light.clear();
    }

    /// Distant light along a ray of the cosine lobe, weighed against sampling the lights.
    fn distant(&self, path: &Path, ray: &Ray) -> Vec3 {
        if self.upper_sky && ray.direction.z < 0.0 {
            return Vec3::ZERO;
        }
        let (radiance, density) = self.emission.look(ray.direction);
        let own = CosineLobe::density(path.normal.dot(ray.direction));
        if self.emission.strategies()[1] { radiance * (own / (own + density)) } else { radiance }
    }

    /// Emitted light along a ray of the cosine lobe, weighed against sampling the emitters.
    fn emitted(&self, path: &Path, ray: &Ray, surface: &Surface, weights: &mut Weights) -> Vec3 {
        self.emitters.weigh(path.from, path.normal, weights);
        let density = self.emitters.density(weights, path.from, surface.object, surface.primitive);
        let own = CosineLobe::density(path.normal.dot(ray.direction));
        surface.emission * (own / (own + density))
    }
}

fn add(batches: &mut Batches, path: &Path, light: Vec3) {
    if light != Vec3::ZERO && light.is_finite() {
        batches.add(path.batch, path.share * path.throughput * light);
    }
}

/// Two random numbers for one use at one reflection, well spread over the batch.
fn random(seed: u64, index: u32, reflections: u32, part: Use) -> [f32; 2] {
    let dimension = 4 * u64::from(reflections) + part as u64;
    Sobol::new(mix(seed, dimension)).shuffled(index)
}
