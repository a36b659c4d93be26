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

/// `1/π ∫ max(0, n·ω) dω` over a lamp's circle, in rings about its middle.
fn integral(position: Vec3, normal: Vec3) -> f64 {
    let to: DVec3 = (LAMP.center - position).as_dvec3();
    let (angle, tilt) = ((f64::from(LAMP.radius) / to.length()).asin(), to.angle_between(normal.as_dvec3()));
    let (rings, turns) = (300, 300);
    let mut sum = 0.0;
    for cell in 0..rings * turns {
        let theta = (f64::from(cell / turns) + 0.5) / f64::from(rings) * angle;
        let phi = (f64::from(cell % turns) + 0.5) / f64::from(turns) * 2.0 * PI;
        sum += (theta.cos() * tilt.cos() + theta.sin() * phi.cos() * tilt.sin()).max(0.0) * theta.sin();
    }
    sum * angle / f64::from(rings) * 2.0 / f64::from(turns)
}

/// At every order: truncated light and visibility decide what is hidden, not what an open lamp gives.
#[test]
fn lamps_in_the_open_give_what_they_give() {
    let scene = scene(vec![lamp(LAMP)], points());
    let expected: Vec<f64> = points().iter().map(|(p, n)| integral(*p, *n)).collect();
    for order in ["1", "2", "4", "8"] {
        for method in methods() {
            let found = radiance(method, &scene, &[("order", order)]);
            for ((found, expected), (position, _)) in found.iter().zip(&expected).zip(points()) {
                let scale = f64::from(LAMP.radius / LAMP.center.distance(position)).powi(2);
                for (found, radiance) in found.to_array().into_iter().zip(RADIANCE.to_array()) {
                    let error = (f64::from(found) / f64::from(radiance) - expected).abs() / scale;
                    assert!(error < 1e-3, "{} at order {order}: {found} for {expected}", method.info().id);
                }
            }
        }
    }
}

/// Band `l` of a circle of 1 about z with so many radians of radius: `√(π/(2l+1)) (P_{l−1}(cos) − P_{l+1}(cos))`.
fn circle(band: usize, angle: f64) -> f64 {
    let below = if band == 0 { 1.0 } else { legendre(band - 1, angle.cos()) };
    (PI / (2 * band + 1) as f64).sqrt() * (below - legendre(band + 1, angle.cos()))
}

fn legendre(band: usize, x: f64) -> f64 {
    let step = |(before, here): (f64, f64), l: usize| {
        let l = l as f64;
        (here, ((2.0 * l + 1.0) * x * here - l * before) / (l + 1.0))
    };
    (0..band).fold((0.0, 1.0), step).1
}

/// The share `(g, L)/(1, L)` under one ball, at all covers of the lamp, by band sums.
#[test]
fn a_ball_leaves_of_a_lamp_what_its_bands_say() {
    let position = Vec3::new(0.2, -0.3, 0.0);
    let to = LAMP.center - position;
    let radius = f64::from(LAMP.radius / to.length()).asin();
    let mut partial = 0;
    for step in 0..30 {
        let apart = 0.05 * step as f32;
        let ball = Sphere { center: position + 0.5 * Vec3::new(apart.sin(), 0.0, apart.cos()), radius: 0.18 };
        let hidden = f64::from(ball.radius / 0.5).asin();
        let scene = scene(vec![lamp(LAMP), fixtures::spheres("ball", vec![ball])], vec![(position, Vec3::Z)]);
        for order in [1, 2, 4, 6, 8] {
            let setting = order.to_string();
            let settings = [("order", setting.as_str()), ("self-shadow", "off")];
            let term = |l| circle(l, radius) * circle(l, hidden) * legendre(l, f64::from(apart.cos()));
            let share = 1.0 - (0..order).map(term).sum::<f64>() / ((4.0 * PI).sqrt() * circle(0, radius));
            partial += usize::from((0.1..0.9).contains(&share));
            let expected = integral(position, Vec3::Z) * share.clamp(0.0, 1.0);
            for id in ["sh-product/ordered", "sh-product/tree", "shexp/eigen"] {
                let method = halflight_registry::find(id).expect("it is registered");
                let found = f64::from(radiance(method, &scene, &settings)[0].x / RADIANCE.x);
                let error = (found - expected).abs() / integral(position, Vec3::Z);
                assert!(error < 2e-3, "{id}, order {order}, {apart} apart: {found} for {expected}");
            }
        }
    }
    assert!(partial > 20, "{partial}");
}

/// The paper's table fits what it holds: in the open at order 4 up to what truncation and one lobe leave, and it hides what hides.
#[test]
fn lobes_light_as_lamps_do() {
    let points: Vec<_> = points().into_iter().filter(|(p, n)| (LAMP.center - *p).normalize().dot(*n) > 0.5).collect();
    assert!(points.len() > 40);
    let scene = scene(vec![lamp(LAMP)], points.clone());
    for method in methods() {
        let found = radiance(method, &scene, &[("order", "4"), ("lamps", "lobe")]);
        for (found, (position, normal)) in found.iter().zip(&points) {
            let expected = integral(*position, *normal);
            let error = (f64::from(found.x / RADIANCE.x) - expected).abs() / expected;
            assert!(error < 0.1, "{}: {} for {expected}", method.info().id, found.x / RADIANCE.x);
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
