//! Worlds of instances against worlds of the same geometry written out, and refitted bodies against new ones.

use std::sync::Arc;

use glam::{DQuat, Quat, Vec3};
use halflight_trace::{Body, Geometry, Hit, Instance, Ray, Sphere, World};

use crate::oracle::{Random, closed_mesh};

struct Mesh(Vec<Vec3>, Vec<[u32; 3]>);

impl Mesh {
    fn geometry(&self) -> Geometry<'_> {
        Geometry::Triangles { positions: &self.0, triangles: &self.1 }
    }

    fn moved(&self, by: impl Fn(Vec3) -> Vec3) -> Mesh {
        Mesh(self.0.iter().map(|p| by(*p)).collect(), self.1.clone())
    }
}

#[derive(Clone, Copy)]
struct Motion {
    rotation: Quat,
    translation: Vec3,
}

impl Motion {
    fn random(random: &mut Random, distance: f32) -> Self {
        let rotation = Quat::from_axis_angle(random.direction(), 6.0 * random.unit());
        Motion { rotation, translation: random.point() * distance }
    }

    /// In `f64`, rounded once: what is written out is then as true as `f32` can be.
    fn point(&self, p: Vec3) -> Vec3 {
        let rotation: DQuat = self.rotation.as_dquat().normalize();
        (rotation * p.as_dvec3() + self.translation.as_dvec3()).as_vec3()
    }
}

/// Two levels, and the same written out: a resting mesh (geometry 0), moved ones (1..), moved spheres (last).
fn worlds(random: &mut Random, count: u32) -> [World; 2] {
    let mesh = |random: &mut Random| {
        let (positions, triangles) = closed_mesh(10, random);
        Mesh(positions, triangles)
    };
    let resting = mesh(random);
    let meshes = [mesh(random), mesh(random)];
    let spheres: Vec<Sphere> = (0..9).map(|_| Sphere { center: random.point(), radius: 0.2 }).collect();
    let motions: Vec<Motion> = (0..=count).map(|_| Motion::random(random, 5.0)).collect();
    let bodies = meshes.each_ref().map(|mesh| Arc::new(Body::build(&[mesh.geometry()])));
    let round = Arc::new(Body::build(&[Geometry::Spheres(&spheres)]));

    let instances = (0..=count).zip(&motions).map(|(i, motion)| {
        let body = if i == count { &round } else { &bodies[i as usize % 2] };
        Instance::new(body.clone(), motion.rotation, motion.translation, i + 1)
    });
    let instances: Vec<Instance> = instances.collect();
    let two_levels = World::new(Arc::new(Body::build(&[resting.geometry()])), &instances);

    let moved = (0..count as usize).map(|i| meshes[i % 2].moved(|p| motions[i].point(p)));
    let moved: Vec<Mesh> = moved.collect();
    let carried = |s: &Sphere| Sphere { center: motions[count as usize].point(s.center), ..*s };
    let spheres: Vec<Sphere> = spheres.iter().map(carried).collect();
    let meshes = [&resting].into_iter().chain(&moved).map(Mesh::geometry);
    let geometries: Vec<Geometry> = meshes.chain([Geometry::Spheres(&spheres)]).collect();
    [two_levels, World::build(&geometries)]
}

fn rays(random: &mut Random, count: usize) -> Vec<Ray> {
    let mut ray = |i: usize| {
        let t_max = if i.is_multiple_of(4) { 3.0 } else { f32::INFINITY };
        let (origin, target) = (random.point() * 7.0, random.point() * 4.0);
        Ray { origin, direction: (target - origin).normalize(), t_min: 0.0, t_max }
    };
    (0..count).map(&mut ray).collect()
}

fn closest(world: &World, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    world.closest(rays, &mut hits);
    hits
}

fn occluded(world: &World, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![false; rays.len()];
    world.occluded(rays, &mut blocked);
    blocked
}

