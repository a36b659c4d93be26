//! The interior of a mesh on a grid of voxels, and the volume of balls outside it.

use std::f32::consts::PI;

use glam::{DVec2, UVec3, Vec2, Vec3};
use rayon::prelude::*;

/// Chords by which a ball's volume is summed.
const CHORDS: usize = 192;
/// Fewest voxels along the shorter sides, so that plates in line with the axes have a thickness.
const FEWEST: u32 = 16;

/// How much of each voxel lies inside a mesh, as running lengths along x.
///
/// A voxel is judged by three lines through its centre, one along each axis; along a line the mesh is entered and left
/// at exact positions. A line that enters as often as it leaves counts by winding number, one that crosses an even
/// number of badly oriented triangles by parity, one that slips through a crack not at all; the voxel gets the median
/// of what counts. Volumes of closed meshes come out within 1%, and so do outside volumes relative to the ball's.
pub(crate) struct Voxels {
    origin: Vec3,
    size: Vec3,
    dims: UVec3,
    /// `nx + 1` entries a row: length inside up to each voxel boundary; rows by y, then z.
    running: Vec<f32>,
    chords: Vec<Chord>,
}

/// A chord along x of the unit ball: where it meets the y–z disc, and half its length.
struct Chord {
    at: Vec2,
    half: f32,
}

impl Voxels {
    /// Voxels over the bounding box of `positions`, `resolution` along its longest side.
    pub(crate) fn new(positions: &[Vec3], triangles: &[[u32; 3]], resolution: u32) -> Voxels {
        let (low, high) = bounds(positions);
        let longest = (high - low).max_element();
        let extent = (high - low).max(Vec3::splat(1e-3 * longest));
        let dims = (extent * (resolution as f32 / longest))
            .ceil()
            .as_uvec3()
            .clamp(UVec3::splat(FEWEST.min(resolution)), UVec3::splat(resolution));
        let mut voxels = Voxels {
            origin: 0.5 * (low + high) - 0.5 * extent,
            size: extent / dims.as_vec3(),
            dims,
            running: Vec::new(),
            chords: chords(),
        };
        let votes: Vec<Vec<f32>> = (0..3).into_par_iter().map(|axis| voxels.vote(positions, triangles, axis)).collect();
        voxels.running = voxels.tally(&votes);
        voxels
    }

    /// Volume inside the mesh.
    pub(crate) fn volume(&self) -> f32 {
        let row = self.dims.x as usize + 1;
        let length: f32 = self.running.chunks_exact(row).map(|row| row[row.len() - 1]).sum();
        length * self.size.y * self.size.z
    }

    /// Volume of a ball outside the mesh, `V(S − T)` of (35): the ball is cut into chords along x.
    pub(crate) fn outside(&self, center: Vec3, radius: f32) -> f32 {
        let length: f32 = self
            .chords
            .iter()
            .map(|chord| {
                let half = chord.half * radius;
                2.0 * half - self.length_inside(center, chord.at * radius, half)
            })
            .sum();
        // The chords' lengths add up to nearly, not exactly, the ball's volume; the share that is outside is the measure.
        let whole: f32 = self.chords.iter().map(|chord| 2.0 * chord.half).sum::<f32>() * radius;
        let share = if whole > 0.0 { (length / whole).clamp(0.0, 1.0) } else { 0.0 };
        share * ball_volume(radius)
    }

    /// Length inside the mesh of a chord along x.
    fn length_inside(&self, center: Vec3, at: Vec2, half: f32) -> f32 {
        let y = ((center.y + at.x - self.origin.y) / self.size.y).floor();
        let z = ((center.z + at.y - self.origin.z) / self.size.z).floor();
        if y < 0.0 || z < 0.0 || y >= self.dims.y as f32 || z >= self.dims.z as f32 {
            return 0.0;
        }
        let nx = self.dims.x as usize;
        let start = (z as usize * self.dims.y as usize + y as usize) * (nx + 1);
        let row = &self.running[start..=start + nx];
        let upto = |x: f32| {
            let x = ((x - self.origin.x) / self.size.x).clamp(0.0, nx as f32);
            let i = (x as usize).min(nx - 1);
            row[i] + (x - i as f32) * (row[i + 1] - row[i])
        };
        upto(center.x + half) - upto(center.x - half)
    }

