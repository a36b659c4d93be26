//! Height fields: a grid of heights that stands upright.

use std::sync::OnceLock;

use glam::{Vec2, Vec3};

use crate::Mesh;
use crate::content::Collector;

/// Heights over a regular grid in the horizontal plane, at least two columns and two rows. Vertex `(i, j)` lies at
/// `(origin.x + i·cell.x, origin.y + j·cell.y)`: columns run along +x, rows along +y.
///
/// Between vertices the surface is that of triangles: each cell is cut along the diagonal from its corner `(i, j)` to
/// `(i + 1, j + 1)`, so that transposing the grid, or turning it by 180°, gives the same surface transposed or turned,
/// while a quarter turn does not. It faces up, and beyond its border there is nothing.
#[derive(Clone, Debug)]
pub struct HeightField {
    size: [usize; 2],
    origin: Vec2,
    cell: Vec2,
    heights: Vec<f32>,
    mesh: OnceLock<Mesh>,
}

impl HeightField {
    /// A field of `[columns, rows]` heights in metres, row by row from the smallest y, with the vertex `(0, 0)` at `origin`
    /// and the given distances in metres between neighbours.
    ///
    /// # Panics
    /// If there are fewer than two columns or rows, `heights` has not one entry a vertex, a distance is not positive, or a
    /// number is not finite.
    pub fn new([columns, rows]: [usize; 2], origin: Vec2, cell: Vec2, heights: Vec<f32>) -> Self {
        assert!(columns >= 2 && rows >= 2, "expected at least 2 x 2 heights, found {columns} x {rows}");
        assert_eq!(heights.len(), columns * rows, "one height a vertex");
        assert!(cell.min_element() > 0.0 && cell.is_finite() && origin.is_finite(), "a finite grid of positive cells");
        assert!(heights.iter().all(|height| height.is_finite()), "finite heights");
        HeightField { size: [columns, rows], origin, cell, heights, mesh: OnceLock::new() }
    }

    /// Vertices along x.
    pub fn columns(&self) -> usize {
        self.size[0]
    }

    /// Vertices along y.
    pub fn rows(&self) -> usize {
        self.size[1]
    }

    /// Horizontal position of vertex `(0, 0)` in metres.
    pub fn origin(&self) -> Vec2 {
        self.origin
    }

    /// Distances between neighbouring vertices in metres.
    pub fn cell(&self) -> Vec2 {
        self.cell
    }

    /// Heights in metres, row by row from the smallest y; vertex `(i, j)` is entry `j · columns + i`.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// Height in metres of vertex `(column, row)`.
    pub fn height(&self, column: usize, row: usize) -> f32 {
        self.heights[row * self.columns() + column]
    }

    /// Position of vertex `(column, row)`.
    pub fn position(&self, column: usize, row: usize) -> Vec3 {
        let at = self.origin + Vec2::new(column as f32, row as f32) * self.cell;
        at.extend(self.height(column, row))
    }

    /// Unit normal at vertex `(column, row)`: of the central differences of the heights, one-sided at borders. It points
    /// upwards.
    pub fn normal(&self, column: usize, row: usize) -> Vec3 {
        let along = |at: usize, count: usize, cell: f32, height: &dyn Fn(usize) -> f32| {
            let (before, after) = (at.saturating_sub(1), (at + 1).min(count - 1));
            (f64::from(height(after)) - f64::from(height(before))) / ((after - before) as f64 * f64::from(cell))
        };
        let x = along(column, self.columns(), self.cell.x, &|i| self.height(i, row));
        let y = along(row, self.rows(), self.cell.y, &|j| self.height(column, j));
        glam::DVec3::new(-x, -y, 1.0).normalize().as_vec3()
    }

    /// Height in metres of the surface at grid coordinates: `(i, j)` is vertex `(i, j)`, and those outside the grid are
    /// moved to its border.
    pub fn surface(&self, x: f64, y: f64) -> f64 {
        let split = |at: f64, count: usize| {
            let at = at.clamp(0.0, (count - 1) as f64);
            let cell = (at as usize).min(count - 2);
            (cell, at - cell as f64)
        };
        let ((i, u), (j, v)) = (split(x, self.columns()), split(y, self.rows()));
        let height = |i, j| f64::from(self.height(i, j));
        let (low, high) = (height(i, j), height(i + 1, j + 1));
        match u >= v {
            true => low + u * (height(i + 1, j) - low) + v * (high - height(i + 1, j)),
            false => low + v * (height(i, j + 1) - low) + u * (high - height(i, j + 1)),
        }
    }