#[test]
fn instances_are_hit_as_if_they_were_written_out() {
    let mut random = Random(11);
    let (mut hit, mut apart) = (0, 0);
    for count in [0, 1, 2, 20] {
        let [two_levels, flat] = worlds(&mut random, count);
        let rays = rays(&mut random, 20_000);
        let (ours, theirs) = (closest(&two_levels, &rays), closest(&flat, &rays));
        let blocked = occluded(&two_levels, &rays);
        for ((ours, theirs), blocked) in ours.iter().zip(&theirs).zip(blocked) {
            assert_eq!(blocked, ours.is_some());
            match (ours, theirs) {
                (None, None) => {}
                (Some(a), Some(b)) if (a.geometry, a.primitive) == (b.geometry, b.primitive) => {
                    hit += 1;
                    // Distances grow as the ray grazes: by rounding over the cosine, at most.
                    assert!((a.t - b.t).abs() < 1e-3, "{a:?} {b:?}");
                    apart += usize::from((a.t - b.t).abs() > 1e-5);
                }
                // Neighbours at an edge, or a silhouette grazed.
                _ => apart += 1,
            }
        }
    }
    assert!(hit > 10_000, "only {hit} hits");
    // Rays that pass an edge within 1e-6 of their way: less than one expected.
    assert!(apart <= 5, "{apart} rays of 80000 differ");
}

#[test]
fn a_world_without_instances_gives_the_bits_of_its_body() {
    let mut random = Random(12);
    let (positions, triangles) = closed_mesh(12, &mut random);
    let geometry = [Geometry::Triangles { positions: &positions, triangles: &triangles }];
    let body = Arc::new(Body::build(&geometry));
    let turned = Instance::new(body.clone(), Quat::IDENTITY, Vec3::ZERO, 0);
    let nothing = Arc::new(Body::build(&[]));
    let [alone, at_rest] = [World::new(body, &[]), World::new(nothing, &[turned])];
    let rays = rays(&mut random, 5000);
    assert_eq!(closest(&alone, &rays), closest(&World::build(&geometry), &rays));
    // An instance that has not moved gets the very rays.
    assert_eq!(closest(&alone, &rays), closest(&at_rest, &rays));
}

/// Rays from inside, aimed at vertices and edges: the body's space has no other holes than the world's.
#[test]
fn turned_and_moved_meshes_do_not_leak() {
    let mut random = Random(13);
    for scale in [1e-3f32, 1.0, 1e3] {
        let (mut positions, triangles) = closed_mesh(16, &mut random);
        positions.iter_mut().for_each(|p| *p *= scale);
        let body = Arc::new(Body::build(&[Geometry::Triangles { positions: &positions, triangles: &triangles }]));
        for distance in [0.0, 1.0, 1e3] {
            let motion = Motion::random(&mut random, distance * scale);
            let instance = Instance::new(body.clone(), motion.rotation, motion.translation, 0);
            let world = World::new(Arc::new(Body::build(&[])), &[instance]);
            let mut rays = Vec::new();
            for corners in &triangles {
                let [a, b, _] = corners.map(|i| positions[i as usize]);
                for weight in [0.0, 0.5, random.unit()] {
                    let origin = motion.point(random.point() * 0.2 * scale);
                    let direction = (motion.point(a + (b - a) * weight) - origin).normalize();
                    rays.push(Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY });
                }
            }
            let escaped = occluded(&world, &rays).iter().filter(|blocked| !**blocked).count();
            assert_eq!(escaped, 0, "of {} rays at scale {scale}, {distance} away", rays.len());
        }
    }
}

/// A cube fills its box: what hits its rim must not be lost where the box of the instance is rounded.
#[test]
fn the_box_of_an_instance_cuts_nothing_off() {
    let positions: Vec<Vec3> =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let geometry = [Geometry::Triangles { positions: &positions, triangles: &triangles }];
    let body = Arc::new(Body::build(&geometry));
    let mut random = Random(14);
    let mut grazing = 0;
    for turned in (0..300).map(|i| i % 2 == 1) {
        let Motion { rotation, translation } = Motion::random(&mut random, 100.0);
        let motion = Motion { rotation: if turned { rotation } else { Quat::IDENTITY }, translation };
        let instance = Instance::new(body.clone(), motion.rotation, motion.translation, 0);
        let world = World::new(Arc::new(Body::build(&[])), &[instance]);
        // What the body itself says to the ray that its space sees.
        let alone = World::new(body.clone(), &[]);
        let back = motion.rotation.as_dquat().normalize().inverse();
        let rays = (0..40).map(|i| {
            let [a, b, _] = triangles[i % 12].map(|i| motion.point(positions[i as usize]));
            let target = a + (b - a) * random.unit() + random.point() * 1e-5;
            let origin = random.point() * 300.0;
            Ray { origin, direction: (target - origin).normalize(), t_min: 0.0, t_max: f32::INFINITY }
        });
        let rays: Vec<Ray> = rays.collect();
        let carried = rays.iter().map(|ray| Ray {
            origin: (back * (ray.origin.as_dvec3() - motion.translation.as_dvec3())).as_vec3(),
            direction: (back * ray.direction.as_dvec3()).as_vec3(),
            ..*ray
        });
        let expected = occluded(&alone, &carried.collect::<Vec<_>>());
        grazing += expected.iter().filter(|blocked| !**blocked).count();
        assert_eq!(occluded(&world, &rays), expected);
    }
    assert!(grazing > 1000, "only {grazing} rays pass the rim");
}

