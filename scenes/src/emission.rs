//! What surfaces emit.

use std::sync::Arc;

use crate::content::Collector;
use crate::{Content, Mesh, Rgb, Texture};

/// Radiance that leaves the front of a surface, the side of its geometric normals, the same in every direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Emission {
    /// The same all over; zero where nothing is emitted.
    Even(Rgb),
    /// One of each triangle of a mesh, not all zero.
    Triangles(Arc<Vec<Rgb>>),
}

/// Points along an edge of a triangle at which a picture on it is read.
const STEPS: usize = 8;

impl Emission {
    /// No light.
    pub const NONE: Emission = Emission::Even(Rgb::ZERO);

    /// `radiance` times the mean of a picture over each triangle of a mesh with texture coordinates.
    pub(crate) fn of_picture(radiance: Rgb, picture: &Texture, mesh: &Mesh) -> Self {
        Emission::of_triangles(
            (0..mesh.triangles.len()).map(|triangle| radiance * mean(picture, mesh, triangle)).collect(),
        )
    }

    /// One radiance a triangle.
    pub(crate) fn of_triangles(triangles: Vec<Rgb>) -> Self {
        match triangles.iter().all(|radiance| *radiance == Rgb::ZERO) {
            true => Emission::NONE,
            false => Emission::Triangles(Arc::new(triangles)),
        }
    }

    /// The sum with a radiance that is the same all over.
    pub(crate) fn plus(self, more: Rgb) -> Self {
        match self {
            Emission::Even(radiance) => Emission::Even(radiance + more),
            Emission::Triangles(triangles) => {
                Emission::of_triangles(triangles.iter().map(|radiance| *radiance + more).collect())
            }
        }
    }

    /// Radiance of a triangle or, of an object of spheres, a sphere.
    pub fn of(&self, primitive: usize) -> Rgb {
        match self {
            Emission::Even(radiance) => *radiance,
            Emission::Triangles(triangles) => triangles[primitive],
        }
    }

    /// Whether nothing is emitted.
    pub fn is_none(&self) -> bool {
        *self == Emission::NONE
    }

    /// Hash of the radiances.
    pub fn content(&self) -> Content {
        self.collect(Collector::new("emission")).finish()
    }

    pub(crate) fn collect(&self, into: Collector) -> Collector {
        match self {
            Emission::Even(radiance) => into.vec3(*radiance),
            Emission::Triangles(triangles) => into.list(triangles, |all, radiance| all.vec3(*radiance)),
        }
    }
}

impl From<Rgb> for Emission {
    fn from(radiance: Rgb) -> Self {
        Emission::Even(radiance)
    }
}

/// The mean at the middles of `STEPS²` equal parts of a triangle.
fn mean(picture: &Texture, mesh: &Mesh, triangle: usize) -> Rgb {
    let third = 1.0 / (3.0 * STEPS as f32);
    let mut sum = Rgb::ZERO;
    for i in 0..STEPS {
        for j in 0..STEPS - i {
            let corner = |offset: f32| [i, j].map(|k| (3.0 * k as f32 + offset) * third);
            sum += picture.at(mesh.uv(triangle, corner(1.0)));
            if i + j + 1 < STEPS {
                sum += picture.at(mesh.uv(triangle, corner(2.0)));
            }
        }
    }
    sum / (STEPS * STEPS) as f32
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    #[test]
    fn a_triangle_emits_the_mean_of_its_picture() {
        // A ramp along u: its mean over a triangle is its value at the centroid.
        let texels = (0..64).map(|i| Rgb::splat((i as f32 + 0.5) / 64.0)).collect();
        let picture = Texture::new(64, texels);
        let mesh = Mesh {
            uvs: vec![Vec2::new(0.1, 0.1), Vec2::new(0.9, 0.2), Vec2::new(0.2, 0.8)],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let Emission::Triangles(triangles) = Emission::of_picture(Rgb::new(2.0, 1.0, 0.0), &picture, &mesh) else {
            panic!("one of each triangle")
        };
        assert!((triangles[0] - Rgb::new(0.8, 0.4, 0.0)).length() < 1e-5, "{}", triangles[0]);
    }

    #[test]
    fn a_black_picture_is_no_light() {
        let mesh = Mesh { uvs: vec![Vec2::ZERO; 3], triangles: vec![[0, 1, 2]; 2], ..Mesh::default() };
        let dark = Emission::of_picture(Rgb::ONE, &Texture::new(1, vec![Rgb::ZERO]), &mesh);
        assert!(dark.is_none() && Emission::NONE.is_none() && !Emission::from(Rgb::X).is_none());
    }
}
