//! The sum of shadows against the formula in f64, its limits, and what the hierarchy adds.

use std::f64::consts::PI;

use glam::{DVec3, Quat, Vec3};
use halflight_scenes::{Pose, Shape, Sphere};
use proptest::prelude::*;

use super::*;
use crate::sites::{on_sphere, sites};

/// `ElementShadow` of Bunnell 2005, as printed there, in double precision; nothing within the disc's radius.
fn by_hand(site: &Site, position: Vec3, normal: Vec3) -> f64 {
    let to = (site.position - position).as_dvec3();
    let square = to.length_squared();
    if square <= f64::from(site.area) / PI {
        return 0.0;
    }
    let v = to / square.sqrt();
    let clamped = |normal: Vec3, factor: f64| (factor * normal.as_dvec3().dot(v)).clamp(0.0, 1.0);
    let disc = 1.0 - 1.0 / (f64::from(site.area) / PI / square + 1.0).sqrt();
    disc * clamped(site.normal, 1.0) * clamped(normal, 4.0)
}

fn flat(sites: &[Site], (position, normal): (Vec3, Vec3)) -> f64 {
    sites.iter().map(|site| by_hand(site, position, normal)).sum()
}

/// Elements that cast after that many passes among themselves.
fn forest(objects: &[Vec<Site>], most: usize, passes: usize, opening: f32) -> Forest {
    let mut forest = Forest::default();
    for sites in objects {
        let tree = forest.plant(sites, most);
        forest.fit(tree, sites);
    }
    forest.cast(passes, opening);
    forest
}

fn shadows(forest: &Forest, points: &[(Vec3, Vec3)], opening: f32) -> Vec<f32> {
    let groups = points.chunks(LANES);
    groups
        .flat_map(|group| forest.shadow(&Points::new(group.iter().copied()), opening).0[..group.len()].to_vec())
        .collect()
}

/// Numbers from 0 to 1 without pattern.
fn noise(i: usize) -> f32 {
    let x = (i as u32).wrapping_mul(0x9E37_79B9) ^ 0x85EB_CA6B;
    let x = (x ^ (x >> 15)).wrapping_mul(0x2C1B_3C6D);
    let x = (x ^ (x >> 12)).wrapping_mul(0x297A_2D39);
    (x ^ (x >> 15)) as f32 / u32::MAX as f32
}

fn direction(i: usize) -> Vec3 {
    let [x, y, z] = [0, 1, 2].map(|axis| noise(3 * i + axis + 1_000_000) - 0.5);
    Vec3::new(x, y, z).normalize_or(Vec3::Z)
}

/// Points with normals in a cube about the origin.
fn points(count: usize, half: f32) -> Vec<(Vec3, Vec3)> {
    let inside = |i: usize| half * (2.0 * Vec3::from([0, 1, 2].map(|axis| noise(3 * i + axis))) - 1.0);
    (0..count).map(|i| (inside(i), direction(i))).collect()
}

fn ball(center: Vec3, radius: f32, count: usize) -> Vec<Site> {
    on_sphere(Sphere { center, radius }, count).collect()
}

/// A bowl, closed at its foot: a ball whose upper part is turned inward, so that it stands in its own shadow.
fn bowl() -> Vec<Site> {
    let mut sites = ball(Vec3::new(0.1, 0.0, 0.0), 1.0, 1024);
    for site in sites.iter_mut().filter(|site| site.position.z > 0.2) {
        site.position.z = 0.4 - site.position.z;
        site.normal = Vec3::new(-site.normal.x, -site.normal.y, site.normal.z);
    }
    sites
}

