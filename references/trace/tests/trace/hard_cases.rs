//! Rays and geometry that are hard on rounding, on the builder or on the stack.

use crate::oracle::{Random, closed_mesh};
use glam::Vec3;
use halflight_trace::{Geometry, Ray, Sphere, World};

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
}

fn blocked(world: &World, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    world.occluded(rays, &mut blocked);
    blocked
}

/// Rays from inside a closed mesh aimed at its vertices, at edges and along axes: none may escape.
fn leaks(scale: f32, offset: Vec3) -> (usize, usize) {
    let mut random = Random(7);
    let (mut positions, triangles) = closed_mesh(24, &mut random);
    positions.iter_mut().for_each(|p| *p = *p * scale + offset);
    let world = World::build(&[Geometry::Triangles { positions: &positions, triangles: &triangles }]);
    let mut rays = Vec::new();
    for corners in &triangles {
        let [a, b, _] = corners.map(|i| positions[i as usize]);
        for weight in [0.0, 0.5, random.unit()] {
            let origin = offset + random.point() * 0.2 * scale;
            rays.push(ray(origin, (a + (b - a) * weight - origin).normalize()));
            rays.push(ray(offset, (a + (b - a) * weight - offset).normalize()));
        }
    }
    let escaped = blocked(&world, &rays).iter().filter(|b| !**b).count();
    (escaped, rays.len())
}

#[test]
fn a_closed_mesh_does_not_leak_at_its_edges() {
    for scale in [1e-18, 1e-4, 1.0, 1e4] {
        let (escaped, total) = leaks(scale, Vec3::ZERO);
        assert_eq!(escaped, 0, "of {total} rays at scale {scale}");
        let (escaped, total) = leaks(scale, Vec3::new(3.0, -5.0, 2.0) * scale);
        assert_eq!(escaped, 0, "of {total} rays off the origin at scale {scale}");
    }
}

/// Distances to planes that a ray is nearly parallel to are beyond all others.
#[test]
fn a_closed_mesh_does_not_leak_where_f32_ends() {
    for scale in [1e12, 1e15, 1e17] {
        let mut random = Random(9);
        let (mut positions, triangles) = closed_mesh(24, &mut random);
        positions.iter_mut().for_each(|p| *p *= scale);
        let world = World::build(&[Geometry::Triangles { positions: &positions, triangles: &triangles }]);
        let rays = (0..3000).map(|i| {
            let slant = random.point() * [0.0, 1e-20, 1e-9][i % 3];
            ray(random.point() * 0.2 * scale, (Vec3::AXES[i / 3 % 3] + slant).normalize())
        });
        let escaped = blocked(&world, &rays.collect::<Vec<_>>()).iter().filter(|b| !**b).count();
        assert_eq!(escaped, 0, "at scale {scale}");
    }
}

#[test]
fn what_is_too_far_away_is_left_out() {
    let mut random = Random(10);
    let (mut positions, triangles) = closed_mesh(24, &mut random);
    positions.iter_mut().for_each(|p| *p *= 1e28);
    let world = World::build(&[Geometry::Triangles { positions: &positions, triangles: &triangles }]);
    assert_eq!(blocked(&world, &[ray(Vec3::ZERO, Vec3::Z)]), [false]);
}

#[test]
fn rays_along_the_axes_hit_shared_edges_and_faces_of_boxes() {
    // A grid in the plane z = 0: axis-parallel rays run exactly through vertices and along box faces.
    let side = 9;
    let positions: Vec<Vec3> = (0..side * side).map(|i| Vec3::new((i % side) as f32, (i / side) as f32, 0.0)).collect();
    let quads = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| y * side + x));
    let triangles: Vec<[u32; 3]> =
        quads.flat_map(|i| [[i, i + 1, i + side + 1], [i, i + side + 1, i + side]]).collect();
    let world = World::build(&[Geometry::Triangles { positions: &positions, triangles: &triangles }]);
    let rays: Vec<Ray> = positions.iter().map(|p| ray(*p + Vec3::Z, -Vec3::Z)).collect();
    assert_eq!(blocked(&world, &rays), vec![true; rays.len()]);
}

#[test]
fn hundreds_of_coincident_triangles_overflow_nothing() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let triangles = vec![[0, 1, 2]; 1000];
    let world = World::build(&[Geometry::Triangles { positions: &positions, triangles: &triangles }]);
    let rays = [ray(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z), ray(Vec3::new(0.8, 0.8, 1.0), -Vec3::Z)];
    assert_eq!(blocked(&world, &rays), [true, false]);
    let mut hits = [None; 2];
    world.closest(&rays, &mut hits);
    assert_eq!(hits[0].unwrap().t, 1.0);
}

