//! Sphere sets of meshes whose shape is known, by all makers.

#[allow(dead_code, reason = "shared with the other tests")]
mod shapes;

use glam::{Quat, Vec3};
use halflight_proxies::{MAX_COUNT, Maker, SphereSet, sphere_set};
use halflight_scenes::{Mesh, Sphere};
use proptest::prelude::*;
use shapes::{capsule, cuboid, icosphere, mesh, moved, square, torus};

fn set_of(mesh: &Mesh, count: usize) -> SphereSet {
    sphere_set(mesh, count, &mut |_, _| true).expect("nobody cancels")
}

fn set_by(maker: Maker, mesh: &Mesh, count: usize) -> SphereSet {
    maker.make(mesh, count, &mut |_, _| true).expect("nobody cancels")
}

/// The first position or midpoint that no sphere holds.
fn bare_point(mesh: &Mesh, spheres: &[Sphere]) -> Option<Vec3> {
    let midpoint = |t: &[u32; 3]| t.iter().map(|i| mesh.positions[*i as usize]).sum::<Vec3>() / 3.0;
    let holds = |s: &Sphere, p: &Vec3| s.center.as_dvec3().distance(p.as_dvec3()) <= f64::from(s.radius);
    let mut points = mesh.positions.iter().copied().chain(mesh.triangles.iter().map(midpoint));
    points.find(|p| !spheres.iter().any(|s| holds(s, p)))
}

fn sound(set: &SphereSet) -> bool {
    let sound = |s: &Sphere| s.center.is_finite() && s.radius.is_finite() && s.radius > 0.0;
    set.spheres.iter().all(sound) && set.outside_volume.is_finite() && set.outside_volume >= 0.0
}

fn any_mesh() -> impl Strategy<Value = Mesh> {
    let shape = prop_oneof![
        Just(icosphere(2)),
        (0.1_f32..0.45).prop_map(|tube| torus(1.0, tube)),
        (0.0_f32..4.0, 0.1_f32..1.0).prop_map(|(length, radius)| capsule(length, radius)),
        [0.001_f32..1.0, 0.001_f32..1.0, 0.001_f32..1.0].prop_map(|sides| cuboid(Vec3::from(sides))),
        Just(square()),
        prop::collection::vec([-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0].prop_map(Vec3::from), 3..40).prop_map(
            |positions| {
                let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                mesh(positions, triangles)
            }
        ),
    ];
    let turn = [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0].prop_map(|t| Quat::from_scaled_axis(3.0 * Vec3::from(t)));
    let by = [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0].prop_map(|t| 100.0 * Vec3::from(t));
    (shape, -6_i32..6, turn, by).prop_map(|(shape, scale, turn, by)| moved(shape, 10.0_f32.powi(scale), turn, by))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(10) })]

    #[test]
    fn every_position_and_midpoint_is_bounded(
        mesh in any_mesh(), count in 1_usize..24, maker in prop::sample::select(&Maker::ALL),
    ) {
        let set = set_by(maker, &mesh, count);
        prop_assert!(!set.spheres.is_empty() && set.spheres.len() <= count);
        prop_assert!(sound(&set), "{set:?}");
        prop_assert_eq!(bare_point(&mesh, &set.spheres), None);
    }
}

#[test]
fn a_sphere_is_its_own_set() {
    let set = set_of(&icosphere(4), 1);
    let sphere = set.spheres[0];
    assert!(sphere.center.length() < 0.02 && (sphere.radius - 1.0).abs() < 0.02, "{sphere:?}");
    assert!(set.outside_volume < 0.05, "{}", set.outside_volume);
}

