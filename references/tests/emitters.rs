//! Objects that emit: closed forms in the open, quadrature behind blockers.

mod support;

use glam::{DVec3, Vec2, Vec3};
use halflight_contract::Quantity;
use halflight_references::{Estimate, Quality, analytic};
use halflight_scenes::{Emission, Grid, Object, Placement, Rgb, Scene, Shape};
use support::*;

fn lamp(shape: Object, radiance: f32) -> Object {
    Object { emission: Rgb::splat(radiance).into(), albedo: Rgb::ZERO, ..shape }
}

/// A plate that shines downwards.
fn ceiling_lamp(height: f32, half: f32, radiance: f32) -> Object {
    let mut plate = plate(height, half);
    let Shape::Mesh(mesh) = std::sync::Arc::make_mut(&mut plate.shape) else { unreachable!("a mesh") };
    mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    lamp(plate, radiance)
}

fn points(count: i32) -> Vec<(Vec3, Vec3)> {
    let at = |i: i32| (i as f32 + 0.5) / count as f32 * 4.0 - 2.0;
    (0..count * count)
        .map(|i| {
            let tilt = Vec3::new(0.5 * (i as f32).sin(), 0.5 * (1.7 * i as f32).cos(), 1.0).normalize();
            (Vec3::new(at(i % count), at(i / count), 0.0), tilt)
        })
        .collect()
}

fn assert_z(estimate: &Estimate, expected: impl Fn(usize) -> f64, what: &str) {
    let mut sum = 0.0;
    let mut count = 0.0f64;
    for i in 0..estimate.mean.len() {
        let (mean, error) = (f64::from(estimate.mean[i].x), f64::from(estimate.variance[i].x).sqrt());
        let exact = expected(i);
        let z = (mean - exact) / error.max(1e-6 + 2e-6 * exact);
        assert!(z.abs() < 5.5, "{what}: receiver {i}: {mean} ± {error} for {exact}: z = {z}");
        sum += z;
        count += 1.0;
    }
    assert!(sum.abs() < 4.0 * count.sqrt(), "{what}: mean z {}", sum / count);
}

#[test]
fn lamps_in_the_open_give_their_closed_forms() {
    let quality = Quality::fixed(64);
    let points = points(16);
    let (center, radius) = (Vec3::new(0.2, 0.3, 0.6), 0.5);
    let ball = scene(vec![lamp(spheres(&[(center, radius)]), 3.0)], vec![], &points);
    let exact = |i: usize| {
        let to = (center - points[i].0).as_dvec3();
        let angle = (to.dot(points[i].1.as_dvec3()) / to.length()).acos();
        3.0 * analytic::sphere_over_receiver(to.length() / f64::from(radius), angle)
    };
    assert_z(&run("truth", &ball, &quality, 1), exact, "sphere");

    let plate = scene(vec![ceiling_lamp(1.2, 0.7, 2.0)], vec![], &points);
    let exact = |i: usize| {
        let at = |x: f64, y: f64| DVec3::new(0.7 * x, 0.7 * y, 1.2) - points[i].0.as_dvec3();
        let corners = [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)];
        2.0 * analytic::polygon_over_receiver(&corners, points[i].1.as_dvec3())
    };
    assert_z(&run("truth", &plate, &quality, 1), exact, "plate");

    let straight_below = scene(vec![ceiling_lamp(1.0, 0.5, 1.0)], vec![], &[(Vec3::ZERO, Vec3::Z)]);
    let quarter = analytic::rectangle_over_point([0.5, 0.5], 1.0);
    assert_z(&run("truth", &straight_below, &quality, 1), |_| 4.0 * quarter, "rectangle over a point");

    // The back of a lamp is dark, and from inside a sphere its front is not seen.
    let behind = scene(vec![ceiling_lamp(-1.0, 0.5, 1.0)], vec![], &[(Vec3::ZERO, -Vec3::Z)]);
    assert_eq!(run("truth", &behind, &quality, 1).mean, [Rgb::ZERO]);
    let inside = scene(vec![lamp(spheres(&[(Vec3::ZERO, 2.0)]), 1.0)], vec![], &[(Vec3::X, Vec3::Z)]);
    assert_eq!(run("truth", &inside, &quality, 1).mean, [Rgb::ZERO]);
}

