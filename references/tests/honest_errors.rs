//! Standard errors are honest: over 200 seeds, scores against exact values are standard normal, and estimates of two seeds agree as
//! often as comparisons promise.

mod support;

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};
use halflight_references::statistics::{compare, compare_exact, equivalent_z, normality_p};
use halflight_references::{Estimate, Quality, analytic};
use halflight_scenes::{KeyLight, Light, Rgb, Scene, Sky};
use support::*;

const SEEDS: u64 = 200;
const SPHERE: (Vec3, f32) = (Vec3::new(0.0, 0.0, 1.5), 0.6);

/// A floor under a sphere that its receivers see wholly above their horizon.
fn floor() -> Vec<(Vec3, Vec3)> {
    [0.0, 0.3, 0.5, 0.7, 1.0, 1.3, 1.6, 2.0].map(|x| (Vec3::new(x, 0.1, 0.0), Vec3::Z)).to_vec()
}

fn uniform_sky() -> (Scene, Vec<f64>) {
    let exact = |(position, _): &(Vec3, Vec3)| {
        let to = (SPHERE.0 - position).as_dvec3();
        1.0 - analytic::sphere_over_receiver(to.length() / f64::from(SPHERE.1), (to.z / to.length()).acos())
    };
    (scene(vec![spheres(&[SPHERE])], vec![sky(1.0)], &floor()), floor().iter().map(exact).collect())
}

/// The key light's penumbra runs across the receivers.
fn key_light_and_overcast() -> (Scene, Vec<f64>) {
    let (direction, angular_radius, radiance, zenith) = (Vec3::new(-0.55, 0.0, 1.0), 0.25f32, 6.0f32, 1.2f32);
    let lights = vec![key(direction, angular_radius, radiance), Light::Sky(Sky::Overcast(Rgb::splat(zenith)))];
    let Light::Key(key) = lights[0] else { unreachable!("built above") };
    let exact = |(position, _): &(Vec3, Vec3)| {
        let to = (SPHERE.0 - position).as_dvec3();
        let (axis, radius) = (to.normalize(), (f64::from(SPHERE.1) / to.length()).asin());
        let unoccluded = f64::from(zenith) * analytic::overcast(0.0)
            + f64::from(radiance) * analytic::circle(f64::from(angular_radius), f64::from(key.direction.z).acos());
        unoccluded
            - f64::from(zenith) * overcast_behind(axis, radius)
            - f64::from(radiance) * overlap(&key, axis, radius)
    };
    (scene(vec![spheres(&[SPHERE])], lights.clone(), &floor()), floor().iter().map(exact).collect())
}

/// `1/π ∫ (1 + 2z)/3·z dω` within a circle above the horizon: over the azimuth `z` has the mean `cos t·c` and the mean square
/// `cos² t·c² + sin² t·(1 − c²)/2` at an angle `t` from the axis, whose height is `c`.
fn overcast_behind(axis: DVec3, radius: f64) -> f64 {
    let c = axis.z;
    let ring = |t: f64| {
        let square = (t.cos() * c).powi(2) + 0.5 * t.sin().powi(2) * (1.0 - c * c);
        (t.cos() * c + 2.0 * square) / 3.0 * 2.0 * t.sin()
    };
    midpoint(0.0, radius, ring)
}

/// `1/π ∫ z dω` over what is both in the light's circle and in another: on a ring about the light's axis, the arc within the other
/// reaches `φ` to both sides of where it comes nearest.
fn overlap(key: &KeyLight, axis: DVec3, radius: f64) -> f64 {
    let light = key.direction.as_dvec3();
    let (cos, across) = (light.dot(axis), axis - light * light.dot(axis));
    let ring = |t: f64| {
        let phi = ((radius.cos() - t.cos() * cos) / (t.sin() * across.length())).clamp(-1.0, 1.0).acos();
        2.0 * (phi * t.cos() * light.z + phi.sin() * t.sin() * across.z / across.length()) * t.sin() / PI
    };
    midpoint(0.0, f64::from(key.angular_radius), ring)
}

