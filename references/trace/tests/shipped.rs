//! Shipped meshes, small, large and far away: closed ones hold every ray, and no surface blocks its own receivers.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock};

use glam::{DVec3, Quat, Vec3};
use halflight_scenes::{Mesh, Shape, find};
use halflight_trace::{Body, Geometry, Hit, Instance, Ray, World, clearance, clearance_of_point};

#[path = "trace/oracle.rs"]
#[expect(dead_code, reason = "shared with the other tests")]
mod oracle;
use oracle::Random;

const MESHES: [(&str, &str); 4] = [
    ("teapot-sunset", "teapot"),
    ("bunny-studio", "bunny"),
    ("dino-elephant-courtyard", "dino"),
    ("dino-elephant-courtyard", "elephant"),
];

/// Loaded once: scenes hold more than their meshes.
fn shipped() -> impl Iterator<Item = (&'static str, &'static Mesh)> {
    static LOADED: LazyLock<Vec<Arc<Shape>>> = LazyLock::new(|| {
        let load = |(scene, name): &(&str, &str)| {
            let scene = find(scene).unwrap();
            scene.objects.iter().find(|object| object.name == *name).unwrap().shape.clone()
        };
        MESHES.iter().map(load).collect()
    });
    MESHES.iter().zip(&*LOADED).map(|((_, name), shape)| {
        let Shape::Mesh(mesh) = &**shape else { panic!("{name} is a mesh") };
        (*name, mesh)
    })
}

/// A mesh at a scale and a distance, with the farthest that it gets from the origin.
struct Placed {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    diameter: f32,
    reach: f32,
    name: String,
}

impl Placed {
    fn new(name: &str, mesh: &Mesh, scale: f32, distance: f32) -> Self {
        let reach = |positions: &[Vec3]| positions.iter().map(|p| p.length()).fold(0.0, f32::max);
        let center = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len() as f32;
        let centered: Vec<Vec3> = mesh.positions.iter().map(|p| (*p - center) * scale).collect();
        let diameter = 2.0 * reach(&centered);
        let away = Vec3::new(0.6, -0.64, 0.48) * distance * diameter;
        let positions: Vec<Vec3> = centered.iter().map(|p| *p + away).collect();
        let name = format!("{name} of diameter {diameter}, {distance} diameters away");
        Placed { triangles: mesh.triangles.clone(), diameter, reach: reach(&positions), positions, name }
    }

    /// At every scale, then far away.
    fn all(name: &str, mesh: &Mesh) -> [Self; 4] {
        [(1e-3, 0.0), (1.0, 0.0), (1e3, 0.0), (1.0, 1e3)].map(|(scale, away)| Placed::new(name, mesh, scale, away))
    }

    fn body(&self) -> Body {
        Body::build(&[Geometry::Triangles { positions: &self.positions, triangles: &self.triangles }])
    }

    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Unit normal in `f64`; nothing for what rounding has left without area.
    fn normal(&self, triangle: usize) -> Option<DVec3> {
        let [a, b, c] = self.corners(triangle).map(Vec3::as_dvec3);
        (b - a).cross(c - a).try_normalize()
    }

    /// Whether anything of a triangle lies above the plane of another.
    fn rises_above(&self, triangle: usize, plane: usize, normal: DVec3) -> bool {
        let through = self.corners(plane)[0].as_dvec3();
        // Products of differences are rounded themselves, twice over.
        let rounding = 1e-14 * f64::from(self.reach);
        self.corners(triangle).iter().any(|p| (p.as_dvec3() - through).dot(normal) > rounding)
    }

    /// A random triangle with area, and its normal.
    fn pick(&self, random: &mut Random) -> (usize, DVec3) {
        loop {
            let triangle = (random.unit() * self.triangles.len() as f32) as usize;
            if let Some(normal) = self.normal(triangle) {
                return (triangle, normal);
            }
        }
    }
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
}

fn closest(world: &World, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    world.closest(rays, &mut hits);
    hits
}

fn is_closed(mesh: &Mesh) -> bool {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.entry([*from.min(to), *from.max(to)]).or_default()[usize::from(from < to)] += 1;
        }
    }
    edges.values().all(|directions| *directions == [1, 1])
}