    /// Whether a point lies in a voxel that is mostly inside.
    pub(crate) fn contains(&self, point: Vec3) -> bool {
        self.length_inside(point, Vec2::ZERO, 0.5 * self.size.x) > 0.5 * self.size.x
    }

    /// What the lines along one axis say of every voxel: the share inside, NaN for lines that say nothing.
    fn vote(&self, positions: &[Vec3], triangles: &[[u32; 3]], axis: usize) -> Vec<f32> {
        let mut crossings = Vec::new();
        for triangle in triangles {
            self.cross(triangle.map(|i| positions[i as usize]), axis, &mut crossings);
        }
        crossings.sort_unstable_by(|a, b| a.line.cmp(&b.line).then(a.at.total_cmp(&b.at)).then(a.turn.cmp(&b.turn)));
        let mut shares = vec![0.0; (self.dims.x * self.dims.y * self.dims.z) as usize];
        let (n, stride) = (self.dims.to_array()[axis] as usize, self.stride(axis));
        for line in crossings.chunk_by(|a, b| a.line == b.line) {
            let start = self.line_start(line[0].line, axis);
            let mut along = vec![0.0; n];
            match intervals(line) {
                Some(intervals) => intervals.for_each(|(from, to)| fill(&mut along, from, to)),
                None => along.fill(f32::NAN),
            }
            along.iter().enumerate().for_each(|(i, share)| shares[start + i * stride] = *share);
        }
        shares
    }

    /// Where the lines of voxel centres along an axis cross a triangle.
    fn cross(&self, corners: [Vec3; 3], axis: usize, crossings: &mut Vec<Crossing>) {
        let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
        let grid = corners.map(|p| ((p - self.origin) / self.size).as_dvec3());
        let flat = grid.map(|p| DVec2::new(p[b], p[c]));
        let low = flat[0].min(flat[1]).min(flat[2]);
        let high = flat[0].max(flat[1]).max(flat[2]);
        let dims = self.dims.to_array();
        let lines = |low: f64, high: f64, n: u32| {
            (low - 0.5).ceil().max(0.0) as u32..((high - 0.5).floor() + 1.0).clamp(0.0, n as f64) as u32
        };
        for k in lines(low.y, high.y, dims[c]) {
            for j in lines(low.x, high.x, dims[b]) {
                let q = DVec2::new(j as f64 + 0.5, k as f64 + 0.5);
                let sides = [0, 1, 2].map(|i| side(flat[(i + 1) % 3], flat[(i + 2) % 3], q));
                if sides.iter().all(|s| s.1) || sides.iter().all(|s| !s.1) {
                    let weights = sides.map(|s| s.0);
                    let sum: f64 = weights.iter().sum();
                    if sum != 0.0 {
                        let at = (0..3).map(|i| weights[i] * grid[i][axis]).sum::<f64>() / sum;
                        crossings.push(Crossing {
                            line: k * dims[b] + j,
                            at: at as f32,
                            turn: if sides[0].1 { 1 } else { -1 },
                        });
                    }
                }
            }
        }
    }

    fn stride(&self, axis: usize) -> usize {
        [1, self.dims.x, self.dims.x * self.dims.y][axis] as usize
    }

    fn line_start(&self, line: u32, axis: usize) -> usize {
        let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
        let across = self.dims.to_array()[b];
        (line % across) as usize * self.stride(b) + (line / across) as usize * self.stride(c)
    }

    /// Running lengths along x of the median of the votes.
    fn tally(&self, votes: &[Vec<f32>]) -> Vec<f32> {
        let nx = self.dims.x as usize;
        let shares: Vec<f32> =
            (0..votes[0].len()).map(|voxel| median([0, 1, 2].map(|axis| votes[axis][voxel]))).collect();
        let mut running = Vec::with_capacity(shares.len() / nx * (nx + 1));
        for row in shares.chunks_exact(nx) {
            let mut length = 0.0;
            running.push(length);
            for share in row {
                length += share * self.size.x;
                running.push(length);
            }
        }
        running
    }
}

/// A line enters (`turn` 1 or −1, by orientation) or leaves the mesh, in voxels along the axis.
struct Crossing {
    line: u32,
    at: f32,
    turn: i8,
}