/// Least outside volume of `n ≥ 2` balls along the axis of a capsule, relative to its volume. The inner ones share the
/// cylinder evenly: half a length `b` reaches the volume `4/3 π b³`. The end ones go through the tip and the last
/// circle shared; what they leave outside is half such a ring and a ball's half without the capsule's end.
fn least_outside(n: usize, length: f64, a: f64) -> f64 {
    let (pi, half, inner) = (std::f64::consts::PI, 0.5 * length, n as f64 - 2.0);
    let outside = |last_circle: f64| {
        let b = if n > 2 { last_circle / inner } else { 0.0 };
        let tip = half + a;
        let center = 0.5 * (tip * tip - a * a - last_circle * last_circle) / (tip - last_circle);
        let ring = 2.0 / 3.0 * pi * (center - last_circle).powi(3);
        let end = pi * a * a * (half - center) + 2.0 / 3.0 * pi * a.powi(3);
        let ends = ring + 2.0 / 3.0 * pi * (tip - center).powi(3) - end;
        2.0 * ends + inner * 4.0 / 3.0 * pi * b.powi(3)
    };
    let circles = (0..1000).map(|i| if n > 2 { f64::from(i) / 1000.0 * half } else { 0.0 });
    circles.map(outside).fold(f64::INFINITY, f64::min) / (pi * a * a * length + 4.0 / 3.0 * pi * a.powi(3))
}

#[test]
fn a_capsule_is_cut_as_well_as_by_hand() {
    let capsule = capsule(6.0, 0.5);
    for count in [2, 3, 4, 6] {
        let (found, least) = (f64::from(set_of(&capsule, count).outside_volume), least_outside(count, 6.0, 0.5));
        assert!((found / least - 1.0).abs() < 0.07, "{count}: {found} against {least}");
    }
}

#[test]
fn outside_volume_falls_with_the_count() {
    let torus = torus(1.0, 0.3);
    let outside = [1, 8, 24].map(|count| set_of(&torus, count).outside_volume);
    assert!(outside.windows(2).all(|pair| pair[1] < 0.6 * pair[0]), "{outside:?}");
}

#[test]
fn large_triangles_are_not_left_bare() {
    let set = set_of(&cuboid(Vec3::new(1.0, 1.0, 1.0)), 64);
    let grid = (0..21 * 21).map(|i| Vec3::new((i / 21) as f32 / 20.0 - 0.5, (i % 21) as f32 / 20.0 - 0.5, 0.5));
    let near = |p: &Vec3| set.spheres.iter().any(|s| s.center.distance(*p) < s.radius + 0.02);
    assert!(grid.clone().all(|p| near(&p)), "{:?}", grid.clone().find(|p| !near(p)));
}

#[test]
fn flat_and_tiny_meshes_have_finite_sets() {
    let point = mesh(vec![Vec3::ONE; 3], vec![[0, 1, 2]]);
    let line = mesh(vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], vec![[0, 1, 2]]);
    let plate = moved(cuboid(Vec3::new(1.0, 1.0, 1e-4)), 1.0, Quat::from_rotation_x(0.5), Vec3::ZERO);
    let dust = moved(icosphere(1), 1e-20, Quat::IDENTITY, Vec3::ZERO);
    let huge = moved(icosphere(1), 1e37, Quat::IDENTITY, Vec3::ZERO);
    let triangle = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let mut meshes = vec![point, line, plate, dust, huge, triangle, square()];
    meshes.push(pair(icosphere(1), moved(icosphere(1), 0.1, Quat::IDENTITY, 50.0 * Vec3::X)));
    let makers = [(Maker::Variational, 1), (Maker::Variational, 7), (Maker::Octree, 7), (Maker::Medial, 7)];
    for (mesh, (maker, count)) in meshes.iter().flat_map(|mesh| makers.map(|maker| (mesh, maker))) {
        let set = set_by(maker, mesh, count);
        assert!((1..=count).contains(&set.spheres.len()) && sound(&set), "{maker:?}: {:?}", set.outside_volume);
        assert_eq!(bare_point(mesh, &set.spheres), None, "{maker:?}");
    }
    assert!(Maker::ALL.iter().all(|maker| set_by(*maker, &Mesh::default(), 3) == SphereSet::default()));
}

/// One ball around a square of side 2 is the very ball that its outside volume is measured against.
#[test]
fn a_mesh_without_interior_is_measured_against_its_bounding_ball() {
    let set = set_of(&square(), 1);
    assert!((set.outside_volume - 1.0).abs() < 0.01, "{}", set.outside_volume);
}

