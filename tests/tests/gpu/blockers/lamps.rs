//! Lamps, alone and beside distant light.

use glam::Vec3;
use halflight_contract::Quantity;
use halflight_scenes::{Emission, Object, Rgb, Scene, Shape, Sphere};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

use super::{Seen, apart, count_alike, methods, tolerance, tuned};
use crate::ROUNDING;

/// Three lamps over two lights' spheres: near the ground, high, and far with next to nothing of a circle.
fn lamps() -> Scene {
    let lamp = |x, y, z, radius, radiance| {
        let spheres = vec![fixtures::sphere(Vec3::new(x, y, z), radius)];
        Object { emission: Emission::Even(radiance), ..fixtures::spheres("lamp", spheres) }
    };
    let mut scene = fixtures::two_lights();
    scene.objects.extend([
        lamp(1.2, -0.9, 0.15, 0.2, Rgb::new(3.0, 2.0, 1.0)),
        lamp(-0.4, 0.8, 2.5, 0.3, Rgb::new(8.0, 8.0, 9.0)),
        lamp(500.0, 0.0, 100.0, 0.01, Rgb::new(1e6, 1e6, 1e6)),
    ]);
    scene
}

/// The lamps of a scene with their largest radiance.
fn emitters(scene: &Scene) -> Vec<(Sphere, f32)> {
    let lamp = |object: &Object| match &*object.shape {
        Shape::Spheres(spheres) if object.emits() => Some((spheres[0], object.emission.of(0).max_element())),
        _ => None,
    };
    scene.objects.iter().filter_map(lamp).collect()
}

/// How far two backends may be apart at a receiver of albedo 1.
///
/// What lamps give is at most their radiance times `sin²θ` (shares: the guard holds them to [0, 1]), seen through visibilities that
/// are apart by their own tolerance. A share divides `Σ g·y·L` by the circle's integral `L₀`, and the norm of `L` is at most `n·L₀`;
/// turning, dot product and the closed form of the open lamp cost about 40 roundings, of which sines near 0 and 1 double some.
/// A lobe's table is entered by a tilt of the accuracy of an arc cosine, `u/sin tilt`, and at most √u; what it holds changes by at most
/// n a radian.
fn allowed(scene: &Scene, order: u8, lobes: bool, visibility: f32) -> f32 {
    let (frame, n) = (scene.frame(0), f32::from(order));
    let entry = if lobes { n * ROUNDING.sqrt() } else { 0.0 };
    let each = n * visibility + 2.0 * 40.0 * ROUNDING * n + entry;
    let one = |position: Vec3, (sphere, radiance): &(Sphere, f32)| {
        let distance = position.distance(sphere.center);
        if distance > sphere.radius { radiance * (sphere.radius / distance).powi(2) * each } else { 0.0 }
    };
    let lamps = emitters(scene);
    let at = |position: &Vec3| lamps.iter().map(|lamp| one(*position, lamp)).sum();
    frame.receivers.position.iter().map(at).fold(0.0, f32::max)
}

#[test]
fn backends_agree_on_lamps() {
    for scene in [fixtures::moving_lamp(), lamps()] {
        let seen = Seen::of(&scene);
        for (method, order) in methods().flat_map(|method| [2u8, 3].map(|order| (method, order))) {
            for settings in ["", "guard=false", "window-light=true", "lamps=lobe"] {
                let id = method.info().id;
                if order == 3 && (id != "sh-product/ordered" || !["", "lamps=lobe"].contains(&settings)) {
                    continue;
                }
                let visibility = tolerance(order, seen);
                let allowed = visibility + allowed(&scene, order, settings.contains("lobe"), visibility);
                let params = tuned(method, &format!("order={order} {settings}"));
                let largest = apart(&Case::new(method, &scene, Quantity::Direct).tuned(params));
                println!(
                    "{id} on {}, order {order} {settings}: {largest:.1e} apart, {allowed:.1e} allowed",
                    scene.name
                );
                assert!(largest <= allowed, "{id} on {}, {order} {settings}: {largest:e} > {allowed:e}", scene.name);
            }
        }
    }
}

/// At the centre, inside, next to the surface, straight below, beside, behind, and far away.
#[test]
fn lamps_are_finite_wherever_receivers_are() {
    let at = Vec3::new(0.2, -0.3, 1.1);
    let offsets = [0.0, 1e-30, 1e-3, 0.2499, 0.2501, 0.3, 1.0, 1e6, 1e18, 3e19, 1e25];
    let directions = [-Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, 0.8)];
    let places = offsets.iter().flat_map(|offset| directions.map(|d| at + *offset * d));
    let points = places.flat_map(|p| [Vec3::Z, -Vec3::Z, Vec3::Y].map(|n| (p, n))).collect();
    let lamp = |radius, radiance| Object {
        emission: Emission::Even(Rgb::splat(radiance)),
        ..fixtures::spheres("lamp", vec![fixtures::sphere(at, radius)])
    };
    let ball = fixtures::spheres("ball", vec![fixtures::sphere(at - Vec3::Z, 0.3)]);
    let objects = vec![lamp(0.25, 3.0), lamp(1e-6, 1e6), lamp(1e-25, 1.0), ball];
    let scene =
        fixtures::scene("lamps", objects, Vec::new(), halflight_scenes::Placement::Points(std::sync::Arc::new(points)));
    for id in ["sh-product/ordered", "shexp/hyb"] {
        let method = halflight_registry::find(id).expect("it is registered");
        for settings in ["order=2", "order=2 guard=false", "order=2 lamps=lobe"] {
            let case = Case::new(method, &scene, Quantity::Direct).tuned(tuned(method, settings));
            let largest = apart(&case);
            let visibility = tolerance(2, Seen::of(&scene));
            let allowed = visibility + allowed(&scene, 2, settings.contains("lobe"), visibility);
            println!("{id} {settings}: {largest:.1e} apart, {allowed:.1e} allowed");
            let gpu = crate::on(halflight_contract::Backend::GPU, &case);
            assert!(gpu.iter().all(|value| value.is_finite()), "{id} {settings}");
            assert!(largest <= allowed, "{id} {settings}: {largest:e} > {allowed:e}");
        }
    }
}

/// Lamps, distant light and cuts at once.
#[test]
fn both_backends_count_the_same_work_under_lamps() {
    for method in methods() {
        let has_cuts = method.info().params.iter().any(|spec| spec.name == "cut");
        let params = tuned(method, if has_cuts { "order=2 cut=30 cluster=16" } else { "order=2" });
        count_alike(method, &lamps(), &params);
        let seen = Seen::of(&lamps());
        let visibility = tolerance(2, seen);
        let largest = apart(&Case::new(method, &lamps(), Quantity::Direct).tuned(params));
        assert!(largest <= visibility + allowed(&lamps(), 2, false, visibility), "{}: {largest:e}", method.info().id);
    }
}
