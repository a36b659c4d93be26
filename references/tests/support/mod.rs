//! Small scenes built in code.
#![allow(dead_code, reason = "every test file uses some of it")]

use std::sync::Arc;

use glam::{Vec2, Vec3};
use halflight_contract::{Cache, NoMeter, Quantity};
use halflight_references::{Error, Estimate, Quality, Reference, Request, estimate};
use halflight_scenes::{
    Bodies, Content, DistantLight, Emission, Environment, KeyLight, Light, Mesh, Object, Placement, Rgb, Scene, Shape,
    Sky, Sphere,
};

pub(crate) fn scene(objects: Vec<Object>, lights: Vec<Light>, points: &[(Vec3, Vec3)]) -> Scene {
    Scene {
        name: "built".into(),
        purpose: "a test".into(),
        content: Content::of(b"built"),
        objects,
        lights: lights.into_iter().map(DistantLight::from).collect(),
        camera: None,
        placement: Placement::Points(Arc::new(points.to_vec())),
        frame_count: 1,
        fps: 1.0,
        notices: Vec::new(),
        bodies: Bodies::default(),
    }
}

pub(crate) fn object(shape: Shape) -> Object {
    let content = shape.content();
    Object {
        name: "object".into(),
        shape: Arc::new(shape),
        content,
        albedo: Rgb::ONE,
        texture: None,
        emission: Emission::NONE,
        casts: true,
        motion: Vec::new(),
        pivot: Vec3::ZERO,
        deformation: None,
    }
}

pub(crate) fn spheres(spheres: &[(Vec3, f32)]) -> Object {
    object(Shape::Spheres(spheres.iter().map(|(center, radius)| Sphere { center: *center, radius: *radius }).collect()))
}

/// A closed ball of triangles, its faces outwards.
pub(crate) fn ball(center: Vec3, radius: f32, rings: usize) -> Object {
    let mut mesh = Mesh::default();
    let columns = 2 * rings;
    for ring in 0..=rings {
        for column in 0..columns {
            let theta = std::f32::consts::PI * ring as f32 / rings as f32;
            let phi = std::f32::consts::TAU * column as f32 / columns as f32;
            let z = if ring == rings { -1.0 } else { theta.cos() };
            let rim = if ring == rings { 0.0 } else { theta.sin() };
            let normal = Vec3::new(rim * phi.cos(), rim * phi.sin(), z);
            mesh.positions.push(center + radius * normal);
            mesh.normals.push(normal);
        }
    }
    let at = |ring: usize, column: usize| (ring * columns + column % columns) as u32;
    for ring in 0..rings {
        for column in 0..columns {
            let [a, b] = [at(ring, column), at(ring, column + 1)];
            let [c, d] = [at(ring + 1, column), at(ring + 1, column + 1)];
            if ring > 0 {
                mesh.triangles.push([a, d, b]);
            }
            if ring + 1 < rings {
                mesh.triangles.push([a, c, d]);
            }
        }
    }
    object(Shape::Mesh(mesh))
}

/// A horizontal square of two triangles.
pub(crate) fn plate(height: f32, half: f32) -> Object {
    let corner = |x: f32, y: f32| Vec3::new(half * x, half * y, height);
    object(Shape::Mesh(Mesh {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        normals: vec![Vec3::Z; 4],
        uvs: Vec::<Vec2>::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }))
}

pub(crate) fn sky(radiance: f32) -> Light {
    Light::Sky(Sky::Uniform(Rgb::splat(radiance)))
}

pub(crate) fn map(width: usize, height: usize, texel: impl Fn(usize, usize) -> Rgb) -> Light {
    let texels = (0..width * height).map(|i| texel(i % width, i / width)).collect();
    Light::Environment(Environment { width, height, texels: Arc::new(texels), rotation: 0.0 })
}

pub(crate) fn key(direction: Vec3, angular_radius: f32, radiance: f32) -> Light {
    Light::Key(KeyLight { direction: direction.normalize(), angular_radius, radiance: Rgb::splat(radiance) })
}

/// Normals well spread over the sphere.
pub(crate) fn normals(count: usize) -> Vec<Vec3> {
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let (sin, cos) = (2.399_963_229_728_653 * i as f64).sin_cos();
            let rim = (1.0 - z * z).sqrt();
            Vec3::new((rim * cos) as f32, (rim * sin) as f32, z as f32).normalize()
        })
        .collect()
}

/// A reference of direct light.
pub(crate) fn run(reference: &str, scene: &Scene, quality: &Quality, seed: u64) -> Estimate {
    run_of(Quantity::Direct, reference, scene, quality, seed).expect("an estimate")
}

pub(crate) fn run_of(
    quantity: Quantity,
    reference: &str,
    scene: &Scene,
    quality: &Quality,
    seed: u64,
) -> Result<Estimate, Error> {
    let reference = &Reference::parse(reference).expect("a reference");
    let request = Request { reference, quantity, scene, frame: &scene.frame(0), quality, seed };
    estimate(&request, &Cache::in_memory(), &mut NoMeter)
}
