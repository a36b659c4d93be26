//! Closed boxes, open skies, and lights whose irradiance is known.

mod support;

use glam::Vec3;
use halflight_references::statistics::z_test;
use halflight_references::{Quality, analytic};
use halflight_scenes::Rgb;
use support::*;

const REFERENCES: [&str; 4] = ["truth", "sh-light:4", "sphere-proxies:8", "sphere-proxies:8:paper"];

fn at_origin(count: usize) -> Vec<(Vec3, Vec3)> {
    normals(count).into_iter().map(|normal| (Vec3::ZERO, normal)).collect()
}

#[test]
fn unit_surroundings_give_one() {
    let points = at_origin(300);
    let lights =
        [vec![sky(1.0)], vec![map(16, 8, |_, _| Rgb::ONE)], vec![sky(0.25), map(4, 2, |_, _| Rgb::splat(0.75))]];
    for lights in lights {
        let scene = scene(Vec::new(), lights, &points);
        for reference in REFERENCES {
            for quality in [Quality::default(), Quality::fixed(1024)] {
                let estimate = run(reference, &scene, &quality, 1);
                let summary = z_test(&estimate, &vec![Rgb::ONE; points.len()], &vec![true; points.len()]);
                assert!(
                    summary.mean.abs() <= summary.mean_limit() && summary.largest <= 4.5,
                    "{reference}: {summary:?}"
                );
                let worst = estimate.mean.iter().map(|m| (*m - Rgb::ONE).abs().max_element()).fold(0.0, f32::max);
                assert!(worst < 0.05, "{reference}: {worst}");
            }
        }
    }
}

#[test]
fn a_uniform_sky_alone_is_exact() {
    let points = at_origin(100);
    for reference in REFERENCES {
        for mean in run(reference, &scene(Vec::new(), vec![sky(1.0)], &points), &Quality::default(), 5).mean {
            assert!((mean - Rgb::ONE).abs().max_element() < 1e-5, "{reference}: {mean}");
        }
    }
}

#[test]
fn a_covered_hemisphere_gives_zero() {
    let inside = at_origin(100);
    let lights =
        || vec![sky(1.0), map(8, 4, |x, y| Rgb::splat((x + y) as f32)), key(Vec3::new(0.3, 0.2, 1.0), 0.2, 50.0)];
    // A plate so wide and near that what passes beside it carries 1e-10 of the irradiance; from below and above.
    let under: Vec<_> = (0..50).map(|i| (Vec3::new(i as f32 * 0.01, 0.3, 0.0), Vec3::Z)).collect();
    let above: Vec<_> = under.iter().map(|(p, n)| (*p + 0.02 * Vec3::Z, -*n)).collect();
    let cases = [
        (vec![spheres(&[(Vec3::new(0.1, 0.0, 0.0), 2.0)])], &inside, &["truth", "sh-light:4"][..]),
        (vec![ball(Vec3::new(0.1, 0.0, 0.0), 2.0, 24)], &inside, &["truth", "sh-light:4"]),
        (vec![plate(0.01, 1000.0)], &under, &["truth", "sh-light:4"]),
        (vec![plate(0.01, 1000.0)], &above, &["truth", "sh-light:4"]),
    ];
    for (objects, points, references) in cases {
        let scene = scene(objects, lights(), points);
        for reference in references {
            for mean in run(reference, &scene, &Quality::default(), 2).mean {
                assert_eq!(mean, Rgb::ZERO, "{reference} under {:?}", scene.objects[0].shape);
            }
        }
    }
}

#[test]
fn a_receiver_inside_a_proxy_sees_what_the_rule_leaves() {
    // Straight below the centre, inside: the sphere shrinks until it is tangent, and covers all. With the centre in the
    // plane nothing is left of it.
    let (low, level) = (Vec3::new(0.0, 0.0, -0.5), Vec3::ZERO);
    let scene = scene(vec![spheres(&[(Vec3::ZERO, 1.0)])], vec![sky(1.0)], &[(low, Vec3::Z), (level, Vec3::Z)]);
    for rule in ["continuous", "paper"] {
        let mean = run(&format!("sphere-proxies:8:{rule}"), &scene, &Quality::default(), 2).mean;
        assert_eq!(mean[0], Rgb::ZERO, "{rule}");
        assert!((mean[1] - Rgb::ONE).abs().max_element() < 1e-5, "{rule}: {}", mean[1]);
    }
    assert_eq!(run("sphere-proxies:8:off", &scene, &Quality::default(), 2).mean[0], Rgb::ZERO);
}

/// No self-hits: on its faces, a convex body sees the whole sky.
#[test]
fn a_convex_body_does_not_shadow_itself() {
    for scale in [1e-3f32, 1.0, 1e3] {
        for shift in [Vec3::ZERO, scale * Vec3::new(300.0, -1000.0, 200.0)] {
            let body = ball(shift, scale, 20);
            let halflight_scenes::Shape::Mesh(mesh) = &*body.shape else { panic!("a mesh") };
            let points: Vec<_> = (mesh.triangles.iter())
                .map(|triangle| {
                    let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
                    ((a + b + c) / 3.0, (b - a).cross(c - a).normalize())
                })
                .collect();
            let scene = scene(vec![body], vec![sky(1.0)], &points);
            let estimate = run("truth", &scene, &Quality::fixed(256), 6);
            let worst = estimate.mean.iter().map(|m| (m.x - 1.0).abs()).fold(0.0, f32::max);
            // Rounded corners far away make the body slightly concave.
            assert!(worst < if shift == Vec3::ZERO { 1e-5 } else { 0.05 }, "scale {scale}, at {shift}: {worst}");
        }
    }
}

