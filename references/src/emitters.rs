//! Objects that emit: where their light comes from, how much of it there is, and where to look for it.

use glam::{DVec3, Vec3};
use halflight_scenes::{Mesh, Rgb, Shape, Sphere};

use crate::analytic;
use crate::sampling::{SphereSampler, TriangleSampler, luminance};
use crate::traced::Traced;

/// The spheres and triangles that emit.
pub(crate) struct Emitters {
    all: Vec<Emitter>,
    /// Cumulative power, from 0 to 1, by which one of many is chosen.
    by_power: Vec<f64>,
}

/// A sphere or triangle that emits from its front.
pub(crate) struct Emitter {
    form: Form,
    radiance: Rgb,
    object: u32,
    primitive: u32,
    /// Whether rays can hit it.
    solid: bool,
}

enum Form {
    Sphere(Sphere),
    Triangle([Vec3; 3]),
}

/// Up to so many are weighed at each point by what they bring there with nothing in the way, which is all but the best that can
/// be done; more would cost more than the rays that they save.
const FEW: usize = 32;

/// A sampled direction towards an emitter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Towards {
    pub(crate) direction: Vec3,
    /// As far as a ray may go before it meets the emitter itself.
    pub(crate) distance: f32,
    pub(crate) radiance: Rgb,
    /// A steradian, the choice of the emitter counted.
    pub(crate) density: f32,
    /// Whether a ray in this direction could hit it.
    pub(crate) solid: bool,
}

/// How likely each emitter is to be chosen at a point; see [`Emitters::weigh`].
#[derive(Clone, Default)]
pub(crate) struct Weights {
    /// Cumulative, from 0 to 1; empty where the power decides.
    cumulative: Vec<f64>,
}

/// Rays end short of the emitter by this share of the way, so as not to meet it: what stands closer to a lamp than that
/// casts no shadow of it.
const SHORT: f32 = 1e-4;

impl Emitters {
    pub(crate) fn new(traced: &Traced) -> Self {
        let mut all = Vec::new();
        for (object, shape, emission, solid) in traced.emitting() {
            let mut add = |primitive: u32, form| {
                let radiance = emission.of(primitive as usize);
                if radiance != Rgb::ZERO {
                    all.push(Emitter { form, radiance, object, primitive, solid });
                }
            };
            let mut triangles =
                |mesh: &Mesh| (0..mesh.triangles.len()).for_each(|i| add(i as u32, Form::Triangle(mesh.corners(i))));
            match shape {
                Shape::Mesh(mesh) => triangles(mesh),
                Shape::Heights(field) => triangles(field.mesh()),
                Shape::Spheres(spheres) => (0..).zip(spheres).for_each(|(i, sphere)| add(i, Form::Sphere(*sphere))),
            }
        }
        let by_power = cumulative(all.iter().map(Emitter::power));
        Emitters { all, by_power }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Whether what they bring with nothing in the way is known, and decides where to look.
    pub(crate) fn are_few(&self) -> bool {
        self.all.len() <= FEW
    }

    /// What a surface of albedo 1 reflects of their light with nothing in the way.
    pub(crate) fn open(&self, position: Vec3, normal: Vec3) -> DVec3 {
        self.all.iter().map(|emitter| emitter.open(position, normal)).sum()
    }

    /// Those of each object.
    pub(crate) fn objects(&self) -> impl Iterator<Item = &[Emitter]> {
        self.all.chunk_by(|a, b| a.object == b.object)
    }

    /// How likely each is chosen at a point: in proportion to what it brings there, or to its power if there are many.
    pub(crate) fn weigh(&self, position: Vec3, normal: Vec3, weights: &mut Weights) {
        weights.cumulative.clear();
        if self.are_few() {
            let brought = |emitter: &Emitter| emitter.share(position, normal) * luminance(emitter.radiance);
            accumulate(self.all.iter().map(brought), &mut weights.cumulative);
        }
    }

    /// Chooses an emitter, then a direction towards it; `None` if no light comes from it.
    pub(crate) fn sample(&self, weights: &Weights, position: Vec3, [u, v]: [f32; 2]) -> Option<Towards> {
        let (index, rest, chance) = choose(self.chances(weights), u)?;
        let emitter = &self.all[index];
        let (direction, distance, solid_angle) = emitter.direction(position, [rest, v])?;
        let density = chance as f32 / solid_angle;
        let distance = distance * (1.0 - SHORT);
        Some(Towards { direction, distance, radiance: emitter.radiance, density, solid: emitter.solid })
    }

    /// The density a steradian with which [`Emitters::sample`] looks from a point towards a point of this primitive.
    pub(crate) fn density(&self, weights: &Weights, position: Vec3, object: u32, primitive: u32) -> f32 {
        let found = self.all.binary_search_by_key(&(object, primitive), |emitter| (emitter.object, emitter.primitive));
        let Ok(index) = found else { return 0.0 };
        let cumulative = self.chances(weights);
        let low = if index == 0 { 0.0 } else { cumulative[index - 1] };
        match self.all[index].solid_angle(position) {
            Some(solid_angle) => (cumulative[index] - low) as f32 / solid_angle,
            None => 0.0,
        }
    }

    fn chances<'w>(&'w self, weights: &'w Weights) -> &'w [f64] {
        if self.are_few() { &weights.cumulative } else { &self.by_power }
    }
}

impl Emitter {
    /// `π · area · luminance`.
    fn power(&self) -> f64 {
        self.area() * luminance(self.radiance) * std::f64::consts::PI
    }

