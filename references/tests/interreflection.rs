//! Light between diffuse surfaces: closed rooms whose radiance is known, and squares that see each other.

mod support;

use glam::{DVec3, Vec3};
use halflight_contract::Quantity;
use halflight_references::{Estimate, Quality, analytic};
use halflight_scenes::{Mesh, Object, Rgb, Scene, Shape};
use support::*;

/// A rectangle whose front is on the side from which its corners run anticlockwise.
fn square(corners: [Vec3; 4], albedo: f32, emission: f32) -> Object {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    let mesh = Mesh {
        positions: corners.to_vec(),
        normals: vec![normal; 4],
        uvs: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    Object { albedo: Rgb::splat(albedo), emission: Rgb::splat(emission).into(), ..object(Shape::Mesh(mesh)) }
}

/// A cube of side 2 seen from inside: six walls with their fronts inwards.
fn room(albedo: f32, emission: f32) -> Vec<Object> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    (0..6)
        .map(|side| {
            let axis = axes[side / 2] * if side % 2 == 0 { 1.0 } else { -1.0 };
            let (u, v) = axis.any_orthonormal_pair();
            // u × v = axis, the front towards the middle.
            square([axis - u - v, axis - u + v, axis + u + v, axis + u - v], albedo, emission)
        })
        .collect()
}

fn points_in_a_room() -> Vec<(Vec3, Vec3)> {
    let mut points: Vec<_> = (0..40)
        .map(|i| (Vec3::new((i % 8) as f32 * 0.24 - 0.85, (i / 8) as f32 * 0.38 - 0.8, -1.0), Vec3::Z))
        .collect();
    points.extend(normals(24).iter().map(|normal| (Vec3::new(0.1, -0.2, 0.3), *normal)));
    points
}

fn assert_is(estimate: &Estimate, expected: impl Fn(usize) -> f64, what: &str) {
    let mut sum = 0.0;
    let count = estimate.mean.len();
    for i in 0..count {
        let (mean, error) = (f64::from(estimate.mean[i].x), f64::from(estimate.variance[i].x).sqrt());
        // Rounding of the geometry, where nothing is random.
        let z = (mean - expected(i)) / error.max(2e-6);
        assert!(z.abs() < 5.0, "{what}: receiver {i}: {mean} ± {error} for {}", expected(i));
        sum += z;
    }
    assert!(sum.abs() < 4.0 * (count as f64).sqrt(), "{what}: mean z {}", sum / count as f64);
}

#[test]
fn a_furnace_of_albedo_and_emission_one_half_holds_radiance_one() {
    let scene = scene(room(0.5, 0.5), vec![], &points_in_a_room());
    let quality = Quality::fixed(1024);
    let total = run_of(Quantity::Total, "truth", &scene, &quality, 1).expect("an estimate");
    assert_is(&total, |_| analytic::enclosure(0.5, 0.5), "all bounces");
    let error = total.variance.iter().map(|v| v.x.sqrt()).fold(0.0, f32::max);
    assert!(error < 0.01, "{error}");
    for bounces in [1u8, 2, 3, 5] {
        let indirect = run_of(Quantity::Indirect { bounces }, "truth", &scene, &quality, 1).expect("an estimate");
        let expected = analytic::enclosure_after(0.5, 0.5, bounces.into()) - 0.5;
        assert_is(&indirect, |_| expected, &format!("{bounces} bounces"));
    }
    let direct = run_of(Quantity::Direct, "truth", &scene, &quality, 1).expect("an estimate");
    assert_is(&direct, |_| 0.5, "no bounce");
    // The control: a wall that reflects 1% more is found.
    let brighter: Vec<Object> = room(0.505, 0.5);
    let brighter = Scene { objects: brighter, ..scene };
    let total = run_of(Quantity::Total, "truth", &brighter, &Quality::fixed(4096), 1).expect("an estimate");
    let z = total.mean.iter().zip(&total.variance).map(|(m, v)| (m.x - 1.0) / v.x.sqrt()).sum::<f32>() / 8.0;
    assert!(z > 6.0, "{z}");
}

