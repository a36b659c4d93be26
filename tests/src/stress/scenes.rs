//! The scenes of the tables: white receivers under a uniform sky.

use std::sync::Arc;

use glam::Vec3;
use halflight_scenes::{Light, Placement, Rgb, Scene, Shape, Sky, Sphere};

use super::{ANGLE, RADIANCE};
use crate::fixtures;

fn scene(name: &str, spheres: Vec<Sphere>, points: Vec<(Vec3, Vec3)>, radiance: f32) -> Scene {
    let sky = vec![Light::Sky(Sky::Uniform(Rgb::splat(radiance)))];
    fixtures::scene(name, vec![fixtures::spheres(name, spheres)], sky, Placement::Points(Arc::new(points)))
}

/// So many equal spheres overhead of one receiver.
pub(super) fn coincident(count: usize) -> Scene {
    let sphere = fixtures::sphere(Vec3::Z, ANGLE.to_radians().sin());
    scene(&format!("coincident {count}"), vec![sphere; count], vec![(Vec3::ZERO, Vec3::Z)], 1.0)
}

/// Scenes that are told of together.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) scenes: Vec<Scene>,
    /// What receivers get of the open sky's irradiance; nothing where rules say what a sphere around a receiver means.
    pub(super) truth: Option<Vec<f64>>,
}

pub(super) fn cases() -> [Case; 3] {
    let traced = |name, scene: Scene| Case { name, truth: Some(irradiance(&scene)), scenes: vec![scene] };
    let touching = [1e-6, 1e-3, 1.0, 1e3, 1e6].map(touching).to_vec();
    [
        traced("10 000 overlapping spheres", crowd()),
        Case { name: "at centres, inside, tangent, outside; radii 1e-6 to 1e6", scenes: touching, truth: None },
        traced("umbra of 2 000 spheres of 20°", umbra()),
    ]
}

/// Directions a side of the square that is mapped to the hemisphere.
const RAYS: usize = 48;

/// The share of directions, dense as the cosine, that no sphere blocks before each receiver.
fn irradiance(scene: &Scene) -> Vec<f64> {
    let frame = scene.frame(0);
    let spheres = frame.objects.iter().flat_map(|posed| match &*posed.in_place() {
        Shape::Spheres(spheres) => spheres.clone(),
        _ => Vec::new(),
    });
    let spheres: Vec<Sphere> = spheres.collect();
    let open = |position: Vec3, normal: Vec3| {
        let (x, y) = normal.any_orthonormal_pair();
        let cell = |i: usize| (i as f32 + 0.5) / RAYS as f32;
        let free = |ray: &usize| {
            let (out, turn) = (cell(ray / RAYS).sqrt(), std::f32::consts::TAU * cell(ray % RAYS));
            let towards = out * (turn.cos() * x + turn.sin() * y) + (1.0 - out * out).sqrt() * normal;
            !spheres.iter().any(|sphere| hits(sphere, position, towards))
        };
        (0..RAYS * RAYS).filter(free).count() as f64 / (RAYS * RAYS) as f64
    };
    frame.receivers.position.iter().zip(&frame.receivers.normal).map(|(p, n)| open(*p, *n)).collect()
}

fn hits(sphere: &Sphere, from: Vec3, towards: Vec3) -> bool {
    let to = sphere.center - from;
    let (along, outside) = (to.dot(towards), to.length_squared() - sphere.radius * sphere.radius);
    outside <= 0.0 || (along > 0.0 && along * along >= outside)
}

fn wave(i: usize, phase: f32) -> f32 {
    (2.399 * i as f32 + phase).sin()
}

fn direction(i: usize, phase: f32) -> Vec3 {
    Vec3::new(wave(i, phase), wave(3 * i, phase + 1.0), wave(7 * i, phase + 2.0)).normalize()
}

fn crowd() -> Scene {
    let center = |i: usize| Vec3::new(wave(i, 0.0), wave(3 * i, 1.0), wave(7 * i, 2.0));
    let spheres = (0..10_000).map(|i| fixtures::sphere(center(i), 0.02 + 0.3 * wave(5 * i, 3.0).abs())).collect();
    let points = (0..16).map(|i| ((0.5 + 0.2 * i as f32) * direction(i, 0.5), direction(i, 4.0))).collect();
    scene("crowd", spheres, points, RADIANCE)
}

fn touching(radius: f32) -> Scene {
    let center = Vec3::new(0.5 * radius, -radius, 2.0 * radius);
    let spheres = vec![
        fixtures::sphere(center, radius),
        fixtures::sphere(center + 0.3 * radius * Vec3::X, radius),
        fixtures::sphere(center - 1.5 * radius * Vec3::Y, 0.7 * radius),
    ];
    let distances = [0.0, 1e-6, 0.5, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.001, 3.0, 1e3, 1e9];
    let normals = [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, 0.8)];
    let place =
        |distance: f32, k: usize| center + distance * radius * if k == 0 { -Vec3::Z } else { direction(k, 0.3) };
    let places = distances.into_iter().flat_map(|distance| [0, 1].map(|k| place(distance, k)));
    let points = places.flat_map(|place| normals.map(|normal| (place, normal))).collect();
    scene(&format!("touching {radius}"), spheres, points, RADIANCE)
}

fn umbra() -> Scene {
    let sphere = |i: usize| {
        let up = direction(i, 0.7);
        fixtures::sphere(10.0 * Vec3::new(up.x, up.y, up.z.abs()), 10.0 * 20f32.to_radians().sin())
    };
    let points = (0..16).map(|i| (0.01 * direction(i, 1.5), Vec3::Z)).collect();
    scene("umbra", (0..2_000).map(sphere).collect(), points, RADIANCE)
}