#[test]
fn an_instance_without_a_place_is_never_hit() {
    let body = Arc::new(Body::build(&[Geometry::Spheres(&[Sphere { center: Vec3::ZERO, radius: 1.0 }])]));
    let lost = [(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0), Vec3::ZERO), (Quat::IDENTITY, Vec3::splat(f32::INFINITY))];
    let mut instances: Vec<_> = lost.iter().map(|(r, t)| Instance::new(body.clone(), *r, *t, 0)).collect();
    let empty = Arc::new(Body::build(&[]));
    instances.push(Instance::new(empty.clone(), Quat::IDENTITY, Vec3::ZERO, 7));
    let ray = [Ray { origin: Vec3::Z * 3.0, direction: -Vec3::Z, t_min: 0.0, t_max: f32::INFINITY }];
    assert_eq!(closest(&World::new(empty.clone(), &instances), &ray), [None]);
    instances.push(Instance::new(body, Quat::IDENTITY, Vec3::ZERO, 3));
    assert_eq!(closest(&World::new(empty, &instances), &ray)[0].map(|hit| (hit.geometry, hit.t)), Some((3, 2.0)));
}

fn bent(mesh: &Mesh, angle: f32) -> Mesh {
    mesh.moved(|p| Quat::from_rotation_z(angle * p.z) * p)
}

#[test]
fn a_refitted_body_is_hit_like_a_new_one() {
    let mut random = Random(15);
    let (positions, triangles) = closed_mesh(24, &mut random);
    let rest = Mesh(positions, triangles);
    let spheres: Vec<Sphere> = (0..50).map(|_| Sphere { center: random.point() * 2.0, radius: 0.1 }).collect();
    let body = Body::build(&[rest.geometry(), Geometry::Spheres(&spheres)]);
    let moved = bent(&rest, 0.5);
    let drifted: Vec<Sphere> = spheres.iter().map(|s| Sphere { center: s.center * 1.2, radius: 0.15 }).collect();
    let geometries = [moved.geometry(), Geometry::Spheres(&drifted)];
    let refit = body.refit(&geometries).expect("a gentle bend");
    let rays = rays(&mut random, 20_000);
    let [ours, theirs] = [World::new(Arc::new(refit), &[]), World::build(&geometries)].map(|w| closest(&w, &rays));
    let tied = |a: &Option<Hit>, b: &Option<Hit>| a.map(|hit| hit.t) == b.map(|hit| hit.t);
    assert!(ours.iter().zip(&theirs).all(|(a, b)| tied(a, b)), "the same triangles and spheres, in another tree");
    assert!(ours.iter().flatten().count() > 2000);
}

#[test]
fn a_body_is_not_refitted_to_other_primitives_or_past_its_use() {
    let mut random = Random(16);
    let (positions, triangles) = closed_mesh(24, &mut random);
    let rest = Mesh(positions, triangles);
    let body = Body::build(&[rest.geometry()]);
    assert!(body.refit(&[rest.geometry()]).is_some());
    assert!(Body::build(&[]).refit(&[]).is_some());
    let fewer = Mesh(rest.0.clone(), rest.1[1..].to_vec());
    let more = Mesh(rest.0.clone(), [&rest.1[..], &[[0, 5, 9]]].concat());
    let flat = Mesh(rest.0.clone(), [&[[0, 0, 1]], &rest.1[1..]].concat());
    for other in [fewer, more, flat] {
        assert!(body.refit(&[other.geometry()]).is_none());
    }
    assert!(body.refit(&[]).is_none());
    let mut shuffled = rest.0.clone();
    shuffled.rotate_right(rest.0.len() / 3);
    shuffled.iter_mut().for_each(|p| *p += random.point());
    assert!(body.refit(&[Mesh(shuffled, rest.1.clone()).geometry()]).is_none());
    assert!(body.refit(&[bent(&rest, 6.0).geometry()]).is_none());
}