#[test]
fn a_single_triangle_is_hit_from_both_sides_and_nowhere_else() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let world = World::build(&[Geometry::Triangles { positions: &positions, triangles: &[[0, 1, 2]] }]);
    let mut random = Random(8);
    for _ in 0..1000 {
        let target = (random.point() * 2.0).with_z(0.0);
        let origin = target + random.point() + Vec3::Z * 2.0 * (random.unit() - 0.5).signum();
        let inside = target.x.min(target.y).min(1.0 - target.x - target.y);
        if inside.abs() > 1e-4 {
            assert_eq!(blocked(&world, &[ray(origin, (target - origin).normalize())]), [inside > 0.0], "{target}");
        }
    }
}

#[test]
fn an_empty_world_blocks_nothing() {
    let rays = [ray(Vec3::ZERO, Vec3::Z)];
    let flat =
        Geometry::Triangles { positions: &[Vec3::ZERO, Vec3::Z, Vec3::Z * 2.0], triangles: &[[0, 1, 2], [0, 1, 1]] };
    for world in [World::build(&[]), World::build(&[Geometry::Spheres(&[])]), World::build(&[flat])] {
        assert_eq!(blocked(&world, &rays), [false]);
        let mut hits = [None];
        world.closest(&rays, &mut hits);
        assert_eq!(hits, [None]);
    }
}

#[test]
fn what_is_not_proper_is_never_hit_and_harms_nothing() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY), Vec3::X * 2.0];
    let triangles = [[0, 1, 3], [0, 1, 4], [0, 1, 5], [1, 1, 2], [0, 1, 2]];
    let spheres = [
        Sphere { center: Vec3::splat(f32::NAN), radius: 1.0 },
        Sphere { center: Vec3::ZERO, radius: -1.0 },
        Sphere { center: Vec3::ZERO, radius: f32::INFINITY },
        Sphere { center: Vec3::ZERO, radius: 0.0 },
    ];
    let world = World::build(&[
        Geometry::Triangles { positions: &positions, triangles: &triangles },
        Geometry::Spheres(&spheres),
    ]);
    let rays = [
        ray(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z),
        ray(Vec3::new(-0.2, 0.2, 1.0), -Vec3::Z),
        ray(Vec3::splat(f32::NAN), Vec3::Z),
        ray(Vec3::new(0.2, 0.2, 1.0), Vec3::splat(f32::NAN)),
        ray(Vec3::new(0.2, 0.2, 1.0), Vec3::ZERO),
    ];
    let mut hits = [None; 5];
    world.closest(&rays, &mut hits);
    assert_eq!(hits.map(|hit| hit.map(|hit| hit.primitive)), [Some(4), None, None, None, None]);
    assert_eq!(blocked(&world, &rays), [true, false, false, false, false]);
}

#[test]
fn spheres_far_and_huge_keep_their_surface() {
    // Thin silhouettes at a distance: the angular radius in closed form decides.
    for (distance, radius) in [(1e5f32, 1.0f32), (1.0, 1e-4), (1e4, 9.99e3)] {
        let world = World::build(&[Geometry::Spheres(&[Sphere { center: Vec3::Z * distance, radius }])]);
        let limit = (f64::from(radius) / f64::from(distance)).asin();
        for (fraction, expected) in [(0.999, true), (1.001, false)] {
            let angle = limit * fraction;
            let direction = Vec3::new(angle.sin() as f32, 0.0, angle.cos() as f32);
            assert_eq!(blocked(&world, &[ray(Vec3::ZERO, direction)]), [expected], "{distance} {radius} {fraction}");
        }
        let mut hits = [None];
        world.closest(&[ray(Vec3::ZERO, Vec3::Z)], &mut hits);
        let t = f64::from(hits[0].unwrap().t);
        let expected = f64::from(distance) - f64::from(radius);
        assert!((t - expected).abs() <= 1e-6 * expected, "{t} for {expected}");
    }
}

#[test]
fn from_within_a_sphere_the_far_side_is_hit() {
    let world = World::build(&[Geometry::Spheres(&[Sphere { center: Vec3::X, radius: 2.0 }])]);
    let mut hits = [None; 2];
    world.closest(&[ray(Vec3::ZERO, Vec3::X), ray(Vec3::ZERO, -Vec3::X)], &mut hits);
    assert_eq!(hits.map(|hit| hit.unwrap().t), [3.0, 1.0]);
}
