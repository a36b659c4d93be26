//! A sphere over a plane under a uniform sky: truth against the closed form, by z-scores.

mod support;

use glam::Vec3;
use halflight_references::statistics::{ZSummary, z_test};
use halflight_references::{Estimate, Quality, analytic};
use halflight_scenes::{Rgb, Scene};
use support::*;

/// Centre and radius; it dips below the plane, so every receiver sees it clipped by its horizon.
const SUNK: (Vec3, f32) = (Vec3::new(0.0, 0.0, 0.6), 1.0);
/// This one is clipped for near receivers only when they are turned away from it.
const FLOATING: (Vec3, f32) = (Vec3::new(0.2, 0.1, 1.3), 1.0);

/// A grid around the sphere, outside it, normals up or tilted.
fn receivers((center, radius): (Vec3, f32), side: i32, tilt: f32) -> Vec<(Vec3, Vec3)> {
    let cell = |i: i32| (f64::from(i) + 0.5) / f64::from(side) * 5.0 - 2.5;
    let turn = |i: i32| Vec3::new(tilt * (i as f32).sin(), tilt * (i as f32 * 1.7).cos(), 1.0).normalize();
    (0..side * side)
        .map(|i| (Vec3::new(cell(i % side) as f32, cell(i / side) as f32, 0.0), turn(i)))
        .filter(|(position, _)| position.distance(center) > 1.05 * radius)
        .collect()
}

fn closed_form((center, radius): (Vec3, f32), position: Vec3, normal: Vec3) -> f64 {
    let to = (center - position).as_dvec3();
    let angle = (to.dot(normal.as_dvec3()) / to.length()).clamp(-1.0, 1.0).acos();
    1.0 - analytic::sphere_over_receiver(to.length() / f64::from(radius), angle)
}

fn setup(sphere: (Vec3, f32), side: i32, tilt: f32) -> (Scene, Vec<Rgb>, Vec<bool>) {
    let points = receivers(sphere, side, tilt);
    let expected: Vec<f64> = points.iter().map(|(p, n)| closed_form(sphere, *p, *n)).collect();
    // Where less than 1% is blocked, few rays tell, and errors are far from normal.
    let resolved = expected.iter().map(|e| *e < 0.99).collect();
    (
        scene(vec![spheres(&[sphere])], vec![sky(1.0)], &points),
        expected.iter().map(|e| Rgb::splat(*e as f32)).collect(),
        resolved,
    )
}

fn scaled(estimate: &Estimate, factor: f32) -> Estimate {
    Estimate { mean: estimate.mean.iter().map(|m| *m * factor).collect(), ..estimate.clone() }
}

fn assert_passes(summary: &ZSummary) {
    assert!(
        summary.passes(0.01),
        "{summary:?}: limits {} and {}",
        summary.mean_limit(),
        summary.bonferroni_limit(0.01)
    );
}

#[test]
fn truth_agrees_with_the_closed_form_and_a_bias_of_one_percent_does_not() {
    for (sphere, side, tilt) in [(SUNK, 52, 0.0), (FLOATING, 50, 1.0)] {
        let (scene, expected, resolved) = setup(sphere, side, tilt);
        let clipped = scene.frame(0).receivers;
        let clipped = (0..clipped.len())
            .filter(|i| {
                let to = sphere.0 - clipped.position[*i];
                resolved[*i] && to.dot(clipped.normal[*i]).abs() < sphere.1
            })
            .count();
        let estimate = run("truth", &scene, &Quality::fixed(4096), 11);
        let summary = z_test(&estimate, &expected, &resolved);
        assert!(summary.count >= 1900 && clipped > 300, "{summary:?}, {clipped} clipped");
        assert_passes(&summary);
        for factor in [0.99, 1.01] {
            let biased = z_test(&scaled(&estimate, factor), &expected, &resolved);
            assert!(!biased.passes(0.01) && biased.mean.abs() > 3.0 * biased.mean_limit(), "{factor}: {biased:?}");
        }
    }
}

#[test]
fn default_quality_is_honest_and_meets_its_target() {
    let (scene, expected, _) = setup(SUNK, 52, 0.0);
    let quality = Quality::default();
    let estimate = run("truth", &scene, &quality, 21);
    // Of few samples the mean and its error are not independent, and z-scores lean to one side: pooled, both are unbiased.
    let pooled = |values: &mut dyn Iterator<Item = f32>| values.map(f64::from).sum::<f64>();
    let difference = pooled(&mut estimate.mean.iter().zip(&expected).map(|(mean, expected)| mean.x - expected.x));
    let variance = pooled(&mut estimate.variance.iter().map(|variance| variance.x));
    assert!(difference.abs() <= 3.0 * variance.sqrt(), "{difference} ± {}", variance.sqrt());
    let squares = pooled(&mut estimate.mean.iter().zip(&expected).map(|(m, e)| (m.x - e.x).powi(2)));
    // What one ray weighs is added to the variance, which overstates it by an eighth for so few.
    assert!((0.7..1.05).contains(&(squares / variance)), "true over claimed variance: {}", squares / variance);
    let errors = estimate.standard_error();
    let missed = errors.iter().filter(|e| e.x > 1.5 * quality.standard_error).count();
    assert!(missed * 20 < errors.len(), "{missed} of {}", errors.len());
    let rms = (squares / expected.len() as f64).sqrt();
    assert!(rms <= f64::from(quality.standard_error), "true error {rms}");
    assert!(estimate.samples.iter().any(|s| *s < 256) && estimate.samples.iter().any(|s| *s >= 256), "adapts");
}
