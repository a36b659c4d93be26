//! The posed scene as rays see it.

use std::sync::Arc;

use glam::Vec3;
use halflight_scenes::{Emission, Frame, Mesh, Pose, PosedObject, Rgb, Scene, Shape, Texture, Which};
use halflight_trace::{Hit, Ray, World, clearance, clearance_of_point};

use crate::Reference;

/// All that takes part in light transport, posed.
pub(crate) struct Traced {
    /// The objects that cast shadows; a hit names its object by the scene's index.
    pub(crate) world: World,
    objects: Vec<Body>,
}

/// An object, also one that no ray can hit.
struct Body {
    shape: Arc<Shape>,
    casts: bool,
    /// The farthest from the origin that it gets.
    reach: f32,
    albedo: Rgb,
    texture: Option<Texture>,
    emission: Emission,
}

/// Where a ray has hit something.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Where a ray that leaves on the seen side starts.
    pub(crate) start: Vec3,
    /// Unit geometric normal on the seen side.
    pub(crate) normal: Vec3,
    /// Whether the front is seen.
    pub(crate) front: bool,
    pub(crate) object: u32,
    pub(crate) primitive: u32,
    pub(crate) albedo: Rgb,
    /// Radiance towards the seen side.
    pub(crate) emission: Rgb,
}

/// Rays leave a height field straight up, where there is nothing more of it: the way along a normal may lead into the far side of
/// a steep pit. They start as far from the surface as along its normal, if that rises by at least this (slopes up to 86°).
const STEEPEST: f32 = 1.0 / 16.0;

impl Traced {
    pub(crate) fn new(scene: &Scene, frame: &Frame, reference: &Reference) -> Self {
        let body = |posed: &PosedObject| {
            let object = &scene.objects[posed.object];
            let left_out = reference.leaves_out(&object.name);
            Body {
                shape: match posed.pose == Pose::IDENTITY {
                    true => posed.shape.clone(),
                    false => Arc::new(posed.in_place().into_owned()),
                },
                casts: object.casts,
                reach: reach(&posed.shape) + posed.pose.translation.length(),
                albedo: if left_out { Rgb::ZERO } else { object.albedo },
                texture: object.texture.clone(),
                emission: if left_out { Emission::NONE } else { object.emission.clone() },
            }
        };
        Traced { world: scene.world(frame, Which::Casters), objects: frame.objects.iter().map(body).collect() }
    }

    /// Where rays start that leave a point of an object, if it is known to lie on one, on the side of the normal.
    pub(crate) fn lift(&self, object: Option<u32>, position: Vec3, normal: Vec3) -> Vec3 {
        let offset = match object.map(|object| &self.objects[object as usize]) {
            Some(body) if body.casts => clearance(body.reach) * off(&body.shape, normal),
            // What no ray can hit is in no ray's way.
            Some(_) => Vec3::ZERO,
            None => clearance_of_point(position) * normal,
        };
        position + offset
    }

    /// What a ray has hit.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let body = &self.objects[hit.geometry as usize];
        let (position, outwards) = match &*body.shape {
            Shape::Mesh(mesh) => on_mesh(mesh, hit),
            Shape::Heights(field) => on_mesh(field.mesh(), hit),
            Shape::Spheres(spheres) => {
                let sphere = spheres[hit.primitive as usize];
                let outwards = (ray.origin + hit.t * ray.direction - sphere.center).normalize();
                (sphere.center + sphere.radius * outwards, outwards)
            }
        };
        let front = outwards.dot(ray.direction) < 0.0;
        let normal = if front { outwards } else { -outwards };
        Surface {
            start: self.lift(Some(hit.geometry), position, normal),
            normal,
            front,
            object: hit.geometry,
            primitive: hit.primitive,
            albedo: body.albedo_at(hit),
            emission: if front { body.emission.of(hit.primitive as usize) } else { Rgb::ZERO },
        }
    }

    /// Objects that emit: index, shape, radiance, and whether rays can hit them.
    pub(crate) fn emitting(&self) -> impl Iterator<Item = (u32, &Shape, &Emission, bool)> {
        let all = (0..).zip(&self.objects).filter(|(_, body)| !body.emission.is_none());
        all.map(|(index, body)| (index, &*body.shape, &body.emission, body.casts))
    }
}

impl Body {
    fn albedo_at(&self, hit: &Hit) -> Rgb {
        match (&self.texture, &*self.shape) {
            (Some(texture), Shape::Mesh(mesh)) => {
                self.albedo * texture.at(mesh.uv(hit.primitive as usize, hit.barycentrics))
            }
            _ => self.albedo,
        }
    }
}

/// The way off a shape on the side of a normal, of which a unit leads a unit away from the tangent plane.
fn off(shape: &Shape, normal: Vec3) -> Vec3 {
    match shape {
        Shape::Heights(_) => Vec3::Z / normal.z.abs().max(STEEPEST).copysign(normal.z),
        _ => normal,
    }
}

/// Position and unit normal outwards.
fn on_mesh(mesh: &Mesh, hit: &Hit) -> (Vec3, Vec3) {
    let [a, b, c] = mesh.corners(hit.primitive as usize);
    let [u, v] = hit.barycentrics;
    (a + u * (b - a) + v * (c - a), mesh.face_normal(hit.primitive as usize))
}

/// The farthest from the origin that a shape gets.
fn reach(shape: &Shape) -> f32 {
    let farthest = |positions: &[Vec3]| positions.iter().map(|p| p.length()).fold(0.0, f32::max);
    match shape {
        Shape::Mesh(mesh) => farthest(&mesh.positions),
        Shape::Heights(field) => farthest(&field.mesh().positions),
        Shape::Spheres(spheres) => spheres.iter().map(|s| s.center.length() + s.radius).fold(0.0, f32::max),
    }
}