#[test]
fn one_disc_shadows_by_the_formula_from_its_back_alone() {
    let site = Site { position: Vec3::new(0.3, -0.2, 1.5), normal: Vec3::new(0.6, 0.0, 0.8), area: 0.7 };
    let points = points(200, 3.0);
    let forest = forest(&[vec![site]], 1, 0, 0.5);
    let found = shadows(&forest, &points, 0.5);
    for (found, &(position, normal)) in found.iter().zip(&points) {
        let expected = by_hand(&site, position, normal);
        assert!((f64::from(*found) - expected).abs() < 2e-7 + 1e-5 * expected, "{found} for {expected}");
        let before = site.normal.dot(position - site.position) > 0.0;
        assert!(!before || *found == 0.0, "{position} is before the disc");
    }
    assert!(found.iter().filter(|shadow| **shadow > 1e-3).count() > 20);
    // One metre straight below a disc of area π: 1 − 1/√2.
    let above = Site { position: Vec3::Z, normal: Vec3::Z, area: std::f32::consts::PI };
    let below = shadows(&super::tests::forest(&[vec![above]], 1, 0, 0.5), &[(Vec3::ZERO, Vec3::Z)], 0.5)[0];
    assert!((f64::from(below) - (1.0 - 0.5f64.sqrt())).abs() < 1e-7, "{below}");
}

#[test]
fn a_hierarchy_that_is_always_opened_is_the_flat_sum() {
    let objects = [bowl(), ball(Vec3::new(2.0, 0.5, 0.3), 0.7, 300), Vec::new(), ball(Vec3::X, 1e-6, 16)];
    let forest = forest(&objects, 4096, 0, 0.0);
    assert_eq!(forest.elements(), 1024 + 300 + 16);
    let points = points(300, 3.0);
    let sites = objects.concat();
    for (found, point) in shadows(&forest, &points, 0.0).iter().zip(&points) {
        let expected = flat(&sites, *point);
        assert!((f64::from(*found) - expected).abs() < 1e-5, "{found} for {expected}");
    }
}

/// Root mean square and greatest error, and nodes summed a point, against the flat sum.
fn opened(opening: f32) -> (f64, f64, f64) {
    let objects = [bowl(), ball(Vec3::new(2.0, 0.5, 0.3), 0.7, 1000)];
    let forest = forest(&objects, 4096, 0, opening);
    let (points, sites) = (points(2000, 3.0), objects.concat());
    let found = shadows(&forest, &points, opening);
    let errors: Vec<f64> = found
        .iter()
        .zip(&points)
        .map(|(found, point)| f64::from(accessibility(*found)) - (1.0 - flat(&sites, *point)).max(0.0))
        .collect();
    let square = errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    let terms: u32 = points
        .chunks(LANES)
        .flat_map(|group| forest.shadow(&Points::new(group.iter().copied()), opening).1[..group.len()].to_vec())
        .sum();
    let worst = errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
    (square.sqrt(), worst, f64::from(terms) / points.len() as f64)
}

#[test]
fn groups_err_little_and_less_the_later_they_stand_for_elements() {
    let bounds = [(0.1, 1e-3, 3e-3), (0.25, 6e-3, 0.025), (0.5, 0.02, 0.1)];
    let mut before = f64::INFINITY;
    for (opening, mean, most) in bounds {
        let (rms, worst, terms) = opened(opening);
        println!("opening {opening}: rms {rms:.2e}, worst {worst:.2e}, {terms:.0} nodes a point");
        assert!(rms < mean && worst < most, "opening {opening}: rms {rms:e}, worst {worst:e}");
        assert!(terms < before, "opening {opening}: {terms} nodes a point");
        before = terms;
    }
}