/// The stretches of a line that lie inside, or `None` if the line missed a part of the surface.
fn intervals(line: &[Crossing]) -> Option<impl Iterator<Item = (f32, f32)>> {
    let closed = line.iter().map(|c| c.turn as i32).sum::<i32>() == 0;
    let mut winding = 0;
    let steps = line.windows(2).map(move |pair| {
        winding += if closed { pair[0].turn as i32 } else { 1 - 2 * winding };
        (winding != 0).then_some((pair[0].at, pair[1].at))
    });
    (closed || line.len().is_multiple_of(2)).then(|| steps.flatten())
}

/// Adds the stretch `from..to` (in voxels) to the voxels along a line.
fn fill(along: &mut [f32], from: f32, to: f32) {
    let (from, to) = (from.max(0.0), to.min(along.len() as f32));
    let first = from as usize;
    for (i, share) in along.iter_mut().enumerate().skip(first).take_while(|(i, _)| (*i as f32) < to) {
        *share += (to.min(i as f32 + 1.0) - from.max(i as f32)).max(0.0);
    }
}

/// Median of the numbers among three; the mean of two; 0 of none.
fn median(votes: [f32; 3]) -> f32 {
    let mut sorted = votes;
    sorted.sort_unstable_by(f32::total_cmp);
    match votes.iter().filter(|v| !v.is_nan()).count() {
        3 => sorted[1],
        2 => 0.5 * votes.iter().filter(|v| !v.is_nan()).sum::<f32>(),
        1 => votes.iter().copied().find(|v| !v.is_nan()).unwrap_or(0.0),
        _ => 0.0,
    }
}

/// Twice the signed area of `a`, `b`, `q`, and whether `q` lies to the left of `a → b`. Edges are evaluated in one
/// direction whichever triangle asks, so that a line through a shared edge crosses exactly one of its two triangles.
fn side(a: DVec2, b: DVec2, q: DVec2) -> (f64, bool) {
    let forward = (a.x, a.y) < (b.x, b.y);
    let (from, to) = if forward { (a, b) } else { (b, a) };
    let area = (to - from).perp_dot(q - from);
    if forward { (area, area >= 0.0) } else { (-area, area < 0.0) }
}

/// Chords spread evenly over the disc by the golden angle.
fn chords() -> Vec<Chord> {
    let turn = PI * (3.0 - 5.0_f32.sqrt());
    (0..CHORDS)
        .map(|i| {
            let distance = ((i as f32 + 0.5) / CHORDS as f32).sqrt();
            let at = Vec2::from_angle(i as f32 * turn) * distance;
            Chord { at, half: (1.0 - distance * distance).sqrt() }
        })
        .collect()
}

/// Volume of a ball.
pub(crate) fn ball_volume(radius: f32) -> f32 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// Corners of the bounding box.
pub(crate) fn bounds(positions: &[Vec3]) -> (Vec3, Vec3) {
    positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)))
}

#[cfg(test)]
mod tests {
    use glam::Quat;
    use halflight_scenes::Mesh;

    use super::*;
    use crate::shapes::{cuboid, icosphere, moved, square, torus, volume};

    const RESOLUTION: u32 = 64;

    fn voxels(mesh: &Mesh) -> Voxels {
        Voxels::new(&mesh.positions, &mesh.triangles, RESOLUTION)
    }

    fn relative_error(mesh: &Mesh) -> f64 {
        f64::from(voxels(mesh).volume()) / volume(mesh) - 1.0
    }

    #[test]
    fn volumes_agree_with_the_divergence_theorem() {
        let turned = |mesh: Mesh| moved(mesh, 3.0, Quat::from_scaled_axis(Vec3::new(0.3, 0.5, -0.7)), Vec3::splat(7.0));
        for mesh in [icosphere(3), torus(1.0, 0.3), cuboid(Vec3::new(1.0, 0.7, 0.2)), cuboid(Vec3::new(1.0, 1.0, 0.01))]
        {
            assert!(relative_error(&mesh).abs() < 0.01, "{}", relative_error(&mesh));
        }
        for mesh in [icosphere(3), torus(1.0, 0.3), cuboid(Vec3::new(1.0, 0.7, 0.2))].map(turned) {
            assert!(relative_error(&mesh).abs() < 0.01, "{}", relative_error(&mesh));
        }
    }

