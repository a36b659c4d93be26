//! References that change one thing, against what that gives exactly.

mod support;

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use halflight_contract::{Cache, NoMeter, Quantity};
use halflight_references::{Error, Estimate, Quality, Reference, Request, analytic, visibility};
use halflight_scenes::{Object, Rgb, Shape};
use halflight_sh::{evaluate, index, irradiance_weights};
use support::*;

/// `∫ B yᵢ dω` for a circle of directions.
fn circle(order: usize, axis: DVec3, angular_radius: f64) -> Vec<f64> {
    let mut basis = vec![0.0; order * order];
    evaluate(order, axis.to_array(), &mut basis);
    let band = |l: usize| {
        // ∫ from cos a to 1 of P_l, by Bonnet's recursion: (P_{l−1} − P_{l+1})/(2l + 1) at cos a.
        let x = angular_radius.cos();
        let p = |l: usize| {
            (1..l).fold((1.0, x), |(a, b), k| (b, ((2 * k + 1) as f64 * x * b - k as f64 * a) / (k + 1) as f64)).1
        };
        let p = |l: usize| if l == 0 { 1.0 } else { p(l) };
        if l == 0 { 1.0 - x } else { (p(l - 1) - p(l + 1)) / (2 * l + 1) as f64 }
    };
    let mut result = vec![0.0; order * order];
    for l in 0..order {
        for m in -(l as isize)..=l as isize {
            result[index(l, m)] = 2.0 * PI * band(l) * basis[index(l, m)];
        }
    }
    result
}

fn z(estimate: &Estimate, i: usize, exact: f64) -> f64 {
    (f64::from(estimate.mean[i].x) - exact) / f64::from(estimate.variance[i].x).sqrt().max(2e-6)
}

const BALL: (Vec3, f32) = (Vec3::new(0.4, -0.1, 1.0), 0.6);

fn blocking(order: usize) -> Vec<f64> {
    let to = BALL.0.as_dvec3();
    circle(order, to.normalize(), (f64::from(BALL.1) / to.length()).asin())
}

#[test]
fn visibility_is_the_projection_of_a_circle() {
    let scene = scene(vec![spheres(&[BALL])], vec![sky(1.0)], &[(Vec3::ZERO, Vec3::Z); 30]);
    for order in 1..=8 {
        let cache = Cache::in_memory();
        let frame = scene.frame(0);
        let quality = Quality::fixed(4096);
        let (reference, quantity) = (&Reference::TRUTH, Quantity::Visibility { order: order as u8 });
        let request = Request { reference, quantity, scene: &scene, frame: &frame, quality: &quality, seed: 5 };
        let found = visibility(&request, &cache, &mut NoMeter).expect("one");
        let blocked = blocking(order);
        let (mut sum, count) = (0.0, order * order);
        for (at, (mean, variance)) in found.mean.iter().zip(&found.variance).enumerate() {
            let open = if at % count == 0 { (4.0 * PI).sqrt() } else { 0.0 };
            let z = (f64::from(*mean) - (open - blocked[at % count])) / f64::from(*variance).sqrt();
            assert!(z.abs() < 5.5, "order {order}, coefficient {}: z = {z}", at % count);
            sum += z * z;
        }
        let mean = sum / found.mean.len() as f64;
        assert!((0.6..1.25).contains(&mean), "order {order}: mean z² {mean}");
    }
}

#[test]
fn truncated_visibility_under_a_uniform_sky_has_its_closed_form() {
    let points: Vec<_> = normals(40).into_iter().filter(|n| n.z > 0.0).map(|n| (Vec3::ZERO, n)).collect();
    let scene = scene(vec![spheres(&[BALL])], vec![sky(1.0)], &points);
    for order in [1, 2, 4, 7] {
        let estimate = run(&format!("sh-visibility:{order}"), &scene, &Quality::fixed(4096), 3);
        let mut sum = 0.0;
        for (i, (_, normal)) in points.iter().enumerate() {
            let mut weights = vec![0.0; order * order];
            irradiance_weights(order, normal.as_dvec3().to_array(), &mut weights);
            let exact = 1.0 - blocking(order).iter().zip(&weights).map(|(b, w)| b * w).sum::<f64>();
            let z = z(&estimate, i, exact);
            assert!(z.abs() < 5.0, "order {order}, receiver {i}: z = {z}");
            sum += z;
        }
        assert!(sum.abs() < 4.0 * (points.len() as f64).sqrt(), "order {order}: {sum}");
    }
    // Nothing in the way: nothing is truncated.
    let open = support::scene(vec![], vec![sky(1.0)], &points);
    assert!(run("sh-visibility:2", &open, &Quality::fixed(1024), 3).mean.iter().all(|m| (m.x - 1.0).abs() < 1e-5));
}

