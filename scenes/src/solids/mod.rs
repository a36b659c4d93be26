//! Closed meshes by formula, about the origin, normals outwards.

mod blob;

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use crate::{Mesh, mesh};

pub(crate) use blob::{Capsule, blob, nearness};

/// A box of a size, each side cut into cells.
pub(crate) fn block(size: Vec3, cells: [u32; 3]) -> Mesh {
    let mut points = Points::default();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in [0, cells[axis]] {
            for (i, j) in (0..cells[u]).flat_map(|i| (0..cells[v]).map(move |j| (i, j))) {
                let mut corner = |di: u32, dj: u32| {
                    let mut at = [0; 3];
                    (at[axis], at[u], at[v]) = (end, i + di, j + dj);
                    points.index(at, || (grid(at, cells) - 0.5) * size)
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                match end {
                    0 => triangles.extend([[a, c, b], [a, d, c]]),
                    _ => triangles.extend([[a, b, c], [a, c, d]]),
                }
            }
        }
    }
    points.mesh(triangles)
}

fn grid(at: [u32; 3], cells: [u32; 3]) -> Vec3 {
    Vec3::from_array([0, 1, 2].map(|axis| at[axis] as f32 / cells[axis] as f32))
}

/// A cylinder about z from z = 0 to `height`, cut into `sides` around and `rings` along.
pub(crate) fn cylinder(radius: f32, height: f32, sides: u32, rings: u32) -> Mesh {
    let around = |i: u32| Vec2::from_angle(std::f32::consts::TAU * i as f32 / sides as f32) * radius;
    let mut positions: Vec<Vec3> = Vec::new();
    for ring in 0..=rings {
        let z = height * ring as f32 / rings as f32;
        positions.extend((0..sides).map(|i| around(i).extend(z)));
    }
    let (bottom, top) = (positions.len() as u32, positions.len() as u32 + 1);
    positions.extend([Vec3::ZERO, Vec3::Z * height]);
    let mut triangles = Vec::new();
    for i in 0..sides {
        let next = (i + 1) % sides;
        for low in (0..rings).map(|ring| ring * sides) {
            let [a, b, c, d] = [low + i, low + next, low + sides + next, low + sides + i];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.extend([[bottom, next, i], [top, rings * sides + i, rings * sides + next]]);
    }
    finished(positions, triangles)
}

/// A sphere about the origin: an octahedron whose triangles are cut in four `cuts` times.
pub(crate) fn ball(radius: f32, cuts: u32) -> Mesh {
    let mut positions = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]).collect::<Vec<_>>();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for (x, y, z) in [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4)] {
        triangles.extend([[x, y, z], [y, x, z + 1]]);
    }
    for _ in 0..cuts {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    finished(positions.into_iter().map(|p| p * radius).collect(), triangles)
}

fn finished(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let normals = mesh::vertex_normals(&positions, &triangles);
    Mesh { positions, normals, uvs: Vec::new(), triangles }
}

/// Vertices known by where they lie on a grid.
struct Points<K> {
    known: HashMap<K, u32>,
    positions: Vec<Vec3>,
}

impl<K> Default for Points<K> {
    fn default() -> Self {
        Points { known: HashMap::new(), positions: Vec::new() }
    }
}

impl<K: std::hash::Hash + Eq> Points<K> {
    fn index(&mut self, key: K, position: impl FnOnce() -> Vec3) -> u32 {
        let positions = &mut self.positions;
        *self.known.entry(key).or_insert_with(|| {
            positions.push(position());
            positions.len() as u32 - 1
        })
    }

    fn mesh(self, triangles: Vec<[u32; 3]>) -> Mesh {
        finished(self.positions, triangles)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    /// Volume of a mesh that is closed: every edge is run along once in each direction.
    fn closed_volume(mesh: &Mesh) -> f64 {
        let mut edges = HashSet::new();
        for [a, b, c] in &mesh.triangles {
            for edge in [(*a, *b), (*b, *c), (*c, *a)] {
                assert!(edges.insert(edge), "edge {edge:?} twice");
            }
        }
        assert!(edges.iter().all(|(a, b)| edges.contains(&(*b, *a))), "an open edge");
        let volume = |triangle| {
            let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
            a.dot(b.cross(c)) / 6.0
        };
        (0..mesh.triangles.len()).map(volume).sum()
    }

    #[test]
    fn solids_are_closed_and_hold_their_volume() {
        let block = block(Vec3::new(1.0, 2.0, 3.0), [2, 3, 4]);
        assert!((closed_volume(&block) - 6.0).abs() < 1e-6);
        assert_eq!(block.triangles.len(), 4 * (6 + 12 + 8));
        let cylinder = cylinder(0.5, 2.0, 96, 5);
        assert!((closed_volume(&cylinder) - 0.5 * std::f64::consts::PI).abs() < 2e-3);
        let ball = ball(2.0, 4);
        assert!((closed_volume(&ball) / (4.0 / 3.0 * std::f64::consts::PI * 8.0) - 1.0).abs() < 0.01);
        assert_eq!(ball.triangles.len(), 8 << 8);
    }

    #[test]
    fn blobs_are_closed_and_nearly_their_capsules() {
        let capsule = Capsule { from: Vec3::ZERO, to: Vec3::X * 2.0, radii: [0.5, 0.5] };
        let mesh = blob(&[capsule], 0.0, 64);
        let expected = std::f64::consts::PI * 0.25 * (2.0 + 4.0 / 3.0 * 0.5);
        assert!((closed_volume(&mesh) / expected - 1.0).abs() < 0.01, "{}", closed_volume(&mesh));
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let axis = Vec3::X * position.x.clamp(0.0, 2.0);
            assert!((position.distance(axis) - 0.5).abs() < 0.01, "{position}");
            assert!(normal.dot((position - axis).normalize()) > 0.9, "{position} {normal}");
        }
        let crossed = Capsule { from: Vec3::new(1.0, -1.0, 0.0), to: Vec3::new(1.0, 1.0, 0.2), radii: [0.3, 0.1] };
        let (sharp, smooth) = (blob(&[capsule, crossed], 0.0, 48), blob(&[capsule, crossed], 0.05, 48));
        assert!(closed_volume(&smooth) > closed_volume(&sharp));
    }
}