/// Rays of a receiver on a wide ground start well above it; those that graze a small lamp must not be blocked by it.
#[test]
fn no_lamp_stands_in_its_own_light() {
    let (center, radius) = (Vec3::new(0.1, -0.1, 0.5), 0.07);
    let grid = Grid { center: Vec3::ZERO, size: Vec2::ONE, resolution: [8, 8], normal: Vec3::Z, object: Some(1) };
    let ball = scene(vec![lamp(spheres(&[(center, radius)]), 100.0), plate(0.0, 20.0)], vec![], &[]);
    let ball = Scene { placement: Placement::Grid(grid), ..ball };
    let receivers = ball.frame(0).receivers;
    let exact = |i: usize| {
        let to = (center - receivers.position[i]).as_dvec3();
        100.0 * analytic::sphere_over_receiver(to.length() / f64::from(radius), to.angle_between(DVec3::Z))
    };
    for reference in ["truth", "mean-visibility"] {
        let estimate = run(reference, &ball, &Quality::fixed(1024), 1);
        for i in 0..estimate.mean.len() {
            // All rays arrive, so that no error is left but that of starting a little higher.
            let (mean, exact) = (f64::from(estimate.mean[i].x), exact(i));
            assert!((mean / exact - 1.0).abs() < 3e-4, "{reference}: receiver {i}: {mean} for {exact}");
        }
    }
}

/// A disc of many triangles, of which one is chosen by its power.
#[test]
fn many_small_emitters_add_up_to_a_disc() {
    let (radius, height, sectors) = (0.8f32, 1.0, 64u32);
    let mut disc = plate(0.0, 1.0);
    let Shape::Mesh(mesh) = std::sync::Arc::make_mut(&mut disc.shape) else { unreachable!("a mesh") };
    let rim = |i: u32| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / sectors as f32).sin_cos();
        Vec3::new(radius * cos, radius * sin, height)
    };
    mesh.positions = std::iter::once(Vec3::Z * height).chain((0..sectors).map(rim)).collect();
    mesh.normals = vec![-Vec3::Z; mesh.positions.len()];
    mesh.triangles = (0..sectors).map(|i| [0, (i + 1) % sectors + 1, i + 1]).collect();
    let points: Vec<_> = (0..64).map(|_| (Vec3::ZERO, Vec3::Z)).collect();
    let scene = scene(vec![lamp(disc, 2.0)], vec![], &points);
    let estimate = run("truth", &scene, &Quality::fixed(4096), 9);
    // The polygon's area is that of the disc but for 0.16%, which is below the errors.
    assert_z(&estimate, |_| 2.0 * analytic::disc_over_point(f64::from(radius), f64::from(height)) * 0.9992, "disc");
    assert!(estimate.variance.iter().all(|v| v.x.sqrt() < 3e-3));
}

/// A square lamp that faces down, cut into cells of their own radiance.
fn mosaic(cells: i32, radiance: impl Fn(i32, i32) -> Rgb) -> Object {
    let side = |i: i32| (2.0 * i as f32 / cells as f32 - 1.0) * 0.7;
    let mut lamp = ceiling_lamp(1.2, 0.7, 1.0);
    let Shape::Mesh(mesh) = std::sync::Arc::make_mut(&mut lamp.shape) else { unreachable!("a mesh") };
    let corners = (0..=cells).flat_map(|y| (0..=cells).map(move |x| (x, y)));
    mesh.positions = corners.map(|(x, y)| Vec3::new(side(x), side(y), 1.2)).collect();
    mesh.normals = vec![-Vec3::Z; mesh.positions.len()];
    let number = |x: i32, y: i32| (y * (cells + 1) + x) as u32;
    let squares: Vec<(i32, i32)> = (0..cells * cells).map(|i| (i % cells, i / cells)).collect();
    let two = |(x, y): &(i32, i32)| {
        let [a, b, c, d] = [number(*x, *y), number(*x, y + 1), number(x + 1, y + 1), number(x + 1, *y)];
        [[a, b, c], [a, c, d]]
    };
    mesh.triangles = squares.iter().flat_map(two).collect();
    let emission =
        Emission::Triangles(std::sync::Arc::new(squares.iter().flat_map(|(x, y)| [radiance(*x, *y); 2]).collect()));
    Object { emission, content: lamp.shape.content(), ..lamp }
}

/// Few cells, which are weighed at each receiver, and many, which are chosen by their power; some are dark.
#[test]
fn each_cell_of_a_picture_gives_its_own_light() {
    for cells in [3, 8] {
        let radiance = |x: i32, y: i32| if (x + y) % 3 == 0 { 0.0 } else { 1.0 + (x * x + 2 * y) as f32 };
        let points = points(12);
        let scene = scene(vec![mosaic(cells, |x, y| Rgb::splat(radiance(x, y)))], vec![], &points);
        let exact = |i: usize| {
            let side = |i: i32| (2.0 * f64::from(i) / f64::from(cells) - 1.0) * 0.7;
            let cell = |x: i32, y: i32| {
                let at = |x: i32, y: i32| DVec3::new(side(x), side(y), 1.2) - points[i].0.as_dvec3();
                let corners = [at(x, y), at(x, y + 1), at(x + 1, y + 1), at(x + 1, y)];
                f64::from(radiance(x, y)) * analytic::polygon_over_receiver(&corners, points[i].1.as_dvec3())
            };
            (0..cells * cells).map(|i| cell(i % cells, i / cells)).sum()
        };
        assert_z(&run("truth", &scene, &Quality::fixed(4096), 3), exact, "mosaic");
    }
}