#[test]
fn any_count_is_taken() {
    let line = mesh(vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], vec![[0, 1, 2]]);
    for (mesh, count) in [(torus(1.0, 0.2), 200), (line.clone(), 0), (line, usize::MAX)] {
        for maker in Maker::ALL {
            let set = set_by(maker, &mesh, count);
            assert!(sound(&set) && (1..=count.clamp(1, MAX_COUNT)).contains(&set.spheres.len()), "{maker:?} {count}");
            assert_eq!(bare_point(&mesh, &set.spheres), None, "{maker:?}");
        }
    }
}

/// Two meshes as one.
fn pair(mut one: Mesh, other: Mesh) -> Mesh {
    let first = one.positions.len() as u32;
    one.positions.extend(other.positions);
    one.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
    one
}

#[test]
fn octants_of_a_cube_are_held_by_the_spheres_through_their_corners() {
    let set = set_by(Maker::Octree, &cuboid(Vec3::ONE), 8);
    assert_eq!(set.spheres.len(), 8);
    for sphere in &set.spheres {
        assert!((sphere.center.abs() - 0.25).length() < 1e-4, "{sphere:?}");
        assert!((sphere.radius - 0.25 * 3.0_f32.sqrt()).abs() < 1e-4, "{sphere:?}");
    }
    // Seven of eight octants are one too many for a set of seven: the cube stays whole.
    let whole = set_by(Maker::Octree, &cuboid(Vec3::ONE), 7);
    assert!(whole.spheres.len() == 1 && (whole.spheres[0].radius - 0.5 * 3.0_f32.sqrt()).abs() < 1e-4);
}

/// The ball around the cube around the unit ball: 3√3 times its volume.
#[test]
fn one_cell_of_an_octree_has_the_outside_volume_of_its_closed_form() {
    let outside = set_by(Maker::Octree, &icosphere(4), 1).outside_volume;
    assert!((outside / (27.0_f32.sqrt() - 1.0) - 1.0).abs() < 0.02, "{outside}");
}

/// Of two balls far apart, the medial set of two spheres is the two.
#[test]
fn separate_balls_are_their_own_medial_set() {
    let balls = pair(icosphere(3), moved(icosphere(3), 0.5, Quat::IDENTITY, 3.0 * Vec3::X));
    let mut set = set_by(Maker::Medial, &balls, 2);
    set.spheres.sort_by(|a, b| a.radius.total_cmp(&b.radius));
    for (sphere, (center, radius)) in set.spheres.iter().zip([(3.0 * Vec3::X, 0.5), (Vec3::ZERO, 1.0)]) {
        assert!(sphere.center.distance(center) < 0.05 && (sphere.radius - radius).abs() < 0.05, "{sphere:?}");
    }
}

#[test]
fn competitors_leave_more_outside_and_the_octree_most() {
    let torus = torus(1.0, 0.3);
    let [variational, octree, medial] = Maker::ALL.map(|maker| set_by(maker, &torus, 16).outside_volume);
    assert!(variational < medial && 4.0 * medial < octree, "{variational} {medial} {octree}");
}

#[test]
fn threads_do_not_change_a_bit() {
    let mesh = torus(1.0, 0.3);
    for maker in Maker::ALL {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| set_by(maker, &mesh, 24))
        };
        assert_eq!(with(1), with(2), "{maker:?}");
    }
}

#[test]
fn cancelling_ends_the_search_at_any_step() {
    let mesh = icosphere(1);
    let mut steps = Vec::new();
    sphere_set(&mesh, 4, &mut |done, total| {
        steps.push((done, total));
        true
    });
    assert!(steps.is_sorted() && steps.last().is_some_and(|(done, total)| done == total), "{steps:?}");
    for limit in [0, 1, steps.len() / 2, steps.len() - 1] {
        let mut calls = 0;
        let cancelled = sphere_set(&mesh, 4, &mut |_, _| {
            calls += 1;
            calls <= limit
        });
        assert_eq!((cancelled, calls), (None, limit + 1));
    }
}