/// A plate halfway under a square lamp: the visible share of the lamp's area, a matter of overlapping rectangles.
#[test]
fn mean_visibility_is_by_area_times_unoccluded_light() {
    let mut lamp = plate(2.0, 0.5);
    let Shape::Mesh(mesh) = std::sync::Arc::make_mut(&mut lamp.shape) else { unreachable!("a mesh") };
    mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let lamp = Object { emission: Rgb::splat(3.0).into(), ..lamp };
    let points: Vec<_> = (0..25).map(|i| (Vec3::new(i as f32 * 0.08 - 1.0, 0.1, 0.0), Vec3::Z)).collect();
    let scene = scene(vec![lamp, plate(1.0, 0.3)], vec![], &points);
    let estimate = run("mean-visibility", &scene, &Quality::fixed(1024), 2);
    let exact = |i: usize| {
        let at = |x: f64, y: f64| DVec3::new(0.5 * x, 0.5 * y, 2.0) - points[i].0.as_dvec3();
        let corners = [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)];
        // Seen from x the plate's shadow on the lamp's plane is of twice its size about −x.
        let overlap = |x: f64| ((2.0 * 0.3 - x).min(0.5) - (-2.0 * 0.3 - x).max(-0.5)).max(0.0);
        let shade = overlap(f64::from(points[i].0.x)) * overlap(f64::from(points[i].0.y));
        3.0 * analytic::polygon_over_receiver(&corners, DVec3::Z) * (1.0 - shade)
    };
    let all: Vec<f64> = (0..points.len()).map(|i| z(&estimate, i, exact(i))).collect();
    assert!(all.iter().all(|z| z.abs() < 5.0), "{all:?}");
    assert!(all.iter().sum::<f64>().abs() < 20.0, "{all:?}");
    // It is not the truth, which weighs the lamp's points by what they bring.
    let truth = run("truth", &scene, &Quality::fixed(4096), 2);
    assert!((0..points.len()).any(|i| z(&truth, i, exact(i)).abs() > 10.0));

    // Of a key light all points bring nearly the same.
    let key_scene = support::scene(vec![spheres(&[BALL])], vec![key(Vec3::new(0.3, 0.0, 1.0), 0.3, 2.0)], &points);
    let (mean, truth) = (
        run("mean-visibility", &key_scene, &Quality::fixed(4096), 2),
        run("truth", &key_scene, &Quality::fixed(4096), 2),
    );
    let largest = (0..points.len()).map(|i| (mean.mean[i].x - truth.mean[i].x).abs()).fold(0.0, f32::max);
    assert!(largest < 0.03 * 0.18 && truth.mean.iter().any(|m| m.x < 0.1), "{largest}");
}

#[test]
fn an_upper_sky_lights_a_wall_by_half() {
    let walls: Vec<_> = (0..20).map(|i| (Vec3::ZERO, Vec3::new((i as f32).cos(), (i as f32).sin(), 0.0))).collect();
    let scene = scene(vec![], vec![sky(1.0)], &walls);
    let estimate = run("upper-sky", &scene, &Quality::fixed(4096), 1);
    for i in 0..walls.len() {
        assert!(z(&estimate, i, 0.5).abs() < 5.0 && estimate.variance[i].x.sqrt() < 0.01, "{:?}", estimate.mean[i]);
    }
    // A white wall below a horizontal receiver that looks down gets light from above alone.
    let below = support::scene(vec![plate(-1.0, 500.0)], vec![sky(1.0)], &[(Vec3::ZERO, -Vec3::Z); 20]);
    let indirect =
        run_of(Quantity::Indirect { bounces: 1 }, "upper-sky", &below, &Quality::fixed(1024), 1).expect("one");
    assert!(indirect.mean.iter().all(|m| (m.x - 1.0).abs() < 0.01), "{:?}", indirect.mean[0]);
}

#[test]
fn what_is_left_out_emits_and_reflects_nothing_but_blocks() {
    let named = |name: &str, object: Object| Object { name: name.into(), ..object };
    let ground = named("ground", Object { albedo: Rgb::splat(0.5), ..plate(-1.0, 500.0) });
    let ball = named("ball", spheres(&[(Vec3::Z * 2.0, 1.0)]));
    let at = [(Vec3::ZERO, Vec3::Z), (Vec3::ZERO, -Vec3::Z)];
    let scene = scene(vec![ground, ball], vec![sky(1.0)], &at);
    let one = Quantity::Indirect { bounces: 1 };
    let of = |id: &str| run_of(one, id, &scene, &Quality::fixed(4096), 1).expect("an estimate");
    let (all, without) = (of("truth"), of("without:ground"));
    // Half the sky, less at most the ninth of it that the ball hides from the ground straight below.
    assert!((0.5 * 8.0 / 9.0..0.5).contains(&all.mean[1].x), "{:?}", all.mean[1]);
    let error = (all.variance[0].x + without.variance[0].x).sqrt();
    let [with, without_it] = [all.mean[0].x, without.mean[0].x];
    assert!(with > 5.0 * error && (with - without_it).abs() < 4.0 * error, "{with} {without_it} ± {error}");
    assert_eq!(without.mean[1], Rgb::ZERO);
    assert_eq!(of("without:ball,ground").mean[0], Rgb::ZERO);
    // The ground still hides the lower sky.
    let direct = run("without:ground", &scene, &Quality::fixed(256), 1);
    assert!(direct.mean[1].x.abs() < 0.01, "{:?}", direct.mean[1]);
}