#[test]
fn what_casts_no_shadow_does_not_block() {
    let mut roof = plate(0.01, 1000.0);
    roof.casts = false;
    let scene = scene(vec![roof], vec![sky(1.0)], &[(Vec3::ZERO, Vec3::Z)]);
    for reference in REFERENCES {
        assert!((run(reference, &scene, &Quality::default(), 2).mean[0].x - 1.0).abs() < 1e-5, "{reference}");
    }
}

#[test]
fn key_lights_give_their_closed_form() {
    let points = at_origin(400);
    // A sun, a lamp, a dome.
    for angular_radius in [0.004_65f32, 0.2, 1.0] {
        let direction = Vec3::new(0.4, -0.5, 0.6).normalize();
        let radiance = 1.0 / angular_radius.sin().powi(2);
        let scene = scene(Vec::new(), vec![key(direction, angular_radius, radiance)], &points);
        let expected: Vec<Rgb> = points
            .iter()
            .map(|(_, normal)| {
                let distance = 1.0 / f64::from(angular_radius).sin();
                let angle = f64::from(normal.dot(direction)).acos();
                Rgb::splat((f64::from(radiance) * analytic::sphere_over_receiver(distance, angle)) as f32)
            })
            .collect();
        let estimate = run("truth", &scene, &Quality::fixed(2048), 3);
        // f32 carries an angle's cosine at the horizon to 1e-7, which is all there is to see of a sun that sets.
        let lit: Vec<bool> = points.iter().map(|(_, n)| n.dot(direction) > angular_radius.sin()).collect();
        let summary = z_test(&estimate, &expected, &lit);
        assert!(summary.passes(0.01) && summary.count > 20, "{angular_radius}: {summary:?}");
        for ((mean, expected), (_, normal)) in estimate.mean.iter().zip(&expected).zip(&points) {
            let error = (*mean - *expected).abs().max_element();
            assert!(error < 0.02, "{angular_radius}, cosine {}: {mean} for {expected}", normal.dot(direction));
        }
    }
}

#[test]
fn one_bright_texel_lights_its_own_side() {
    // Texel (2, 1) of 8 × 4: azimuth 90°–135°, polar angle 45°–90°.
    let scene = |lights| {
        let sides = [Vec3::new(-0.5, 1.0, 0.5), Vec3::new(-0.5, -1.0, 0.5), Vec3::new(1.0, 0.2, 0.0), -Vec3::Z];
        scene(Vec::new(), lights, &sides.map(|normal| (Vec3::ZERO, normal.normalize())))
    };
    let lit = scene(vec![map(8, 4, |x, y| Rgb::new(1.0, 2.0, 0.5) * f32::from((x, y) == (2, 1)))]);
    let estimate = run("truth", &lit, &Quality::fixed(1 << 14), 4);
    // Midpoint sums in f64 over the texel.
    let steps = 400;
    for (i, normal) in normals_of(&lit).into_iter().enumerate() {
        let mut sum = 0.0;
        for a in 0..steps {
            for b in 0..steps {
                let theta = (45.0 + 45.0 * (f64::from(a) + 0.5) / f64::from(steps)).to_radians();
                let phi = (90.0 + 45.0 * (f64::from(b) + 0.5) / f64::from(steps)).to_radians();
                let d = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
                let cos: f64 = (0..3).map(|k| d[k] * f64::from(normal[k])).sum();
                sum += cos.max(0.0) * theta.sin();
            }
        }
        let cell = (45f64.to_radians() / f64::from(steps)).powi(2);
        let expected = (sum * cell / std::f64::consts::PI) as f32;
        let (mean, error) = (estimate.mean[i], estimate.standard_error()[i]);
        for (channel, colour) in [1.0, 2.0, 0.5].into_iter().enumerate() {
            let difference = (mean[channel] - colour * expected).abs();
            assert!(difference <= 4.0 * error[channel] + 1e-7, "{normal}: {mean} ± {error} for {expected}");
        }
    }
    assert!(estimate.mean[0].x > 0.05 && estimate.mean[3] == Rgb::ZERO);
}

fn normals_of(scene: &halflight_scenes::Scene) -> Vec<Vec3> {
    scene.frame(0).receivers.normal.clone()
}

/// The size of a scene is not the size of its parts: what lies far away must not loosen what is near.
#[test]
fn a_far_blocker_changes_nothing_near() {
    let points: Vec<(Vec3, Vec3)> = (0..64).map(|i| (Vec3::new(0.02 * i as f32, 0.0, 0.0), Vec3::Z)).collect();
    let near = spheres(&[(Vec3::new(0.3, 0.0, 0.5), 0.49)]);
    let far = ball(Vec3::new(1e6, 0.0, 0.0), 1.0, 4);
    let alone = scene(vec![near.clone()], vec![sky(1.0)], &points);
    let both = scene(vec![near, far], vec![sky(1.0)], &points);
    let [alone, both] = [alone, both].map(|scene| run("truth", &scene, &Quality::fixed(1024), 3));
    for (a, b) in alone.mean.iter().zip(&both.mean) {
        assert!((*a - *b).abs().max_element() < 2e-3, "{a} {b}");
    }
}