/// Paths meet the cells as well: a bounce under a mosaic is that under its cells as lamps of their own.
#[test]
fn paths_find_the_radiance_of_the_cell_that_they_hit() {
    let colour = |x: i32, y: i32| Rgb::new(x as f32, y as f32, 1.0);
    let (floor, wall) = (plate(0.0, 2.0), spheres(&[(Vec3::new(1.6, 0.2, 0.5), 0.4)]));
    let points: Vec<_> = points(8).into_iter().map(|(p, _)| (0.5 * p + 0.3 * Vec3::Z, -Vec3::Z)).collect();
    let whole = scene(vec![mosaic(2, colour), floor.clone(), wall.clone()], vec![], &points);
    let alone = |one: i32| {
        let cell = mosaic(2, |x, y| if x + 2 * y == one { colour(x, y) } else { Rgb::ZERO });
        Object { casts: one == 0, ..cell }
    };
    let cells = scene((0..4).map(alone).chain([floor, wall]).collect(), vec![], &points);
    let quality = Quality::fixed(16384);
    let [a, b] = [&whole, &cells].map(|scene| run_of(Quantity::Indirect { bounces: 1 }, "truth", scene, &quality, 5));
    let [a, b] = [a, b].map(|estimate| estimate.expect("an estimate"));
    let mut worst = 0f32;
    for i in 0..points.len() {
        let sigma = (a.variance[i] + b.variance[i]).to_array().map(f32::sqrt);
        let differences = (a.mean[i] - b.mean[i]).to_array();
        worst = differences.iter().zip(sigma).map(|(d, s)| d.abs() / s.max(1e-5)).fold(worst, f32::max);
        assert!(a.mean[i].min_element() > 0.01, "light arrives: {}", a.mean[i]);
    }
    assert!(worst < 5.0, "{worst} standard errors");
}

/// A sphere between a square lamp and the receivers, against quadrature over the lamp.
#[test]
fn a_ball_casts_the_shadow_of_a_square_lamp() {
    let (center, radius) = (Vec3::new(0.1, -0.2, 0.6), 0.35);
    let blocker = Object { albedo: Rgb::ZERO, ..spheres(&[(center, radius)]) };
    let points: Vec<_> = points(10).into_iter().map(|(p, _)| (0.6 * p, Vec3::Z)).collect();
    let scene = scene(vec![ceiling_lamp(1.5, 0.4, 5.0), blocker], vec![], &points);
    let exact = |i: usize| {
        let position = points[i].0.as_dvec3();
        let n = 500;
        let mut sum = 0.0;
        for cell in 0..n * n {
            let at = |i: i32| ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0) * 0.4;
            let to = DVec3::new(at(cell % n), at(cell / n), 1.5) - position;
            let square = to.length_squared();
            let along = (center.as_dvec3() - position).dot(to) / square;
            let passes = (position + along * to - center.as_dvec3()).length() > f64::from(radius);
            if passes {
                sum += to.z * to.z / (square * square);
            }
        }
        5.0 * sum * 0.64 / f64::from(n * n) / std::f64::consts::PI
    };
    let estimate = run("truth", &scene, &Quality::fixed(4096), 4);
    assert_z(&estimate, exact, "shadow");
    let dark = estimate.mean.iter().filter(|m| m.x < 0.05).count();
    let lit = estimate.variance.iter().filter(|v| v.x == 0.0).count();
    assert!(dark > 3 && lit < 60, "{dark} dark, {lit} lit");
}

#[test]
fn a_lamp_that_casts_blocks_the_sky_and_one_that_does_not_does_not() {
    let at = [(Vec3::ZERO, Vec3::Z)];
    let ball = |casts| Object { casts, ..lamp(spheres(&[(Vec3::Z * 2.0, 1.0)]), 3.0) };
    for (casts, sky_share) in [(true, 0.75), (false, 1.0)] {
        let scene = scene(vec![ball(casts)], vec![sky(1.0)], &at);
        let direct = run("truth", &scene, &Quality::fixed(4096), 1);
        assert_z(&direct, |_| sky_share + 3.0 * 0.25, &format!("casts: {casts}"));
        let total = run_of(Quantity::Total, "truth", &scene, &Quality::fixed(4096), 1).expect("an estimate");
        assert_z(&total, |_| sky_share + 3.0 * 0.25, &format!("a black lamp reflects nothing; casts: {casts}"));
    }
}