/// A wall between receiver and lit floor: the floor's light passes as if it were not there, and the wall's own front adds.
#[test]
fn unoccluded_indirect_light_passes_through_what_is_between() {
    let floor = Object { albedo: Rgb::splat(0.8), ..plate(0.0, 1.0) };
    let mut screen = plate(0.5, 2.0);
    screen.albedo = Rgb::ZERO;
    let at: Vec<_> = normals(30).into_iter().filter(|n| n.z < -0.2).map(|n| (Vec3::new(0.1, 0.2, 1.0), n)).collect();
    let lights = || vec![key(Vec3::Z, 0.2, 5.0), sky(0.3)];
    let one = Quantity::Indirect { bounces: 1 };
    let of = |id: &str, objects: Vec<Object>| {
        run_of(one, id, &scene(objects, lights(), &at), &Quality::fixed(4096), 6).expect("an estimate")
    };
    // The screen does not shade the floor here: it stands between floor and receivers, and blocks the floor's sky.
    let blocked = of("truth", vec![floor.clone(), screen.clone()]);
    assert!(blocked.mean.iter().all(|m| m.x < 1e-3), "{:?}", blocked.mean);
    let seen = of("unoccluded-indirect", vec![floor.clone(), screen.clone()]);
    assert!(seen.mean.iter().all(|m| m.x < 0.05), "the screen shades the floor: {:?}", seen.mean);
    // A screen that casts nothing is no screen; one beside the light's way, but between floor and receiver, is passed.
    let screen = Object { shape: narrow().shape, ..screen };
    let (open, through) = (of("truth", vec![floor.clone()]), of("unoccluded-indirect", vec![floor, screen]));
    for i in 0..at.len() {
        let (a, b) = (open.mean[i].x, through.mean[i].x);
        assert!(
            (a - b).abs() < 0.03 * a.max(0.05) + 5.0 * (open.variance[i].x + through.variance[i].x).sqrt(),
            "{a} {b}"
        );
    }
}

/// A small plate close to the receiver.
fn narrow() -> Object {
    let mut plate = plate(0.95, 0.04);
    let Shape::Mesh(mesh) = std::sync::Arc::make_mut(&mut plate.shape) else { unreachable!("a mesh") };
    mesh.positions.iter_mut().for_each(|p| *p += Vec3::new(0.1, 0.2, 0.0));
    plate
}

#[test]
fn what_a_scene_or_quantity_has_no_reference_for_is_refused() {
    let lit = scene(vec![plate(0.0, 1.0)], vec![sky(1.0)], &[(Vec3::Z, Vec3::Z)]);
    let lamp = Object { emission: Rgb::ONE.into(), ..plate(2.0, 1.0) };
    let lamps = scene(vec![lamp], vec![], &[(Vec3::Z, Vec3::Z)]);
    let one = Quantity::Indirect { bounces: 1 };
    let refused = [
        (&lit, one, "sphere-proxies:4", "spheres reflect nothing"),
        (&lit, Quantity::Total, "sh-visibility:4", "direct and distant"),
        (&lit, Quantity::Direct, "mean-visibility", "emitting objects and key lights"),
        (&lit, Quantity::Direct, "unoccluded-indirect", "indirect light"),
        (&lit, Quantity::Direct, "without:nobody", "no object `nobody`"),
        (&lit, Quantity::Visibility { order: 4 }, "truth", "visibility"),
        (&lamps, Quantity::Direct, "sh-light:4", "no distant light"),
        (&lamps, Quantity::Direct, "sphere-proxies:4", "distant light alone"),
        (&lamps, Quantity::Direct, "sh-visibility:4+mean-visibility", "expected"),
    ];
    for (scene, quantity, id, why) in refused {
        let error = run_of(quantity, id, scene, &Quality::fixed(64), 1).expect_err(id);
        assert!(matches!(error, Error::NotServed { .. }) && error.to_string().contains(why), "{id}: {error}");
    }
}
