//! Truth over height fields, by z-scores: closed forms, and integrals over exact horizons.

mod support;

use std::f64::consts::TAU;

use glam::{Vec2, Vec3};
use halflight_references::horizon::{Horizons, sky_irradiance};
use halflight_references::statistics::{ZSummary, z_test};
use halflight_references::{Estimate, Quality, analytic};
use halflight_scenes::{HeightField, Light, Placement, Rgb, Scene, Shape};
use support::*;

/// Radiance 1 above elevation 0, 0 below.
fn upper_sky() -> Light {
    map(2, 2, |_, row| Rgb::splat(if row == 0 { 1.0 } else { 0.0 }))
}

/// A field that casts on its own vertices, which are the receivers.
fn scene_over(field: &HeightField, light: Light) -> Scene {
    let scene = scene(vec![object(Shape::Heights(field.clone()))], vec![light], &[]);
    Scene { placement: Placement::Heights { object: 0 }, ..scene }
}

fn field(size: [usize; 2], cell: [f32; 2], height: impl Fn(f32, f32) -> f32) -> HeightField {
    let [columns, rows] = size;
    let cell = Vec2::from(cell);
    let origin = -0.5 * Vec2::new((columns - 1) as f32, (rows - 1) as f32) * cell;
    let vertex = |index: usize| {
        let at = origin + Vec2::new((index % columns) as f32, (index / columns) as f32) * cell;
        height(at.x, at.y)
    };
    HeightField::new(size, origin, cell, (0..columns * rows).map(vertex).collect())
}

/// Needles and pits: neighbours differ by up to five cells, so that the way along many a normal leads into the ground.
fn needles(size: [usize; 2]) -> HeightField {
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        5.0 * (state >> 8) as f32 / (1 << 24) as f32
    };
    let heights = (0..size[0] * size[1]).map(|_| next()).collect();
    HeightField::new(size, Vec2::splat(-3.0), Vec2::new(1.0, 0.8), heights)
}

/// What the horizons at a field's vertices leave of the upper sky, in the order of its receivers.
fn from_horizons(field: &HeightField) -> Vec<Rgb> {
    let azimuths: Vec<f64> = (0..720).map(|k| TAU * f64::from(k) / 720.0).collect();
    let all = Horizons::new(field).at_vertices(&azimuths);
    let at = |[i, j]: [usize; 2]| {
        let horizons = &all[(j * field.columns() + i) * azimuths.len()..][..azimuths.len()];
        sky_irradiance(field.normal(i, j).as_dvec3(), horizons)
    };
    let rows = (0..field.rows()).rev();
    let vertices = rows.flat_map(|j| (0..field.columns()).map(move |i| [i, j]));
    vertices.map(|vertex| Rgb::splat(at(vertex) as f32)).collect()
}

fn truth(scene: &Scene) -> Estimate {
    run("truth", scene, &Quality::fixed(1024), 5)
}

fn assert_passes(what: &str, summary: &ZSummary) {
    assert!(summary.passes(0.01), "{what}: {summary:?}");
}

#[test]
fn rays_and_horizons_see_the_same_sky() {
    let rough = field([22, 19], [1.0, 0.8], |x, y| 2.0 * (0.7 * x).sin() * (0.5 * y + 0.2 * x).cos() + (1.9 * y).sin());
    for (name, field) in [("rough", rough), ("needles", needles([21, 20]))] {
        let expected = from_horizons(&field);
        let resolved: Vec<bool> = expected.iter().map(|e| (0.1..0.98).contains(&e.x)).collect();
        let estimate = truth(&scene_over(&field, upper_sky()));
        let summary = z_test(&estimate, &expected, &resolved);
        assert!(summary.count > 300, "{name}: {summary:?}");
        assert_passes(name, &summary);
        let off: Vec<Rgb> = expected.iter().map(|e| *e * 1.02).collect();
        assert!(!z_test(&estimate, &off, &resolved).passes(0.01), "{name}: 2% are noticed");
    }
}

