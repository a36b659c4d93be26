//! The points that a sphere set must bound, and the cells of a grid that hold them.

use glam::{IVec3, UVec3, Vec3};

use crate::voxels::{Voxels, bounds};

/// Most points laid between the corners of large triangles.
const MOST_EXTRA: usize = 200_000;
/// No site in this cell.
const NONE: u32 = u32::MAX;

/// A grid of cubes over a bounding box.
#[derive(Clone, Copy)]
struct Cells {
    origin: Vec3,
    size: f32,
    dims: UVec3,
}

impl Cells {
    fn over(points: &[Vec3], size: f32) -> Cells {
        let (low, high) = bounds(points);
        let dims = ((high - low) / size).ceil().as_uvec3().max(UVec3::ONE);
        Cells { origin: 0.5 * (low + high) - 0.5 * size * dims.as_vec3(), size, dims }
    }

    fn count(&self) -> usize {
        (self.dims.x * self.dims.y * self.dims.z) as usize
    }

    fn cell(&self, point: Vec3) -> UVec3 {
        ((point - self.origin) / self.size).max(Vec3::ZERO).as_uvec3().min(self.dims - 1)
    }

    fn index(&self, cell: UVec3) -> u32 {
        (cell.z * self.dims.y + cell.y) * self.dims.x + cell.x
    }

    fn cell_at(&self, index: u32) -> UVec3 {
        let UVec3 { x, y, .. } = self.dims;
        UVec3::new(index % x, index / x % y, index / (x * y))
    }

    fn center(&self, cell: UVec3) -> Vec3 {
        self.origin + (cell.as_vec3() + 0.5) * self.size
    }
}

/// Points by site: a site is a cell of the grid that holds points of the surface or whose centre lies inside.
pub(crate) struct Samples {
    /// All points, those of a site together.
    pub(crate) points: Vec<Vec3>,
    /// The points inside.
    pub(crate) interior: Vec<Vec3>,
    /// Mean of each site's points.
    pub(crate) sites: Vec<Vec3>,
    /// Side of a cell.
    pub(crate) spacing: f32,
    /// Where each site's points begin, and an end.
    starts: Vec<u32>,
    cells: Cells,
    site_of_cell: Vec<u32>,
    cell_of_site: Vec<UVec3>,
}

impl Samples {
    /// Sites of side `spacing` that hold at most one of the surface's points for each of their eight octants, and the
    /// centres of cells inside.
    pub(crate) fn new(surface: &[Vec3], voxels: &Voxels, spacing: f32) -> Samples {
        let cells = Cells::over(surface, spacing);
        let centers = (0..cells.count()).map(|i| cells.center(cells.cell_at(i as u32)));
        let interior: Vec<Vec3> = centers.filter(|p| voxels.contains(*p)).collect();
        let mut points: Vec<Vec3> = thinned(surface, 0.5 * spacing).into_iter().map(|i| surface[i]).collect();
        points.extend(&interior);
        let mut samples = Samples {
            points: Vec::with_capacity(points.len()),
            interior,
            sites: Vec::new(),
            spacing,
            starts: vec![0],
            site_of_cell: vec![NONE; cells.count()],
            cell_of_site: Vec::new(),
            cells,
        };
        by_cell(&points, cells).chunk_by(|a, b| a.0 == b.0).for_each(|group| samples.add_site(group, &points));
        samples
    }

    fn add_site(&mut self, group: &[(u32, u32)], points: &[Vec3]) {
        let cell = group[0].0;
        self.site_of_cell[cell as usize] = self.sites.len() as u32;
        self.cell_of_site.push(self.cells.cell_at(cell));
        let held = group.iter().map(|(_, point)| points[*point as usize]);
        self.sites.push(held.clone().sum::<Vec3>() / group.len() as f32);
        self.points.extend(held);
        self.starts.push(self.points.len() as u32);
    }

    /// Indices of a site's points.
    pub(crate) fn points_of(&self, site: usize) -> std::ops::Range<u32> {
        self.starts[site]..self.starts[site + 1]
    }