/// Finely cut surfaces that hide a hemisphere leave `1 − ∫₀¹ min(1, 4u) du = 1/8`.
#[test]
fn rooms_leave_an_eighth() {
    let wall = |turn: Quat| {
        let side = 48;
        let at = |i: usize| (i as f32 + 0.5) / side as f32 * 2.0 - 1.0;
        let area = 4.0 / (side * side) as f32;
        let site = move |i: usize| Vec3::new(at(i % side), at(i / side), 1.0);
        (0..side * side).map(move |i| Site { position: turn * site(i), normal: turn * Vec3::Z, area }).collect()
    };
    let quarter = std::f32::consts::FRAC_PI_2;
    let turns = [0.0, 1.0, 2.0, 3.0].map(|turns| Quat::from_rotation_x(turns * quarter));
    let sides = [1.0, 3.0].map(|turns| Quat::from_rotation_y(turns * quarter));
    let room: Vec<Vec<Site>> = turns.into_iter().chain(sides).map(wall).collect();
    let around = vec![ball(Vec3::ZERO, 1.0, 1024)];
    let inside: Vec<(Vec3, Vec3)> = (0..100).map(|i| (Vec3::ZERO, direction(i))).collect();
    for (name, objects) in [("ball", around), ("room", room.clone())] {
        for passes in [0, 1] {
            for shadow in shadows(&forest(&objects, 4096, passes, 0.0), &inside, 0.0) {
                let left = accessibility(shadow);
                assert!((left - 0.125).abs() < 0.02, "{name}: {left}");
            }
        }
    }
    // From outside, the near walls cast nothing and the far ones as far as they are seen through them; before a wall alone: nothing.
    let alone = forest(&room[..1], 4096, 0, 0.0);
    assert_eq!(shadows(&alone, &[(Vec3::new(0.0, 0.0, 1.5), Vec3::NEG_Z)], 0.0), [0.0]);
}

#[test]
fn a_second_pass_is_never_darker_than_the_first_nor_a_third_than_both() {
    // Two shells around each other, the inner one in the dark.
    let objects = [bowl(), ball(Vec3::new(0.0, 0.0, 0.1), 1.4, 500), ball(Vec3::new(0.2, 0.0, 0.3), 0.3, 200)];
    let points = points(500, 1.5);
    let [first, second, third] = [0, 1, 2].map(|passes| shadows(&forest(&objects, 4096, passes, 0.0), &points, 0.0));
    let mut lighter = 0;
    for ((first, second), third) in first.iter().zip(&second).zip(&third) {
        assert!(*second <= first * (1.0 + 1e-6), "second {second}, first {first}");
        assert!(*third >= second * (1.0 - 1e-6) && *third <= first * (1.0 + 1e-6), "{first} {second} {third}");
        lighter += usize::from(*second < 0.9 * first);
    }
    assert!(lighter > 100, "{lighter} of {} points are lighter", points.len());
}

#[test]
fn elements_on_a_point_shadow_nothing_there_and_all_is_finite() {
    let sites = vec![
        Site { position: Vec3::ZERO, normal: Vec3::Z, area: 1.0 },
        Site { position: Vec3::new(1e-30, 0.0, 0.0), normal: Vec3::Z, area: 1.0 },
        Site { position: Vec3::new(1e-18, 0.0, 1e-18), normal: Vec3::X, area: 0.0 },
        Site { position: Vec3::ZERO, normal: Vec3::ZERO, area: 0.0 },
        Site { position: Vec3::new(0.0, 1e6, 1e6), normal: Vec3::Y, area: 1e12 },
    ];
    for opening in [0.0, 0.5, 2.0] {
        let forest = forest(&[sites.clone(), vec![sites[3]]], 4096, 2, opening);
        let points = [(Vec3::ZERO, Vec3::Z), (Vec3::ZERO, Vec3::ZERO), (Vec3::splat(1e15), Vec3::X)];
        let found = shadows(&forest, &points, opening);
        assert!(found.iter().all(|shadow| shadow.is_finite() && *shadow >= 0.0), "{found:?}");
        let far = by_hand(&sites[4], Vec3::ZERO, Vec3::Z);
        assert!(opening > 0.0 || (f64::from(found[0]) - far).abs() < 1e-6, "{} for {far}", found[0]);
    }
}

#[test]
fn merged_vertices_keep_area_and_stay_within_the_count() {
    let sites = ball(Vec3::X, 1.0, 1024);
    for most in [1, 2, 100, 1023, 1024, 5000] {
        let forest = forest(std::slice::from_ref(&sites), most, 0, 0.5);
        assert_eq!(forest.elements(), most.min(1024));
        let leaves = (0..forest.skip.len()).filter(|node| forest.is_leaf(*node));
        let area: f32 = leaves.map(|leaf| forest.area[leaf]).sum();
        assert!((area - 4.0).abs() < 1e-4 && (forest.area[0] - 4.0).abs() < 1e-4, "{area}");
    }
}