    fn area(&self) -> f64 {
        match &self.form {
            Form::Sphere(sphere) => 4.0 * std::f64::consts::PI * f64::from(sphere.radius).powi(2),
            Form::Triangle([a, b, c]) => 0.5 * (*b - *a).as_dvec3().cross((*c - *a).as_dvec3()).length(),
        }
    }

    /// What a surface of albedo 1 reflects of its light with nothing in the way.
    pub(crate) fn open(&self, position: Vec3, normal: Vec3) -> DVec3 {
        self.share(position, normal) * self.radiance.as_dvec3()
    }

    /// `1/π ∫ max(0, n·ω) dω` over the directions in which a point sees its front.
    fn share(&self, position: Vec3, normal: Vec3) -> f64 {
        let (position, normal) = (position.as_dvec3(), normal.as_dvec3());
        match &self.form {
            Form::Sphere(sphere) => {
                let to = sphere.center.as_dvec3() - position;
                let distance = to.length() / f64::from(sphere.radius);
                let angle = to.cross(normal).length().atan2(to.dot(normal));
                if distance > 1.0 { analytic::sphere_over_receiver(distance, angle) } else { 0.0 }
            }
            Form::Triangle(corners) => {
                let corners = corners.map(|corner| corner.as_dvec3() - position);
                if !faces(&corners) {
                    return 0.0;
                }
                analytic::polygon_over_receiver(&corners, normal)
            }
        }
    }

    /// Direction, distance to the surface and the solid angle within which directions are uniform.
    fn direction(&self, position: Vec3, point: [f32; 2]) -> Option<(Vec3, f32, f32)> {
        match &self.form {
            Form::Sphere(sphere) => {
                let sampler = SphereSampler::new(sphere.center, sphere.radius, position)?;
                let direction = sampler.direction(point);
                Some((direction, sampler.distance(direction), sampler.solid_angle()))
            }
            Form::Triangle(corners) => {
                if !faces(&corners.map(|corner| (corner - position).as_dvec3())) {
                    return None;
                }
                let sampler = TriangleSampler::new(*corners, position)?;
                let direction = sampler.direction(point);
                Some((direction, sampler.distance(direction), sampler.solid_angle()))
            }
        }
    }

    fn solid_angle(&self, position: Vec3) -> Option<f32> {
        match &self.form {
            Form::Sphere(sphere) => {
                SphereSampler::new(sphere.center, sphere.radius, position).map(|sampler| sampler.solid_angle())
            }
            Form::Triangle(corners) => TriangleSampler::new(*corners, position).map(|sampler| sampler.solid_angle()),
        }
    }
}

/// Points of one object that face a receiver: uniform by area over triangles, by solid angle over each sphere.
pub(crate) struct Points<'e> {
    emitters: &'e [Emitter],
    from: Vec3,
    cumulative: Vec<f64>,
}

impl<'e> Points<'e> {
    pub(crate) fn new(emitters: &'e [Emitter], from: Vec3) -> Self {
        let facing = |emitter: &Emitter| match &emitter.form {
            Form::Triangle(corners) if !faces(&corners.map(|corner| (corner - from).as_dvec3())) => 0.0,
            _ => emitter.area(),
        };
        Points { emitters, from, cumulative: cumulative(emitters.iter().map(facing)) }
    }

    /// Direction towards a point, and how far a ray may go before it meets it.
    pub(crate) fn towards(&self, [u, v]: [f32; 2]) -> Option<(Vec3, f32)> {
        let (index, rest, _) = choose(&self.cumulative, u)?;
        let emitter = &self.emitters[index];
        let Form::Triangle([a, b, c]) = &emitter.form else {
            let (direction, distance, _) = emitter.direction(self.from, [rest, v])?;
            return Some((direction, distance * (1.0 - SHORT)));
        };
        let root = rest.sqrt();
        let to = *a + root * ((1.0 - v) * (*b - *a) + v * (*c - *a)) - self.from;
        let distance = to.length();
        (distance > 0.0).then(|| (to / distance, distance * (1.0 - SHORT)))
    }
}

/// An interval of cumulative chances, where in it a uniform number lies, and its width; `None` if all chances are 0.
fn choose(cumulative: &[f64], u: f32) -> Option<(usize, f32, f64)> {
    if cumulative.last().is_none_or(|total| *total == 0.0) {
        return None;
    }
    let u = f64::from(u);
    let index = cumulative.partition_point(|edge| *edge <= u).min(cumulative.len() - 1);
    let low = if index == 0 { 0.0 } else { cumulative[index - 1] };
    let width = cumulative[index] - low;
    let rest = ((u - low) / width) as f32;
    Some((index, rest.clamp(f32::EPSILON, 1.0 - f32::EPSILON), width))
}

/// Whether the origin lies in front of a triangle, whose corners run anticlockwise seen from there.
fn faces([a, b, c]: &[DVec3; 3]) -> bool {
    (*b - *a).cross(*c - *a).dot(*a) < 0.0
}

fn cumulative(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums = Vec::new();
    accumulate(values, &mut sums);
    sums
}

/// Cumulative sums, the last of them 1, or all 0.
fn accumulate(values: impl Iterator<Item = f64>, sums: &mut Vec<f64>) {
    let mut total = 0.0;
    sums.extend(values.map(|value| {
        total += value.max(0.0);
        total
    }));
    if total > 0.0 {
        sums.iter_mut().for_each(|sum| *sum /= total);
    }
}
