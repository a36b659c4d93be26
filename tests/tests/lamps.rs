//! Spheres that emit, as sphere-blocker methods light receivers by them: against band sums in f64 and closed forms.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use halflight_contract::{Method, Params, Quantity};
use halflight_scenes::{Emission, Object, Placement, Rgb, Scene, Sphere};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

const LAMP: Sphere = Sphere { center: Vec3::new(0.2, -0.3, 1.1), radius: 0.25 };
const RADIANCE: Rgb = Rgb::new(3.0, 2.0, 5.0);

fn lamp(sphere: Sphere) -> Object {
    Object { emission: Emission::Even(RADIANCE), ..fixtures::spheres("lamp", vec![sphere]) }
}

fn scene(objects: Vec<Object>, points: Vec<(Vec3, Vec3)>) -> Scene {
    fixtures::scene("lamps", objects, Vec::new(), Placement::Points(Arc::new(points)))
}

/// Points around the lamp, near and far, their normals at all angles to it.
fn points() -> Vec<(Vec3, Vec3)> {
    let wave = |i: usize, phase: f32| (2.4 * i as f32 + phase).sin();
    let direction =
        |i, phase| Vec3::new(wave(i, phase), wave(3 * i, phase + 1.0), wave(5 * i, phase + 2.0)).normalize();
    (0..200)
        .map(|i| {
            (
                LAMP.center + LAMP.radius * (1.02 + 40.0 * wave(7 * i, 0.5).powi(8)) * direction(i, 0.1),
                direction(i, 3.0),
            )
        })
        .collect()
}

/// P_l at x by Bonnet's recurrence.
fn legendre(l: usize, x: f64) -> f64 {
    let (mut below, mut p) = (0.0, 1.0);
    for l in 0..l {
        (below, p) = (p, ((2 * l + 1) as f64 * x * p - l as f64 * below) / (l + 1) as f64);
    }
    p
}

/// Simpson's rule.
fn integral(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let steps = 2000;
    let at = |i: usize| f(low + (high - low) * i as f64 / steps as f64);
    let weight = |i: usize| if i == 0 || i == steps { 1.0 } else { (2 + 2 * (i % 2)) as f64 };
    (0..=steps).map(|i| weight(i) * at(i)).sum::<f64>() * (high - low) / (3 * steps) as f64
}

/// `Σ h_l L_l P_l(cos γ)`, the light of the truncated lamp through the truncated cosine.
fn band_sum(order: usize, position: Vec3, normal: Vec3, sphere: Sphere) -> f64 {
    let to = (sphere.center - position).as_dvec3();
    let sine = f64::from(sphere.radius) / to.length();
    let height = sine * sine / (1.0 + (1.0 - sine * sine).sqrt());
    let cosine: f64 = to.normalize().dot(normal.as_dvec3());
    let band = |l: usize| {
        let norm = PI * (2 * l + 1) as f64; // (2π)²(2l + 1)/4π
        let clamped = integral(0.0, 1.0, |x| x * legendre(l, x)) / PI;
        norm * clamped * integral(0.0, height, |h| legendre(l, 1.0 - h)) * legendre(l, cosine)
    };
    (0..order).map(band).sum()
}

fn methods() -> impl Iterator<Item = &'static dyn Method> {
    halflight_registry::methods().into_iter().filter(|m| m.info().params.iter().any(|p| p.name == "local-lights"))
}

fn radiance(method: &'static dyn Method, scene: &Scene, settings: &[(&str, &str)]) -> Vec<Rgb> {
    let params = Params::resolve(method.info().params, settings.iter().copied()).expect("in range");
    let case = Case::new(method, scene, Quantity::Direct).tuned(params);
    assert!(case.is_supported(), "{}", method.info().id);
    let values = case.fresh(&case.frames[0]).expect("it runs");
    values.chunks_exact(3).map(Rgb::from_slice).collect()
}

#[test]
fn lamps_in_the_open_are_their_band_sums_at_every_order() {
    let scene = scene(vec![lamp(LAMP)], points());
    for order in 1..=8 {
        let expected: Vec<f64> = points().iter().map(|(p, n)| band_sum(order, *p, *n, LAMP)).collect();
        for method in methods() {
            let found = radiance(method, &scene, &[("order", &order.to_string()), ("guard", "false")]);
            for (found, expected) in found.iter().zip(&expected) {
                let scale = expected.abs().max(1e-4);
                for (found, radiance) in found.to_array().into_iter().zip(RADIANCE.to_array()) {
                    let error = (f64::from(found) / f64::from(radiance) - expected).abs() / scale;
                    assert!(error < 1e-3, "{} at order {order}: {found} for {expected}", method.info().id);
                }
            }
        }
    }
}

/// `sin²θ cos γ` of a lamp wholly above the horizon, down to the smallest.
#[test]
fn high_orders_come_close_to_the_closed_form() {
    for radius in [0.3, 1e-2, 1e-4] {
        let small = Sphere { radius, ..LAMP };
        let below: Vec<(Vec3, Vec3)> = (0..9).map(|i| (Vec3::new(0.1 * i as f32 - 0.4, 0.0, 0.0), Vec3::Z)).collect();
        let scene = scene(vec![lamp(small)], below.clone());
        for method in methods() {
            for (found, (position, _)) in radiance(method, &scene, &[("order", "8")]).iter().zip(&below) {
                let to: DVec3 = (small.center - *position).as_dvec3();
                let exact = f64::from(RADIANCE.x) * (f64::from(radius) / to.length()).powi(2) * to.normalize().z;
                assert!((f64::from(found.x) / exact - 1.0).abs() < 0.03, "{}: {found} for {exact}", method.info().id);
            }
        }
    }
}

#[test]
fn what_stands_before_a_lamp_shades_it_and_the_inside_is_dark() {
    let position = Vec3::new(0.2, -0.3, 0.0);
    let before = fixtures::spheres("ball", vec![Sphere { center: position + 0.5 * Vec3::Z, radius: 0.35 }]);
    let at = vec![(position, Vec3::Z), (LAMP.center + 0.1 * Vec3::X, Vec3::Z), (LAMP.center, Vec3::Z)];
    let (open, shaded) = (scene(vec![lamp(LAMP)], at.clone()), scene(vec![lamp(LAMP), before], at));
    for method in methods() {
        let id = method.info().id;
        let [open, shaded] = [&open, &shaded].map(|scene| radiance(method, scene, &[("order", "4")]));
        // Not 0: truncated visibility rings, and a lamp hears it at one place.
        assert!(shaded[0].x.abs() < 0.35 * open[0].x, "{id}: {} of {}", shaded[0], open[0]);
        assert_eq!(open[1..], [Rgb::ZERO; 2], "{id}");
    }
}
