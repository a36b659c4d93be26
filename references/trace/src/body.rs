//! Geometry built once in its own space: the bottom level of a world.

use glam::Vec3;

use crate::sphere::{Sphere, SpherePacket};
use crate::traced_ray::TracedRay;
use crate::triangle::{Triangle, TrianglePacket};
use crate::wide::{Hierarchy, Id, Stack};
use crate::world::Hit;

/// One geometry of a [`Body`], borrowed while the body is built.
#[derive(Clone, Copy, Debug)]
pub enum Geometry<'a> {
    /// Triangles as indices into positions.
    Triangles {
        /// Corner positions, finite.
        positions: &'a [Vec3],
        /// Three indices a triangle.
        triangles: &'a [[u32; 3]],
    },
    /// Exact spheres.
    Spheres(&'a [Sphere]),
}

/// Bounding volume hierarchies over geometries that keep their places among each other; shared by all worlds that
/// hold them.
pub struct Body {
    triangles: Hierarchy<TrianglePacket>,
    spheres: Hierarchy<SpherePacket>,
}

impl Body {
    /// Builds the hierarchies over all geometries. Triangles without area and whatever is not finite are never hit.
    ///
    /// # Panics
    /// If a triangle's index lies beyond its positions.
    pub fn build(geometries: &[Geometry<'_>]) -> Self {
        let (triangles, spheres) = proper(geometries);
        Body { triangles: Hierarchy::build(&triangles), spheres: Hierarchy::build(&spheres) }
    }

    /// Lowest and highest corner of everything; nothing for an empty body.
    pub(crate) fn bounds(&self) -> Option<[Vec3; 2]> {
        match (self.triangles.bounds(), self.spheres.bounds()) {
            (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
            (a, b) => a.or(b),
        }
    }

    #[inline]
    pub(crate) fn any(&self, ray: &TracedRay, t_max: f32, stack: &mut Stack) -> bool {
        self.triangles.any(ray, t_max, stack) || self.spheres.any(ray, t_max, stack)
    }

    #[inline]
    pub(crate) fn closest(&self, ray: &TracedRay, t_max: f32, stack: &mut Stack) -> Option<Hit> {
        let hit = |t, id: Id, barycentrics| Hit { t, geometry: id.geometry, primitive: id.primitive, barycentrics };
        let triangle = self.triangles.closest(ray, t_max, stack).map(|(found, id)| hit(found.t, id, found.detail));
        let limit = triangle.map_or(t_max, |hit| hit.t);
        let sphere = self.spheres.closest(ray, limit, stack).map(|(found, id)| hit(found.t, id, [0.0; 2]));
        sphere.or(triangle)
    }
}

type Named<P> = Vec<(P, Id)>;

/// What can be hit. Nothing else may reach the builder, which an infinite corner can crash.
fn proper(geometries: &[Geometry<'_>]) -> (Named<Triangle>, Named<Sphere>) {
    let mut triangles = Vec::new();
    let mut spheres = Vec::new();
    for (geometry, content) in (0..).zip(geometries) {
        let id = |primitive| Id { geometry, primitive };
        match content {
            Geometry::Triangles { positions, triangles: indices } => {
                let corners = indices.iter().map(|triple| Triangle(triple.map(|i| positions[i as usize])));
                triangles.extend((0..).zip(corners).filter(|(_, t)| t.is_proper()).map(|(i, t)| (t, id(i))));
            }
            Geometry::Spheres(all) => {
                spheres.extend((0..).zip(*all).filter(|(_, s)| s.is_proper()).map(|(i, s)| (*s, id(i))));
            }
        }
    }
    (triangles, spheres)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_can_be_hit_reaches_the_builder() {
        let positions =
            [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY), Vec3::X * 2.0];
        let triangles = [[0, 1, 3], [0, 1, 4], [0, 1, 5], [1, 1, 2], [0, 1, 2]];
        let sphere = |x, radius| Sphere { center: Vec3::X * x, radius };
        let spheres = [
            sphere(f32::NAN, 1.0),
            sphere(0.0, -1.0),
            sphere(0.0, 0.0),
            sphere(0.0, f32::NAN),
            sphere(0.0, f32::INFINITY),
            sphere(f32::MAX, f32::MAX),
            sphere(1.0, 2.0),
        ];
        let geometries =
            [Geometry::Spheres(&spheres), Geometry::Triangles { positions: &positions, triangles: &triangles }];
        let (triangles, spheres) = proper(&geometries);
        assert_eq!(triangles.iter().map(|(_, id)| (id.geometry, id.primitive)).collect::<Vec<_>>(), [(1, 4)]);
        assert_eq!(spheres.iter().map(|(_, id)| (id.geometry, id.primitive)).collect::<Vec<_>>(), [(0, 6)]);
    }
}