    #[test]
    fn round_volumes_agree_with_their_closed_forms() {
        let ball = voxels(&icosphere(4)).volume() / ball_volume(1.0);
        assert!((ball - 1.0).abs() < 0.01, "{ball}");
        let ring = voxels(&torus(1.0, 0.3)).volume() / (2.0 * PI * PI * 0.09);
        assert!((ring - 1.0).abs() < 0.02, "{ring}");
    }

    /// Open at both ends of the x axis: the lines through the two openings see nothing, and are outvoted.
    #[test]
    fn cracks_and_flipped_triangles_do_not_open_the_interior() {
        let mut cracked = icosphere(3);
        let whole = volume(&cracked);
        cracked.triangles.retain(|t| cracked.positions[t[0] as usize].x.abs() < 0.97);
        cracked.triangles.iter_mut().step_by(7).for_each(|t| t.swap(1, 2));
        let cracked = f64::from(voxels(&cracked).volume());
        assert!((cracked / whole - 1.0).abs() < 0.02, "{}", cracked / whole);
    }

    /// Two spheres that overlap, as one mesh: the shared part is inside, which parity alone would deny.
    #[test]
    fn overlapping_parts_are_inside() {
        let (mut both, other) = (icosphere(3), moved(icosphere(3), 1.0, Quat::IDENTITY, Vec3::X));
        let first = both.positions.len() as u32;
        both.positions.extend(other.positions);
        both.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
        let union = 2.0 * ball_volume(1.0) - lens(1.0, 1.0, 1.0) as f32;
        let found = voxels(&both).volume();
        assert!((found / union - 1.0).abs() < 0.02, "{found} against {union}");
    }

    #[test]
    fn a_plane_has_no_interior() {
        assert_eq!(voxels(&square()).volume(), 0.0);
    }

    /// Volume shared by balls of radii `a` and `b` whose centres are `d` apart.
    fn lens(a: f64, b: f64, d: f64) -> f64 {
        let pi = std::f64::consts::PI;
        if d >= a + b {
            0.0
        } else if d <= (a - b).abs() {
            4.0 / 3.0 * pi * a.min(b).powi(3)
        } else {
            pi * (a + b - d).powi(2) * (d * d + 2.0 * d * (a + b) - 3.0 * (a - b).powi(2)) / (12.0 * d)
        }
    }

    #[test]
    fn outside_volume_of_one_ball_agrees_with_the_closed_form() {
        let voxels = voxels(&icosphere(4));
        for (distance, radius) in [(0.0, 1.5), (0.5, 1.0), (0.9, 0.2), (1.0, 0.5), (1.3, 0.6), (0.3, 0.4), (2.0, 0.7)] {
            for direction in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.48, 0.6, 0.64)] {
                let exact = f64::from(ball_volume(radius)) - lens(1.0, f64::from(radius), f64::from(distance));
                let found = f64::from(voxels.outside(distance * direction, radius));
                let error = (found - exact) / f64::from(ball_volume(radius));
                assert!(error.abs() < 0.02, "{distance} {radius} {direction}: {found} against {exact}");
            }
        }
    }

    #[test]
    fn outside_volume_agrees_with_monte_carlo() {
        let voxels = voxels(&torus(1.0, 0.3));
        let in_torus = |p: Vec3| (p.truncate().length() - 1.0).hypot(p.z) < 0.3;
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        for (center, radius) in [(Vec3::ZERO, 1.0), (Vec3::X, 0.4), (Vec3::new(0.6, 0.7, 0.1), 0.25), (Vec3::Y, 1.4)] {
            let cube = (0..400_000).map(|_| Vec3::new(random(), random(), random()));
            let in_ball: Vec<Vec3> = cube.filter(|p| p.length() < 1.0).collect();
            let outside = in_ball.iter().filter(|p| !in_torus(center + radius * **p)).count();
            let share = outside as f32 / in_ball.len() as f32;
            let found = voxels.outside(center, radius) / ball_volume(radius);
            assert!((found - share).abs() < 0.02, "{center} {radius}: {found} against {share}");
        }
    }
}