    /// Sites whose cells touch a site's.
    pub(crate) fn neighbours(&self, site: usize) -> impl Iterator<Item = usize> {
        let (cell, dims) = (self.cell_of_site[site].as_ivec3(), self.cells.dims.as_ivec3());
        let around = (-1..=1).flat_map(|z| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| IVec3::new(x, y, z))));
        around
            .map(move |step| cell + step)
            .filter(move |c| c.cmpge(IVec3::ZERO).all() && c.cmplt(dims).all() && *c != cell)
            .map(|c| self.site_of_cell[self.cells.index(c.as_uvec3()) as usize])
            .filter(|site| *site != NONE)
            .map(|site| site as usize)
    }
}

/// Pairs of cell and point, sorted.
fn by_cell(points: &[Vec3], cells: Cells) -> Vec<(u32, u32)> {
    let mut pairs: Vec<(u32, u32)> =
        points.iter().enumerate().map(|(i, p)| (cells.index(cells.cell(*p)), i as u32)).collect();
    pairs.sort_unstable();
    pairs
}

/// The first point of every cell of a grid, by index.
pub(crate) fn thinned(points: &[Vec3], size: f32) -> Vec<usize> {
    let pairs = by_cell(points, Cells::over(points, size));
    pairs.chunk_by(|a, b| a.0 == b.0).map(|group| group[0].1 as usize).collect()
}

/// All positions, the midpoints of all triangles, and points no further than about `spacing` apart on triangles that
/// are larger: without these the spheres could bound a large triangle's corners and leave the rest bare.
pub(crate) fn surface_points(positions: &[Vec3], triangles: &[[u32; 3]], spacing: f32) -> Vec<Vec3> {
    let corners = || triangles.iter().map(|t| t.map(|i| positions[i as usize]));
    let mut points = positions.to_vec();
    points.extend(corners().map(midpoint));
    let spacing = (0..32)
        .map(|doubling| spacing * f32::exp2(doubling as f32))
        .find(|spacing| corners().map(|t| Lattice::new(t, *spacing).count()).sum::<usize>() <= MOST_EXTRA);
    if let Some(spacing) = spacing {
        corners().for_each(|t| Lattice::new(t, spacing).extend(&mut points));
    }
    points
}

/// Midpoint of a triangle; divided first, so that huge coordinates do not overflow.
pub(crate) fn midpoint(corners: [Vec3; 3]) -> Vec3 {
    corners.map(|p| p / 3.0).iter().sum()
}

/// Rows of points on a triangle, parallel to its longest side.
struct Lattice {
    corners: [Vec3; 3],
    rows: usize,
    columns: usize,
}

impl Lattice {
    fn new(corners: [Vec3; 3], spacing: f32) -> Lattice {
        let length = |i: usize| corners[i].distance(corners[(i + 1) % 3]);
        let longest = (0..3).max_by(|i, j| length(*i).total_cmp(&length(*j))).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|i| corners[(longest + i) % 3]);
        let base = a.distance(b);
        let height = if base > 0.0 { (b - a).cross((c - a) / base).length() } else { 0.0 };
        let steps = |length: f32| ((length / spacing).ceil() as usize).min(MOST_EXTRA);
        Lattice { corners: [a, b, c], rows: steps(height), columns: steps(base) }
    }

    /// Number of points at most; none where corners and midpoint are dense enough.
    fn count(&self) -> usize {
        if self.columns > 1 { (self.rows + 1) * (self.columns + 1) } else { 0 }
    }

    fn extend(&self, points: &mut Vec<Vec3>) {
        if self.count() == 0 {
            return;
        }
        let [a, b, c] = self.corners;
        for row in 0..=self.rows {
            let up = row as f32 / self.rows.max(1) as f32;
            let (from, to) = (a.lerp(c, up), b.lerp(c, up));
            let columns = ((1.0 - up) * self.columns as f32).ceil() as usize;
            points.extend((0..=columns).map(|i| from.lerp(to, i as f32 / columns.max(1) as f32)));
        }
    }
}
