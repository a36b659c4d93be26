//! Capsules blended into one closed surface.

use std::collections::HashMap;

use glam::{UVec3, Vec3};

use super::Points;
use crate::Mesh;

/// A ball swept along a segment, its radius changing in proportion to the way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    pub(crate) from: Vec3,
    pub(crate) to: Vec3,
    pub(crate) radii: [f32; 2],
}

impl Capsule {
    /// Negative inside; near the surface about the distance to it.
    pub(crate) fn distance(&self, p: Vec3) -> f32 {
        let along = self.to - self.from;
        let way = ((p - self.from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        let [start, end] = self.radii;
        p.distance(self.from + way * along) - (start + way * (end - start))
    }
}

/// How strongly each capsule holds a point: 1 for the nearest, falling by e with each `softness` that another is farther.
pub(crate) fn nearness(capsules: &[Capsule], softness: f32, p: Vec3) -> Vec<f32> {
    let distances: Vec<f32> = capsules.iter().map(|capsule| capsule.distance(p)).collect();
    let nearest = distances.iter().copied().fold(f32::INFINITY, f32::min);
    distances.into_iter().map(|distance| ((nearest - distance) / softness).exp()).collect()
}

/// The union of capsules, smooth within about `blend` of where they meet, cut into triangles on a grid with `resolution` cells
/// along its longest side. Marching tetrahedra (Doi and Koide 1991): closed, whatever the capsules are.
pub(crate) fn blob(capsules: &[Capsule], blend: f32, resolution: u32) -> Mesh {
    let field = Field::new(capsules, blend, resolution);
    let mut points: Points<[u64; 2]> = Points::default();
    let mut triangles = Vec::new();
    let mut values = HashMap::new();
    for base in field.blocks() {
        for cell in cells(base) {
            let corners: [UVec3; 8] = std::array::from_fn(|i| cell + corner(i));
            let heights = corners.map(|at| *values.entry(field.key(at)).or_insert_with(|| field.value(at)));
            if heights.iter().all(|value| *value < 0.0) || heights.iter().all(|value| *value >= 0.0) {
                continue;
            }
            for tetrahedron in TETRAHEDRA {
                let vertex = &mut |[(a, va), (b, vb)]: [Corner; 2]| {
                    points.index([field.key(a), field.key(b)], || field.crossing(a, va, b, vb))
                };
                triangles.extend(march(tetrahedron.map(|i| (corners[i], heights[i])), vertex));
            }
        }
    }
    let Mesh { positions, triangles, .. } = points.mesh(triangles);
    let normals = positions.iter().map(|p| field.normal(*p)).collect();
    Mesh { positions, normals, uvs: Vec::new(), triangles }
}

/// Cells along a block's side.
const BLOCK: u32 = 4;

/// The six tetrahedra around the diagonal of a cell, corners as bits of x, y, z, each positively oriented.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

fn corner(index: usize) -> UVec3 {
    UVec3::new(index as u32 & 1, index as u32 >> 1 & 1, index as u32 >> 2)
}

fn cells(base: UVec3) -> impl Iterator<Item = UVec3> {
    let side = 0..BLOCK;
    side.clone().flat_map(move |z| {
        let side = 0..BLOCK;
        side.clone().flat_map(move |y| (0..BLOCK).map(move |x| base + UVec3::new(x, y, z)))
    })
}

/// The signed field on a grid around the capsules.
struct Field<'a> {
    capsules: &'a [Capsule],
    blend: f32,
    low: Vec3,
    step: f32,
    blocks: UVec3,
}

impl<'a> Field<'a> {
    fn new(capsules: &'a [Capsule], blend: f32, resolution: u32) -> Self {
        let ends = || capsules.iter().flat_map(|c| [(c.from, c.radii[0]), (c.to, c.radii[1])]);
        // The blend swells the surface by at most blend · ln(count).
        let swell = blend * (capsules.len() as f32).ln();
        let low = ends().map(|(p, r)| p - (r + swell)).fold(Vec3::INFINITY, Vec3::min);
        let high = ends().map(|(p, r)| p + (r + swell)).fold(Vec3::NEG_INFINITY, Vec3::max);
        let step = (high - low).max_element() / resolution as f32;
        let cells = ((high - low) / step).ceil().as_uvec3() + 2;
        Field { capsules, blend, low: low - step, step, blocks: cells / BLOCK + 1 }
    }