/// Points well inside: halfway between where a ray enters a closed mesh and where it leaves again.
fn inside(placed: &Placed, world: &World, random: &mut Random) -> Vec<Vec3> {
    let center = placed.positions.iter().sum::<Vec3>() / placed.positions.len() as f32;
    let mut points = Vec::new();
    while points.len() < 50 {
        let start = center + random.direction() * placed.diameter;
        let direction = (center + random.point() * 0.3 * placed.diameter - start).normalize();
        let Some(enters) = closest(world, &[ray(start, direction)])[0] else { continue };
        let beyond = Ray { t_min: enters.t + 1e-3 * placed.diameter, ..ray(start, direction) };
        let Some(leaves) = closest(world, &[beyond])[0] else { continue };
        let outward = placed.normal(leaves.primitive as usize).is_some_and(|n| n.dot(direction.as_dvec3()) > 0.0);
        if outward && leaves.t - enters.t > 0.05 * placed.diameter {
            points.push(start + direction * ((enters.t + leaves.t) / 2.0));
        }
    }
    points
}

#[test]
fn closed_meshes_do_not_leak() {
    let mut closed = 0;
    for (name, mesh) in shipped().filter(|(_, mesh)| is_closed(mesh)) {
        closed += 1;
        for placed in Placed::all(name, mesh) {
            let mut random = Random(21);
            let world = World::new(Arc::new(placed.body()), &[]);
            let points = inside(&placed, &world, &mut random);
            let mut aimed = |i: usize| {
                let from = points[i % points.len()];
                let [a, b, _] = placed.corners((random.unit() * placed.triangles.len() as f32) as usize);
                let target = [a, a.lerp(b, 0.5), a.lerp(b, random.unit()), from + random.direction()][i / 50 % 4];
                ray(from, (target - from).normalize())
            };
            let rays: Vec<Ray> = (0..20_000).map(&mut aimed).collect();
            let mut blocked = vec![false; rays.len()];
            world.occluded(&rays, &mut blocked);
            let escaped = blocked.iter().filter(|blocked| !**blocked).count();
            assert_eq!(escaped, 0, "of {} rays, {}", rays.len(), placed.name);
        }
    }
    assert_eq!(closed, 3, "all but the teapot");
}

/// A direction above the plane, grazing ones included.
fn leaving(random: &mut Random, normal: DVec3) -> Vec3 {
    loop {
        let sideways = random.direction().as_dvec3();
        let raised = sideways - normal * (sideways.dot(normal) - f64::from(random.unit().powi(4)));
        let direction = raised.normalize().as_vec3();
        // Above the plane for sure, whatever rounding does to the direction.
        if direction.as_dvec3().dot(normal) > 1e-6 {
            return direction;
        }
    }
}

/// Weighted as receivers are.
fn point_on([a, b, c]: [Vec3; 3], random: &mut Random) -> Vec3 {
    let root = random.unit().sqrt();
    let [v, w] = [root * random.unit(), 1.0 - root];
    a * (1.0 - v - w) + b * v + c * w
}

#[test]
fn surfaces_do_not_block_their_own_receivers() {
    for (name, mesh) in shipped() {
        for placed in Placed::all(name, mesh) {
            let mut random = Random(22);
            let world = World::new(Arc::new(placed.body()), &[]);
            let (mut rays, mut planes) = (Vec::new(), Vec::new());
            for _ in 0..20_000 {
                let (triangle, normal) = placed.pick(&mut random);
                let position = point_on(placed.corners(triangle), &mut random);
                let start = position + clearance(placed.reach) * normal.as_vec3();
                rays.push(ray(start, leaving(&mut random, normal)));
                planes.push((triangle, normal));
            }
            let hits = closest(&world, &rays);
            // Neither the triangle itself nor a neighbour across a convex edge: nothing of them lies above its plane.
            let wrong = hits.iter().zip(&planes).filter(|(hit, (plane, normal))| {
                hit.is_some_and(|hit| !placed.rises_above(hit.primitive as usize, *plane, *normal))
            });
            assert_eq!(wrong.count(), 0, "of {} receivers, {}", rays.len(), placed.name);
        }
    }
}

