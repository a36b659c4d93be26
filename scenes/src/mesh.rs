//! Triangle meshes.

use glam::{DVec3, Vec2, Vec3};

use crate::Pose;
use crate::content::Collector;

/// A triangle mesh in object space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Corner positions, finite.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one a position.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a position, or empty.
    pub uvs: Vec<Vec2>,
    /// Three position indices a triangle, counter-clockwise seen from outside; no zero-area triangles.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Unit normal of a triangle on the side from which it is counter-clockwise.
    pub fn face_normal(&self, triangle: usize) -> Vec3 {
        face_normal(self.corners(triangle)).as_vec3()
    }

    /// Texture coordinates on a triangle, at weights of its second and third corner; zero where the mesh has none.
    pub fn uv(&self, triangle: usize, [v, w]: [f32; 2]) -> Vec2 {
        match self.uvs.is_empty() {
            true => Vec2::ZERO,
            false => {
                let [a, b, c] = self.triangles[triangle].map(|i| self.uvs[i as usize]);
                a * (1.0 - v - w) + b * v + c * w
            }
        }
    }

    /// The mesh carried along by a pose.
    pub fn posed(&self, pose: Pose) -> Mesh {
        Mesh {
            positions: self.positions.iter().map(|p| pose.point(*p)).collect(),
            normals: self.normals.iter().map(|n| pose.direction(*n).normalize_or(Vec3::Z)).collect(),
            uvs: self.uvs.clone(),
            triangles: self.triangles.clone(),
        }
    }

    pub(crate) fn collect(&self, into: Collector) -> Collector {
        into.list(&self.positions, |all, p| all.vec3(*p))
            .list(&self.normals, |all, n| all.vec3(*n))
            .list(&self.uvs, |all, uv| all.vec2(*uv))
            .list(&self.triangles, |all, t| t.iter().fold(all, |all, i| all.bytes(&i.to_le_bytes())))
    }
}

/// Unit normal of a triangle; zero if it has no area.
fn face_normal([a, b, c]: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero()
}

/// Unit normals at the vertices: the faces around each weighted by their angle there, which does not depend on how
/// the surface is cut into triangles (Thürmer and Wüthrich 1998). Vertices without a face get +z, those whose faces
/// cancel the normal of one of them.
pub(crate) fn vertex_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    let mut some_face = vec![DVec3::Z; positions.len()];
    for indices in triangles {
        let corners = indices.map(|i| positions[i as usize]);
        let normal = face_normal(corners);
        let corners = corners.map(Vec3::as_dvec3);
        for corner in 0..3 {
            let [at, next, previous] = [0, 1, 2].map(|step| corners[(corner + step) % 3]);
            let vertex = indices[corner] as usize;
            sums[vertex] += normal * (next - at).angle_between(previous - at);
            some_face[vertex] = normal;
        }
    }
    let unit = |(sum, face): (DVec3, DVec3)| if sum.length() > 1e-9 { sum.normalize() } else { face };
    sums.into_iter().zip(some_face).map(|pair| unit(pair).as_vec3()).collect()
}

/// A rectangle about the origin with normal +z.
pub(crate) fn plane(size: Vec2) -> Mesh {
    let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    Mesh {
        positions: uvs.iter().map(|uv| ((*uv - 0.5) * size).extend(0.0)).collect(),
        normals: vec![Vec3::Z; 4],
        uvs: uvs.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

/// A rectangle about the origin with normal +z, cut into cells by rows from its far edge (+y): two triangles each, one cell after
/// the other, like the texels of a picture that its front shows upright.
pub(crate) fn cells(size: Vec2, columns: usize, rows: usize) -> Mesh {
    let corner = |column: usize, row: usize| {
        let at = Vec2::new(column as f32 / columns as f32, 1.0 - row as f32 / rows as f32);
        ((at - 0.5) * size).extend(0.0)
    };
    let grid =
        |columns: usize, rows: usize| (0..rows).flat_map(move |row| (0..columns).map(move |column| (column, row)));
    let number = |column: usize, row: usize| (row * (columns + 1) + column) as u32;
    let two = |(i, j): (usize, usize)| {
        let [a, b, c, d] = [number(i, j + 1), number(i + 1, j + 1), number(i + 1, j), number(i, j)];
        [[a, b, c], [a, c, d]]
    };
    Mesh {
        positions: grid(columns + 1, rows + 1).map(|(column, row)| corner(column, row)).collect(),
        normals: vec![Vec3::Z; (columns + 1) * (rows + 1)],
        uvs: Vec::new(),
        triangles: grid(columns, rows).flat_map(two).collect(),
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn normals_of_a_cube_point_along_its_diagonals_however_it_is_cut() {
        let positions: Vec<Vec3> =
            (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        for (normal, position) in vertex_normals(&positions, &triangles).iter().zip(&positions) {
            assert!(normal.distance(position.normalize()) < 1e-6, "{normal} at {position}");
        }
    }

    #[test]
    fn no_normal_is_zero_or_nan() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE];
        // Two faces back to back cancel; the last vertex belongs to none.
        let normals = vertex_normals(&positions, &[[0, 1, 2], [0, 2, 1]]);
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6), "{normals:?}");
    }

    #[test]
    fn planes_face_up() {
        let mesh = plane(Vec2::new(4.0, 2.0));
        assert_eq!([mesh.face_normal(0), mesh.face_normal(1)], [Vec3::Z; 2]);
        assert_eq!(mesh.positions[2], Vec3::new(2.0, 1.0, 0.0));
        let cut = cells(Vec2::new(4.0, 2.0), 4, 3);
        assert!((0..24).all(|triangle| cut.face_normal(triangle) == Vec3::Z));
        // Columns from -x, rows from +y.
        let middle = |cell: usize| (cut.corners(2 * cell)[0] + cut.corners(2 * cell)[2]) / 2.0;
        assert!(middle(0).distance(Vec3::new(-1.5, 2.0 / 3.0, 0.0)) < 1e-6, "{}", middle(0));
        assert!(middle(11).distance(Vec3::new(1.5, -2.0 / 3.0, 0.0)) < 1e-6, "{}", middle(11));
    }

    #[test]
    fn a_pose_carries_normals_along() {
        let pose = Pose { rotation: Quat::from_rotation_x(90f32.to_radians()), translation: Vec3::Z };
        let mesh = plane(Vec2::ONE).posed(pose);
        assert!(mesh.normals[0].distance(-Vec3::Y) < 1e-6 && mesh.face_normal(0).distance(-Vec3::Y) < 1e-6);
        assert!((mesh.positions[2].z - 1.5).abs() < 1e-6);
    }
}