/// A white room about a distant light: what gets out of a hole does not come back.
#[test]
fn walls_of_a_ball_seen_from_inside_reflect_as_often_as_they_are_hit() {
    // Inside a sphere irradiance is the same everywhere, and a hole of a share h of the area loses that share at each bounce.
    // The lower half of a sphere under a uniform sky: the upper hemisphere is open, so B = ρ(1/2 + B/2), B = ρ/(2 − ρ).
    let mut ball = ball(Vec3::ZERO, 1.0, 96);
    let Shape::Mesh(mesh) = &mut *std::sync::Arc::make_mut(&mut ball.shape) else { unreachable!("a mesh") };
    mesh.triangles.retain(|triangle| triangle.iter().all(|i| mesh.positions[*i as usize].z < 1e-3));
    let bowl = Object { albedo: Rgb::splat(0.8), ..ball };
    let points: Vec<_> = normals(60).into_iter().filter(|n| n.z < -0.1).map(|n| (0.999 * n, -n)).collect();
    let scene = scene(vec![bowl], vec![sky(1.0)], &points);
    let total = run_of(Quantity::Total, "truth", &scene, &Quality::fixed(2048), 3).expect("an estimate");
    // Irradiance over π is B/ρ. The facets of the ball and the receivers' distance from it cost about a thousandth.
    let expected = 1.0 / (2.0 - 0.8);
    let mean = total.mean.iter().map(|m| f64::from(m.x)).sum::<f64>() / total.mean.len() as f64;
    assert!((mean - expected).abs() < 3e-3, "{mean} for {expected}");
}

/// Two equal squares face each other; one emits. What the other gets, averaged over it, is the form factor.
#[test]
fn parallel_squares_exchange_their_form_factor() {
    for side_over_distance in [0.5f32, 1.0, 3.0] {
        let half = 0.5 * side_over_distance;
        let lamp = square(
            [(-half, -half), (-half, half), (half, half), (half, -half)].map(|(x, y)| Vec3::new(x, y, 1.0)),
            0.0,
            1.0,
        );
        let n = 24;
        let at = |i: i32| (i as f32 + 0.5) / n as f32 * 2.0 * half - half;
        let points: Vec<_> = (0..n * n).map(|i| (Vec3::new(at(i % n), at(i / n), 0.0), Vec3::Z)).collect();
        let scene = scene(vec![lamp], vec![], &points);
        let direct = run("truth", &scene, &Quality::fixed(256), 5);
        let mean = direct.mean.iter().map(|m| f64::from(m.x)).sum::<f64>() / f64::from(n * n);
        let expected = analytic::parallel_squares(f64::from(side_over_distance));
        // By the midpoint rule over the receivers.
        assert!((mean / expected - 1.0).abs() < 2e-3, "{side_over_distance}: {mean} for {expected}");
    }
}

/// One bounce between squares: a lit square lights another at right angles to it; exact quadrature over both.
#[test]
fn one_bounce_agrees_with_quadrature_over_the_reflecting_square() {
    let floor =
        square([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0)), 0.6, 0.0);
    let lamp =
        square([(-0.4, -0.4), (-0.4, 0.4), (0.4, 0.4), (0.4, -0.4)].map(|(x, y)| Vec3::new(x, y, 1.5)), 0.0, 2.0);
    let lamp_corners: Vec<DVec3> = match &*lamp.shape {
        Shape::Mesh(mesh) => mesh.positions.iter().map(|p| p.as_dvec3()).collect(),
        _ => unreachable!("a mesh"),
    };
    let points: Vec<_> = (0..12)
        .map(|i| (Vec3::new(1.3, i as f32 * 0.15 - 0.9, 0.2 + 0.1 * i as f32), Vec3::new(-1.0, 0.0, 0.2).normalize()))
        .collect();
    let scene = scene(vec![floor, lamp], vec![], &points);
    let estimate =
        run_of(Quantity::Indirect { bounces: 1 }, "truth", &scene, &Quality::fixed(8192), 2).expect("an estimate");
    let exact = |i: usize| {
        let (position, normal) = (points[i].0.as_dvec3(), points[i].1.as_dvec3());
        let n = 400;
        let mut sum = 0.0;
        for cell in 0..n * n {
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
            let point = DVec3::new(at(cell % n), at(cell / n), 0.0);
            let corners: Vec<DVec3> = lamp_corners.iter().map(|corner| *corner - point).collect();
            let radiance = 0.6 * 2.0 * analytic::polygon_over_receiver(&corners, DVec3::Z);
            let to = point - position;
            let (square, there) = (to.length_squared(), -to.z);
            sum += radiance * normal.dot(to).max(0.0) * there.max(0.0) / (square * square);
        }
        sum * 4.0 / f64::from(n * n) / std::f64::consts::PI
    };
    assert_is(&estimate, exact, "one bounce");
}