    /// The surface as triangles, made on first need. Vertices have the order of [`HeightField::heights`], the normals of
    /// [`HeightField::normal`], and their grid coordinates `(i, j)` as texture coordinates. Cell `(i, j)` holds the
    /// triangles `2c` (towards +x) and `2c + 1` (towards +y) for `c = j · (columns − 1) + i`.
    pub fn mesh(&self) -> &Mesh {
        self.mesh.get_or_init(|| self.triangulate())
    }

    fn triangulate(&self) -> Mesh {
        let [columns, rows] = self.size;
        let vertices = || (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        let cells = (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| j * columns + i));
        let cut = |low: usize| {
            let [a, b, d, c] = [low, low + 1, low + columns, low + columns + 1].map(|vertex| vertex as u32);
            [[a, b, c], [a, c, d]]
        };
        Mesh {
            positions: vertices().map(|(i, j)| self.position(i, j)).collect(),
            normals: vertices().map(|(i, j)| self.normal(i, j)).collect(),
            uvs: vertices().map(|(i, j)| Vec2::new(i as f32, j as f32)).collect(),
            triangles: cells.flat_map(cut).collect(),
        }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        2 * (self.columns() - 1) * (self.rows() - 1)
    }

    /// The field moved.
    pub fn translated(&self, by: Vec3) -> HeightField {
        let heights = self.heights.iter().map(|height| height + by.z).collect();
        HeightField::new(self.size, self.origin + by.truncate(), self.cell, heights)
    }

    pub(crate) fn collect(&self, into: Collector) -> Collector {
        let placed = into.word(self.columns()).word(self.rows()).vec2(self.origin).vec2(self.cell);
        placed.floats(&self.heights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> HeightField {
        let heights = vec![0.0, 1.0, 4.0, 2.0, -1.0, 3.0];
        HeightField::new([3, 2], Vec2::new(10.0, 20.0), Vec2::new(2.0, 0.5), heights)
    }

    #[test]
    fn triangles_face_up_and_share_the_stated_diagonal() {
        let field = field();
        let mesh = field.mesh();
        assert_eq!(mesh.triangles, [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]);
        assert_eq!(mesh.triangles.len(), field.triangles());
        assert!((0..4).all(|triangle| mesh.face_normal(triangle).z > 0.0));
        assert_eq!(mesh.positions[5], Vec3::new(14.0, 20.5, 3.0));
        assert_eq!(mesh.uvs[5], Vec2::new(2.0, 1.0));
    }

    #[test]
    fn the_surface_is_that_of_the_triangles() {
        let field = field();
        let mesh = field.mesh();
        for triangle in &mesh.triangles {
            for weights in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.3, 0.5], [0.0, 0.5, 0.5], [0.7, 0.1, 0.2]] {
                let blend = |value: &dyn Fn(usize) -> f64| {
                    triangle.iter().zip(weights).map(|(vertex, weight)| value(*vertex as usize) * weight).sum::<f64>()
                };
                let [x, y] = [0, 1].map(|axis| blend(&|vertex| f64::from(mesh.uvs[vertex][axis])));
                let height = blend(&|vertex| f64::from(mesh.positions[vertex].z));
                assert!((field.surface(x, y) - height).abs() < 1e-12, "({x}, {y})");
            }
        }
        assert_eq!([field.surface(-1.0, -1.0), field.surface(9.0, 9.0)], [0.0, 3.0]);
    }

    #[test]
    fn normals_are_central_differences_one_sided_at_borders() {
        let field = field();
        let normal = |x: f32, y: f32| Vec3::new(-x, -y, 1.0).normalize();
        assert!(field.normal(1, 0).distance(normal(4.0 / 4.0, -2.0 / 0.5)) < 1e-6);
        assert!(field.normal(0, 1).distance(normal(-3.0 / 2.0, 2.0 / 0.5)) < 1e-6);
    }

    #[test]
    fn moving_it_moves_every_vertex() {
        let (field, by) = (field(), Vec3::new(1.0, 2.0, 4.0));
        let moved = field.translated(by);
        for (old, new) in field.mesh().positions.iter().zip(&moved.mesh().positions) {
            assert_eq!(*old + by, *new);
        }
    }
}