#[test]
fn moved_surfaces_do_not_block_their_own_receivers() {
    for (name, mesh) in shipped() {
        for (scale, distance) in [(1e-3, 1.0), (1.0, 0.0), (1e3, 3.0), (1.0, 1e3)] {
            let mut random = Random(23);
            let placed = Placed::new(name, mesh, scale, 0.0);
            let rotation = Quat::from_axis_angle(random.direction(), 6.0 * random.unit());
            let translation = random.direction() * distance * placed.diameter;
            let instance = Instance::new(Arc::new(placed.body()), rotation, translation, 0);
            let world = World::new(Arc::new(Body::build(&[])), &[instance]);
            let reach = placed.reach + translation.length();
            let (mut rays, mut planes) = (Vec::new(), Vec::new());
            for _ in 0..10_000 {
                let (triangle, normal) = placed.pick(&mut random);
                // Posed in `f32`, as receivers are.
                let corners = placed.corners(triangle).map(|p| rotation * p + translation);
                let turned = rotation.as_dquat().normalize() * normal;
                let start = point_on(corners, &mut random) + clearance(reach) * turned.as_vec3();
                rays.push(ray(start, leaving(&mut random, turned)));
                planes.push((triangle, normal));
            }
            let hits = closest(&world, &rays);
            let wrong = hits.iter().zip(&planes).filter(|(hit, (plane, normal))| {
                hit.is_some_and(|hit| !placed.rises_above(hit.primitive as usize, *plane, *normal))
            });
            assert_eq!(wrong.count(), 0, "{name}, scale {scale}, moved by {distance}");
        }
    }
}

/// Receivers at vertices start off along the mean normal: nothing that meets there lies above all of its faces.
#[test]
fn convex_vertices_are_not_blocked_by_their_faces() {
    for (name, mesh) in shipped() {
        for placed in Placed::all(name, mesh) {
            let mut random = Random(24);
            let world = World::new(Arc::new(placed.body()), &[]);
            let mut faces = vec![Vec::new(); placed.positions.len()];
            for (triangle, corners) in placed.triangles.iter().enumerate() {
                corners.iter().for_each(|vertex| faces[*vertex as usize].push(triangle));
            }
            let (mut rays, mut vertices) = (Vec::new(), Vec::new());
            for (vertex, around) in faces.iter().enumerate() {
                let Some(normals) = around.iter().map(|f| placed.normal(*f)).collect::<Option<Vec<_>>>() else {
                    continue;
                };
                let up = mesh.normals[vertex].as_dvec3();
                let direction = leaving(&mut random, up);
                let above = |d: DVec3, least: f64| normals.iter().all(|n| n.dot(d) > least);
                if !normals.is_empty() && above(up, 0.1) && above(direction.as_dvec3(), 1e-6) {
                    let start = placed.positions[vertex] + clearance(placed.reach) * mesh.normals[vertex];
                    rays.push(ray(start, direction));
                    vertices.push(vertex);
                }
            }
            assert!(rays.len() > 100, "{} receivers, {}", rays.len(), placed.name);
            let own = |hit: &Hit, vertex: usize| faces[vertex].contains(&(hit.primitive as usize));
            let hits = closest(&world, &rays);
            let wrong = hits.iter().zip(&vertices).filter(|(hit, vertex)| hit.is_some_and(|hit| own(&hit, **vertex)));
            assert_eq!(wrong.count(), 0, "of {} receivers, {}", rays.len(), placed.name);
        }
    }
}

/// Triangles about as large as the point's distance from the origin: of larger ones only their object's reach knows.
#[test]
fn a_given_point_is_not_blocked_by_the_plane_that_it_was_measured_on() {
    let mut random = Random(25);
    for scale in [1e-3f32, 1.0, 1e3] {
        let height = scale * (1.0 + random.unit());
        let corner = |x: f32, y: f32| Vec3::new(x * scale, y * scale, height);
        let positions = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)];
        let world = World::build(&[Geometry::Triangles { positions: &positions, triangles: &[[0, 1, 2]] }]);
        let receiver = |_| {
            let point = (random.point() * scale).with_z(height);
            ray(point + clearance_of_point(point) * Vec3::Z, leaving(&mut random, DVec3::Z))
        };
        let rays: Vec<Ray> = (0..5000).map(receiver).collect();
        assert_eq!(closest(&world, &rays).iter().flatten().count(), 0);
    }
}
