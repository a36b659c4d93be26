//! Meshes with known volumes.

use std::collections::HashMap;
use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use halflight_scenes::Mesh;

pub(crate) fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh { positions, triangles, ..Mesh::default() }
}

/// The unit sphere as an icosahedron whose triangles are split in four `levels` times.
pub(crate) fn icosphere(levels: usize) -> Mesh {
    let t = 0.5 * (1.0 + 5.0_f32.sqrt());
    let corner = |i: usize| {
        let (one, t) = (if i & 1 == 0 { -1.0 } else { 1.0 }, if i & 2 == 0 { -t } else { t });
        let p = [Vec3::new(0.0, one, t), Vec3::new(one, t, 0.0), Vec3::new(t, 0.0, one)][i / 4];
        p.normalize()
    };
    let mut positions: Vec<Vec3> = (0..12).map(corner).collect();
    let edge = |a: usize, b: usize| positions[a].distance(positions[b]) < 1.1;
    let mut triangles = Vec::new();
    for (a, b, c) in (0..12).flat_map(|a| (a + 1..12).flat_map(move |b| (b + 1..12).map(move |c| (a, b, c)))) {
        if edge(a, b) && edge(b, c) && edge(c, a) {
            let outwards = positions[a].cross(positions[b]).dot(positions[c]) > 0.0;
            triangles.push(if outwards { [a as u32, b as u32, c as u32] } else { [a as u32, c as u32, b as u32] });
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    mesh(positions, triangles)
}

/// A surface over a grid of `n` by `m` vertices that closes around both ways.
fn closed_grid(n: u32, m: u32, at: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let positions = (0..n * m).map(|i| at((i / m) as f32 * TAU / n as f32, (i % m) as f32 * TAU / m as f32)).collect();
    let quad = |i: u32, j: u32| {
        let at = |i: u32, j: u32| i % n * m + j % m;
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    };
    let triangles = (0..n).flat_map(|i| (0..m).flat_map(move |j| quad(i, j))).collect();
    mesh(positions, triangles)
}

/// A torus around z with radii `ring` and `tube`.
pub(crate) fn torus(ring: f32, tube: f32) -> Mesh {
    closed_grid(64, 32, |u, v| {
        let distance = ring + tube * v.cos();
        Vec3::new(distance * u.cos(), distance * u.sin(), tube * v.sin())
    })
}

/// A capsule along x: the unit icosphere scaled to `radius`, its halves pulled apart by `length`.
pub(crate) fn capsule(length: f32, radius: f32) -> Mesh {
    let sphere = icosphere(3);
    let pull = |p: &Vec3| *p * radius + Vec3::X * (0.5 * length * if p.x > 0.0 { 1.0 } else { -1.0 });
    mesh(sphere.positions.iter().map(pull).collect(), sphere.triangles)
}

/// A box of the given sides around the origin.
pub(crate) fn cuboid(sides: Vec3) -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32 - 0.5, (i >> 1 & 1) as f32 - 0.5, (i >> 2) as f32 - 0.5) * sides;
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    mesh((0..8).map(corner).collect(), triangles)
}

/// A square of side 2 in the plane z = 0.
pub(crate) fn square() -> Mesh {
    let positions =
        vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::ONE.with_z(0.0), Vec3::new(-1.0, 1.0, 0.0)];
    mesh(positions, vec![[0, 1, 2], [0, 2, 3]])
}

/// A mesh scaled, turned and moved.
pub(crate) fn moved(mut mesh: Mesh, scale: f32, turn: Quat, by: Vec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = turn * (*p * scale) + by);
    mesh
}

/// Volume by the divergence theorem, in double precision.
pub(crate) fn volume(mesh: &Mesh) -> f64 {
    let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles.iter().map(|[a, b, c]| corner(*a).cross(corner(*b)).dot(corner(*c)) / 6.0).sum()
}