#[test]
fn nodes_lie_within_their_parents() {
    let forest = forest(&[bowl(), ball(Vec3::X, 0.2, 99)], 700, 0, 0.5);
    for parent in (0..forest.skip.len()).filter(|node| !forest.is_leaf(*node)) {
        for below in parent + 1..forest.skip[parent] as usize {
            let reach = forest.position[below].distance(forest.position[parent]) + forest.area[below].sqrt();
            assert!(reach <= forest.extent[parent] * (1.0 + 1e-5), "{below} below {parent}");
        }
    }
}

proptest! {
    #[test]
    fn scaling_all_lengths_changes_nothing(exponent in -3.0f32..3.0, seed in 0usize..1000, opening in 0.0f32..1.0) {
        let factor = 10f32.powf(exponent);
        let scaled = |sites: &Vec<Site>| -> Vec<Site> {
            sites.iter().map(|s| Site { position: factor * s.position, area: factor * factor * s.area, ..*s }).collect()
        };
        let objects = [ball(Vec3::ZERO, 1.0, 100), ball(Vec3::new(0.5, 0.9, 0.8), 0.6, 60)];
        let points: Vec<_> = points(seed + 16, 2.0).split_off(seed);
        let larger: Vec<_> = points.iter().map(|(position, normal)| (factor * *position, *normal)).collect();
        // Groups open at a distance, and a point may lie there but for rounding.
        let opening = if opening < 0.5 { 0.0 } else { opening };
        let bound = if opening > 0.0 { 0.02 } else { 2e-5 };
        let here = shadows(&forest(&objects, 4096, 1, opening), &points, opening);
        let there = shadows(&forest(&objects.map(|sites| scaled(&sites)), 4096, 1, opening), &larger, opening);
        for (here, there) in here.iter().zip(&there) {
            prop_assert!((here - there).abs() <= bound * (1.0 + here), "{} and {}", here, there);
        }
    }

    #[test]
    fn neighbours_in_other_lanes_change_no_bit(seed in 0usize..10_000, opening in 0.0f32..2.0, lane in 0..LANES) {
        let forest = forest(&[ball(Vec3::ZERO, 1.0, 100), ball(Vec3::X, 0.5, 60)], 80, 1, 0.5);
        let points: Vec<_> = points(seed + 16, 2.0).split_off(seed);
        let together = shadows(&forest, &points, opening);
        let alone = shadows(&forest, &points[lane..=lane], opening);
        prop_assert_eq!(alone[0].to_bits(), together[lane].to_bits());
    }

    #[test]
    fn rigid_motion_of_all_changes_nothing(seed in 0usize..1000, angle in 0.0f32..6.0) {
        let pose = Pose { rotation: Quat::from_axis_angle(direction(seed), angle), translation: 3.0 * direction(seed + 1) };
        let spheres = Shape::Spheres(vec![Sphere { center: Vec3::X, radius: 0.8 }]);
        let points: Vec<_> = points(seed + 16, 2.0).split_off(seed);
        let moved: Vec<_> = points.iter().map(|(p, n)| (pose.point(*p), pose.direction(*n))).collect();
        let here = shadows(&forest(&[sites(&spheres, Pose::IDENTITY, 200)], 200, 1, 0.0), &points, 0.0);
        let there = shadows(&forest(&[sites(&spheres, pose, 200)], 200, 1, 0.0), &moved, 0.0);
        for (here, there) in here.iter().zip(&there) {
            prop_assert!((here - there).abs() <= 1e-4, "{} and {}", here, there);
        }
    }
}

/// The oracle itself: far away a disc is `A/2πr²` of a hemisphere.
#[test]
fn far_discs_cover_their_solid_angle() {
    let site = Site { position: Vec3::new(0.0, 0.0, 1e3), normal: Vec3::Z, area: 2.0 };
    let share = by_hand(&site, Vec3::ZERO, DVec3::Z.as_vec3());
    assert!((share / (2.0 / (2.0 * PI * 1e6)) - 1.0).abs() < 1e-5, "{share}");
}