#[test]
fn the_bottom_of_a_trench_has_the_closed_form() {
    let wall = 50f32.to_radians();
    let trench = field([41, 400], [0.5, 0.5], |x, _| wall.tan() * x.abs());
    // Walls that rise from the very bottom have the horizon of endless ones, however near the ends.
    let closed = analytic::trench([f64::from(wall); 2]);
    let points: Vec<_> = (20..200).map(|row| (trench.position(20, row), trench.normal(20, row))).collect();
    let scene = scene_over(&trench, upper_sky()).with_receivers(&points);
    let expected = vec![Rgb::splat(closed as f32); points.len()];
    assert_passes("trench", &z_test(&truth(&scene), &expected, &vec![true; points.len()]));
}

#[test]
fn a_ramp_has_the_closed_form() {
    let slope = 35f32.to_radians();
    let ramp = field([24, 24], [1.0, 1.0], |x, y| slope.tan() * (0.6 * x - 0.8 * y));
    for (light, closed) in [
        (upper_sky(), analytic::ramp(f64::from(slope))),
        (Light::Sky(halflight_scenes::Sky::Overcast(Rgb::ONE)), analytic::overcast(f64::from(slope))),
    ] {
        let expected = vec![Rgb::splat(closed as f32); 24 * 24];
        let estimate = truth(&scene_over(&ramp, light));
        let greatest = estimate.mean.iter().map(|m| (f64::from(m.x) - closed).abs()).fold(0.0, f64::max);
        // Nothing is hidden but what lies behind the receivers, which the control variate knows: no noise is left.
        assert!(greatest < 2e-4, "{greatest} off {}", expected[0]);
    }
}

/// At 14 diameters away rays start some ten-thousandths of a cell above the ground: 16 rounding steps of that distance.
#[test]
fn scale_and_place_do_not_matter() {
    let field = needles([14, 12]);
    let expected = from_horizons(&field);
    let resolved: Vec<bool> = expected.iter().map(|e| (0.1..0.98).contains(&e.x)).collect();
    for (scale, away) in [(1e-3, 0.0), (1e3, 0.0), (1.0, 2e2), (1e3, 2e5)] {
        let heights = field.heights().iter().map(|h| scale * h).collect();
        let origin = scale * field.origin() + Vec2::new(away, -away);
        let placed = HeightField::new([14, 12], origin, scale * field.cell(), heights);
        let summary = z_test(&truth(&scene_over(&placed, upper_sky())), &expected, &resolved);
        assert_passes(&format!("times {scale}, moved by {away}"), &summary);
    }
}

#[test]
fn a_field_seen_from_below_covers_the_sky() {
    let flat = field([9, 9], [100.0, 100.0], |_, _| 0.0);
    let scene = scene(vec![object(Shape::Heights(flat))], vec![sky(1.0)], &[]);
    let below = -Vec3::Z;
    let scene = scene.with_receivers(&[(below, Vec3::Z), (-below, Vec3::Z)]);
    let estimate = truth(&scene);
    assert!(estimate.mean[0].x < 1e-3 && estimate.mean[1].x > 0.999, "{:?}", estimate.mean);
}

/// What a control above stands on: the way along the normal is blocked at needles, straight up it is not.
#[test]
fn the_way_along_the_normal_would_lead_into_needles() {
    let field = needles([31, 28]);
    let into_ground = |[i, j]: [usize; 2]| {
        let normal = field.normal(i, j).as_dvec3();
        let step = 1e-3 * normal;
        let (x, y) = (i as f64 + step.x / f64::from(field.cell().x), j as f64 + step.y / f64::from(field.cell().y));
        field.surface(x, y) > f64::from(field.height(i, j)) + step.z + 1e-6
    };
    let inner = (1..27).flat_map(|j| (1..30).map(move |i| [i, j]));
    assert!(inner.filter(|vertex| into_ground(*vertex)).count() > 50);
}
