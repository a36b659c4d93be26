//! Any number of spheres and receivers, of any size and anywhere.

use std::sync::Arc;

use glam::Vec3;
use halflight_contract::{Backend, Quantity};
use halflight_scenes::{Light, Placement, Rgb, Scene, Sky, Sphere};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

use super::{Seen, apart, tolerance, tuned};
use crate::on;

fn wave(i: usize, phase: f32) -> f32 {
    (i as f32 * 2.399 + phase).sin()
}

fn direction(i: usize) -> Vec3 {
    Vec3::new(wave(i, 0.1), wave(3 * i, 1.0), wave(5 * i, 2.0)).normalize()
}

fn scene(spheres: Vec<Sphere>, points: Vec<(Vec3, Vec3)>) -> Scene {
    let objects = if spheres.is_empty() { Vec::new() } else { vec![fixtures::spheres("spheres", spheres)] };
    let lights = vec![Light::Sky(Sky::Uniform(Rgb::ONE))];
    fixtures::scene("stress", objects, lights, Placement::Points(Arc::new(points)))
}

/// Spheres of 1e-6 to 1e6 and what lies inside, tangent and at the centre of each.
fn sizes() -> Scene {
    let sphere = |i: usize| {
        let radius = 10f32.powi(i as i32 - 6);
        fixtures::sphere((2.0 * radius + i as f32) * direction(i), radius)
    };
    let spheres: Vec<Sphere> = (0..=12).map(sphere).collect();
    let around = |s: &Sphere| [0.0, 0.5, 1.0, 1.5].map(|share| s.center + share * s.radius * Vec3::X);
    let places = spheres.iter().flat_map(around);
    let points = places.flat_map(|p| [Vec3::X, -Vec3::X, Vec3::Z].map(|n| (p, n))).collect();
    scene(spheres, points)
}

/// So many small spheres over a few receivers.
fn crowd(count: usize) -> Scene {
    let sphere = |i: usize| {
        let up = direction(i).abs() + 0.05 * Vec3::Z;
        fixtures::sphere((2.0 + wave(i, 4.0)) * up, 0.002 + 0.008 * wave(7 * i, 3.0).abs())
    };
    let points = (0..70).map(|i| (0.5 * Vec3::new(wave(i, 5.0), wave(2 * i, 6.0), 0.0), Vec3::Z)).collect();
    scene((0..count).map(sphere).collect(), points)
}

/// (method, settings)
const METHODS: [(&str, &str); 3] =
    [("sh-product/ordered", "order=4"), ("shexp/hyb", "order=3"), ("shexp/hyb", "order=2 cut=20")];

/// Fails where the GPU's values are not finite, or further from the CPU's than roundings bring them.
fn alike(scene: &Scene, (id, settings): (&str, &str)) {
    let method = halflight_registry::find(id).expect("it is registered");
    let params = tuned(method, settings);
    let seen = Seen::of(scene);
    let allowed = tolerance(params.int("order") as u8, seen);
    let case = Case::new(method, scene, Quantity::Direct).tuned(params);
    let (gpu, largest) = (on(Backend::GPU, &case), apart(&case));
    println!("{id} {settings} {}: {largest:.1e} apart, {allowed:.1e} allowed", seen.circles);
    assert!(gpu.iter().all(|value| value.is_finite()), "{id} {settings}, {} spheres", seen.circles);
    assert!(largest <= allowed, "{id} {settings} {}: {largest:e} > {allowed:e}", seen.circles);
}

#[test]
fn any_number_of_spheres_is_finite_and_alike() {
    for (count, method) in [0, 1, 100, 10_000].into_iter().flat_map(|count| METHODS.map(|method| (count, method))) {
        alike(&crowd(count), method);
    }
}

#[test]
fn any_size_of_spheres_is_finite_and_alike() {
    METHODS.into_iter().for_each(|method| alike(&sizes(), method));
}

#[test]
fn no_receivers_are_no_trouble() {
    let scene = scene(vec![fixtures::sphere(Vec3::Z, 0.5)], Vec::new());
    for (id, settings) in METHODS {
        let method = halflight_registry::find(id).expect("it is registered");
        let case = Case::new(method, &scene, Quantity::Direct).tuned(tuned(method, settings));
        assert_eq!(on(Backend::GPU, &case), on(Backend::Cpu, &case));
    }
}

/// Lavapipe ends longer loops without a word.
#[test]
fn more_spheres_than_an_adapter_gets_through_are_an_error() {
    for (count, id, order) in [(70_000, "shexp/hyb", 2), (20_000, "sh-product/ordered", 4)] {
        let (scene, settings) = (crowd(count), format!("order={order}"));
        let method = halflight_registry::find(id).expect("it is registered");
        let case = Case::new(method, &scene, Quantity::Direct).tuned(tuned(method, &settings));
        let gpu = Case { backend: Backend::GPU, ..case.asking(Quantity::Direct) };
        match gpu.fresh(&gpu.frames[0]) {
            Ok(_) => alike(&scene, (id, &settings)),
            Err(error) => assert!(error.to_string().contains(&format!("{count} spheres")), "{error}"),
        }
    }
}