fn midpoint(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = 20_000;
    (0..n).map(|i| f(a + (b - a) * (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() * (b - a) / f64::from(n)
}

fn over_seeds(scene: &Scene) -> Vec<Estimate> {
    (0..SEEDS).map(|seed| run("truth", scene, &Quality::fixed(4096), seed)).collect()
}

fn scores(estimates: &[Estimate], exact: &[f64]) -> Vec<f64> {
    let score = |estimate: &Estimate, i: usize| {
        let (mean, error) = (f64::from(estimate.mean[i].x), f64::from(estimate.variance[i].x).sqrt());
        equivalent_z(mean - exact[i], error, f64::from(estimate.batches - 1))
    };
    estimates.iter().flat_map(|estimate| (0..exact.len()).map(move |i| score(estimate, i))).collect()
}

#[test]
fn scores_over_seeds_are_standard_normal() {
    for (name, (scene, exact)) in [("uniform sky", uniform_sky()), ("key and overcast", key_light_and_overcast())] {
        let estimates = over_seeds(&scene);
        let scores = scores(&estimates, &exact);
        let p = normality_p(&scores);
        assert!(p > 0.001, "{name}: {p}");
        for receiver in 0..exact.len() {
            let own: Vec<f64> = scores.iter().skip(receiver).step_by(exact.len()).copied().collect();
            assert!(normality_p(&own) > 0.001 / 8.0, "{name}, receiver {receiver}: {}", normality_p(&own));
        }
        // The test would find errors claimed a fifth too small or a quarter too large, and a bias of a fifth of an error.
        for (factor, shift) in [(1.25, 0.0), (0.8, 0.0), (1.0, 0.2)] {
            let wrong: Vec<f64> = scores.iter().map(|z| factor * z + shift).collect();
            assert!(normality_p(&wrong) < 0.001, "{name}: {factor} {shift}");
        }

        let exact: Vec<Rgb> = exact.iter().map(|value| Rgb::splat(*value as f32)).collect();
        let rejected = |p: &mut dyn Iterator<Item = f64>| p.filter(|p| *p <= 0.1).count();
        let of_pairs = rejected(&mut estimates.chunks(2).map(|pair| compare(&pair[0], &pair[1]).p()));
        let of_one = rejected(&mut estimates.iter().map(|estimate| compare_exact(estimate, &exact).p()));
        // 10 and 20 at most are expected; more have probability 3e-4.
        assert!(of_pairs <= 21 && of_one <= 36, "{name}: {of_pairs} of 100 pairs, {of_one} of 200");
    }
}

/// The comparator's negative controls, at the size and quality of a picture.
#[test]
fn a_scaled_swapped_or_shifted_picture_is_rejected() {
    let side = 40;
    let cell = |i: i32| (i as f32 + 0.5) / side as f32 * 5.0 - 2.5;
    let points: Vec<_> = (0..side * side).map(|i| (Vec3::new(cell(i % side), cell(i / side), 0.0), Vec3::Z)).collect();
    let (Scene { objects, lights, .. }, _) = key_light_and_overcast();
    let scene = scene(objects, lights.into_iter().map(|light| light.rest).collect(), &points);
    let [a, b] = [1, 2].map(|seed| run("truth", &scene, &Quality { min_samples: 1024, ..Quality::default() }, seed));
    let honest = compare(&a, &b);
    assert!(honest.passes(0.01) && honest.receivers == points.len(), "{} {}", honest.family_p, honest.bias_p);

    let changed = |change: &dyn Fn(&mut Vec<Rgb>)| {
        let mut wrong = a.clone();
        change(&mut wrong.mean);
        change(&mut wrong.variance);
        wrong
    };
    let scaled = |factor: f32| Estimate { mean: a.mean.iter().map(|mean| *mean * factor).collect(), ..a.clone() };
    let (dark, bright) = ((side * side / 2 + 30) as usize, 3);
    for (name, wrong) in [
        ("1% brighter", scaled(1.01)),
        ("1% darker", scaled(0.99)),
        ("two receivers swapped", changed(&|values| values.swap(dark, bright))),
        ("shifted by a column", changed(&|values| values.rotate_right(1))),
        ("shifted by a row", changed(&|values| values.rotate_right(side as usize))),
        ("mirrored", changed(&|values| values.reverse())),
    ] {
        for comparison in [compare(&wrong, &b), compare(&b, &wrong)] {
            assert!(!comparison.passes(1e-4), "{name}: {} {}", comparison.family_p, comparison.bias_p);
        }
    }
}

#[test]
fn the_quadrature_is_that_of_circles() {
    let up = KeyLight { direction: Vec3::new(0.3, 0.0, 0.9).normalize(), angular_radius: 0.2, radiance: Rgb::ONE };
    let angle = f64::from(up.direction.z).acos();
    let (whole, axis) = (analytic::circle(f64::from(up.angular_radius), angle), up.direction.as_dvec3());
    // Within a larger circle; around a smaller one.
    let beside = DVec3::new(axis.x, 0.05, axis.z).normalize();
    assert!((overlap(&up, beside, 0.5) / whole - 1.0).abs() < 1e-6);
    let inner = analytic::circle(0.1, beside.z.acos());
    assert!((overlap(&up, beside, 0.1) / inner - 1.0).abs() < 3e-5);
    assert!(overlap(&up, DVec3::new(-0.5, 0.0, 0.8).normalize(), 0.1).abs() < 1e-12);
    // The whole sky.
    assert!((overcast_behind(DVec3::Z, FRAC_PI_2) - analytic::overcast(0.0)).abs() < 1e-7);
}
