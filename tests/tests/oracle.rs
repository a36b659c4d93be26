//! One sphere over a plane: the visibility of `sh-product/ordered` against the exact projection, in f64 and written
//! here.
//!
//! A circle of angular radius θ around direction d leaves the visibility `V(ω) = 1` where `ω·d < cos θ`. Its
//! coefficients are `V_lm = y_lm(d) · 2π ∫_{−1}^{cos θ} P_l(x) dx`.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use halflight_contract::{Params, Quantity};
use halflight_scenes::{Light, Placement, Rgb, Scene, Sky, Sphere};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

const SPHERE: Sphere = Sphere { center: Vec3::new(0.1, -0.2, 0.45), radius: 0.6 };
/// Receivers a side of the grid, over 6 m.
const SIDE: usize = 48;
/// Nearest receivers in radii: closer ones see the circle's edge move by more than f32 can tell of its sine.
const NEAREST: f32 = 1.02;

/// P_0 … P_order at x by Bonnet's recurrence.
fn legendre(order: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for l in 2..=order {
        p.push(((2 * l - 1) as f64 * x * p[l - 1] - (l - 1) as f64 * p[l - 2]) / l as f64);
    }
    p
}

/// ∫_{−1}^{x} P_l for l < order, from `(2l + 1) P_l = (P_{l+1} − P_{l−1})′`.
fn legendre_integrals(order: usize, x: f64) -> Vec<f64> {
    let p = legendre(order, x);
    (0..order).map(|l| if l == 0 { 1.0 + x } else { (p[l + 1] - p[l - 1]) / (2 * l + 1) as f64 }).collect()
}

/// Real orthonormal y_lm without the Condon–Shortley phase, at index `l(l+1) + m`.
fn harmonics(order: usize, d: DVec3) -> Vec<f64> {
    let mut values = vec![0.0; order * order];
    let azimuth = d.y.atan2(d.x);
    let sine = (1.0 - d.z * d.z).max(0.0).sqrt();
    let mut diagonal = 1.0;
    for m in 0..order {
        let (mut before, mut p) = (0.0, diagonal);
        for l in m..order {
            let ratio: f64 = (l - m + 1..=l + m).map(|k| k as f64).product();
            let norm = ((2 * l + 1) as f64 / (4.0 * PI) / ratio).sqrt();
            let (sin, cos) = (m as f64 * azimuth).sin_cos();
            if m == 0 {
                values[l * (l + 1)] = norm * p;
            } else {
                values[l * (l + 1) + m] = 2f64.sqrt() * norm * p * cos;
                values[l * (l + 1) - m] = 2f64.sqrt() * norm * p * sin;
            }
            let next = ((2 * l + 1) as f64 * d.z * p - (l + m) as f64 * before) / (l + 1 - m) as f64;
            (before, p) = (p, next);
        }
        diagonal *= (2 * m + 1) as f64 * sine;
    }
    values
}

fn exact(order: usize, receiver: Vec3) -> Vec<f64> {
    let to = SPHERE.center.as_dvec3() - receiver.as_dvec3();
    let sine = f64::from(SPHERE.radius) / to.length();
    let bands = legendre_integrals(order, (1.0 - sine * sine).sqrt());
    let mut values = harmonics(order, to.normalize());
    for (l, band) in bands.iter().enumerate() {
        values[l * l..(l + 1) * (l + 1)].iter_mut().for_each(|value| *value *= 2.0 * PI * band);
    }
    values
}

fn scene() -> Scene {
    let at = |i: usize| (i as f32 + 0.5) / SIDE as f32 * 6.0 - 3.0;
    let positions = (0..SIDE * SIDE).map(|i| Vec3::new(at(i % SIDE), at(i / SIDE), 0.0));
    let outside = positions.filter(|p| p.distance(SPHERE.center) > NEAREST * SPHERE.radius);
    let points = outside.map(|p| (p, Vec3::Z)).collect();
    let light = Light::Sky(Sky::Uniform(Rgb::ONE));
    fixtures::scene(
        "oracle",
        vec![fixtures::spheres("ball", vec![SPHERE])],
        vec![light],
        Placement::Points(std::sync::Arc::new(points)),
    )
}

#[test]
fn visibility_is_the_exact_projection_at_every_order() {
    let scene = scene();
    let method = halflight_registry::find("sh-product/ordered").expect("it is registered");
    let receivers = scene.frame(0).receivers;
    let clipped = receivers.position.iter().filter(|p| (SPHERE.center - **p).z < SPHERE.radius).count();
    assert!(receivers.len() >= 2000 && clipped >= 2000, "{} receivers, {clipped} clipped", receivers.len());
    for order in 1..=8u8 {
        let settings = [("order", order.to_string()), ("self-shadow", "off".into())];
        let settings = settings.iter().map(|(name, value)| (*name, value.as_str()));
        let params = Params::resolve(method.info().params, settings).expect("they are its parameters");
        let case = Case::new(method, &scene, Quantity::Visibility { order }).tuned(params);
        let found = case.fresh(&case.frames[0]).expect("it runs");
        let expected = receivers.position.iter().flat_map(|p| exact(usize::from(order), *p));
        let errors = found.iter().zip(expected).map(|(found, expected)| (f64::from(*found) - expected).abs());
        let worst = errors.fold(0.0, f64::max);
        assert!(worst < 1e-5, "order {order}: {worst:e}");
    }
}

/// The oracle against the definition: quadrature over the sphere of `V(ω) y_lm(ω)`, midpoint in height and azimuth.
#[test]
fn the_oracle_is_the_integral_over_the_open_directions() {
    let (order, receiver, steps) = (8, Vec3::new(0.9, 0.3, 0.0), 1500);
    let to = SPHERE.center.as_dvec3() - receiver.as_dvec3();
    let axis = to.normalize();
    let (tangent, bitangent) = axis.any_orthonormal_pair();
    let edge = (1.0 - (f64::from(SPHERE.radius) / to.length()).powi(2)).sqrt();
    let (rows, columns) = (steps, 4 * order);
    let weight = (1.0 + edge) / rows as f64 * 2.0 * PI / columns as f64;
    let mut sum = vec![0.0; order * order];
    for i in 0..rows * columns {
        let height = -1.0 + (1.0 + edge) * ((i / columns) as f64 + 0.5) / rows as f64;
        let (sin, cos) = ((i % columns) as f64 / columns as f64 * 2.0 * PI).sin_cos();
        let rim = (1.0 - height * height).sqrt();
        let direction = axis * height + (tangent * cos + bitangent * sin) * rim;
        sum.iter_mut().zip(harmonics(order, direction)).for_each(|(sum, y)| *sum += weight * y);
    }
    for (quadrature, closed) in sum.iter().zip(exact(order, receiver)) {
        assert!((quadrature - closed).abs() < 1e-5, "{quadrature} for {closed}");
    }
}