    /// First cells of the blocks that the surface may pass through.
    fn blocks(&self) -> Vec<UVec3> {
        let UVec3 { x: width, y: depth, z: height } = self.blocks;
        let all = (0..width * depth * height).map(|i| UVec3::new(i % width, i / width % depth, i / (width * depth)));
        // The field changes by at most √2 a metre, since radii change by less than a metre a metre.
        let reach = std::f32::consts::SQRT_2 * 0.5 * BLOCK as f32 * self.step * 3f32.sqrt();
        let middle = |block: UVec3| self.at(self.point(block * BLOCK) + 0.5 * BLOCK as f32 * self.step);
        all.filter(|block| middle(*block).abs() <= reach).map(|block| block * BLOCK).collect()
    }

    fn point(&self, at: UVec3) -> Vec3 {
        self.low + at.as_vec3() * self.step
    }

    fn key(&self, at: UVec3) -> u64 {
        u64::from(at.x) | u64::from(at.y) << 21 | u64::from(at.z) << 42
    }

    fn value(&self, at: UVec3) -> f32 {
        self.at(self.point(at))
    }

    /// The smooth least of the capsules' distances: `−blend · ln Σ exp(−d/blend)`.
    fn at(&self, p: Vec3) -> f32 {
        let least = self.capsules.iter().map(|capsule| capsule.distance(p)).fold(f32::INFINITY, f32::min);
        if self.blend == 0.0 {
            return least;
        }
        let near = |capsule: &Capsule| ((least - capsule.distance(p)) / self.blend).exp();
        least - self.blend * self.capsules.iter().map(near).sum::<f32>().ln()
    }

    /// Unit normal of the surface near a point: up the field.
    fn normal(&self, p: Vec3) -> Vec3 {
        let step = 0.1 * self.step;
        let slope = |axis: Vec3| self.at(p + axis * step) - self.at(p - axis * step);
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).normalize_or(Vec3::Z)
    }

    /// Where the surface crosses an edge of the grid, not quite at its ends: triangles keep an area.
    fn crossing(&self, a: UVec3, va: f32, b: UVec3, vb: f32) -> Vec3 {
        let way = (va / (va - vb)).clamp(0.05, 0.95);
        self.point(a).lerp(self.point(b), way)
    }
}

type Corner = (UVec3, f32);

/// The triangles in which a surface passes through a tetrahedron, normals towards positive values; `vertex` names the crossing of
/// an edge, whose ends come in one order wherever it is asked for.
fn march(corners: [Corner; 4], vertex: &mut impl FnMut([Corner; 2]) -> u32) -> Vec<[u32; 3]> {
    let inside: Vec<usize> = (0..4).filter(|i| corners[*i].1 < 0.0).collect();
    let outside: Vec<usize> = (0..4).filter(|i| corners[*i].1 >= 0.0).collect();
    let mut cut = |a: usize, b: usize| {
        let order = |corner: &Corner| corner.0.to_array();
        let mut edge = [corners[a], corners[b]];
        edge.sort_by_key(order);
        vertex(edge)
    };
    let polygon: Vec<u32> = match (&inside[..], &outside[..]) {
        (&[a], &[b, c, d]) => vec![cut(a, b), cut(a, c), cut(a, d)],
        (&[b, c, d], &[a]) => vec![cut(a, b), cut(a, d), cut(a, c)],
        (&[a, b], &[c, d]) => vec![cut(a, c), cut(a, d), cut(b, d), cut(b, c)],
        _ => Vec::new(),
    };
    // The order of the corners decides on which side the normal points.
    let order: Vec<usize> = match inside.len() {
        3 => [outside, inside].concat(),
        _ => [inside, outside].concat(),
    };
    let flip = odd(&order);
    let fan = polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]]);
    fan.map(|[a, b, c]| if flip { [a, c, b] } else { [a, b, c] }).collect()
}

/// Whether a permutation is odd.
fn odd(order: &[usize]) -> bool {
    let inversions = (0..order.len()).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|(j, i)| order[*j] > order[*i]);
    inversions.count() % 2 == 1
}
