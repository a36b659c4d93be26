//! Geometry built once in its own space: the bottom level of a world.

use glam::Vec3;

use crate::sphere::{Sphere, SpherePacket};
use crate::traced_ray::TracedRay;
use crate::triangle::{Triangle, TrianglePacket};
use crate::wide::{Bundle, Hierarchy, Id, Stack};
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
    /// Builds the hierarchies over all geometries. Triangles without area, and whatever is not finite or has
    /// coordinates beyond 1e18, are never hit.
    ///
    /// # Panics
    /// If a triangle's index lies beyond its positions.
    pub fn build(geometries: &[Geometry<'_>]) -> Self {
        let (triangles, spheres): (Vec<_>, Vec<_>) = (triangles(geometries).collect(), spheres(geometries).collect());
        Body { triangles: Hierarchy::build(&triangles), spheres: Hierarchy::build(&spheres) }
    }

    /// The same body after its vertices or spheres have moved, at a fraction of a build's time: the tree stays, its
    /// boxes follow. Nothing, and the caller builds anew, if other primitives can be hit than those of the first
    /// build, or if by the surface area heuristic rays would now visit over 1.2 times as many boxes as after it.
    ///
    /// # Panics
    /// As [`Body::build`].
    pub fn refit(&self, geometries: &[Geometry<'_>]) -> Option<Self> {
        let triangles = self.triangles.refit(triangles(geometries).count(), |id| triangle(geometries, id))?;
        let spheres = self.spheres.refit(spheres(geometries).count(), |id| sphere(geometries, id))?;
        Some(Body { triangles, spheres })
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

    /// Of the open rays, those that anything lies on before their ends.
    #[inline]
    pub(crate) fn any_of(&self, bundle: Bundle<'_>, stack: &mut Stack) -> u64 {
        let blocked = self.triangles.any_of(bundle, stack);
        blocked | self.spheres.any_of(Bundle { open: bundle.open & !blocked, ..bundle }, stack)
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

/// The triangles that can be hit. Nothing else may reach the builder, which an infinite corner can crash.
fn triangles<'a>(geometries: &'a [Geometry<'a>]) -> impl Iterator<Item = (Triangle, Id)> {
    (0..).zip(geometries).flat_map(move |(geometry, content)| {
        let count = if let Geometry::Triangles { triangles, .. } = content { triangles.len() as u32 } else { 0 };
        let ids = (0..count).map(move |primitive| Id { geometry, primitive });
        ids.filter_map(move |id| Some((triangle(geometries, id)?, id)))
    })
}

/// The spheres that can be hit.
fn spheres<'a>(geometries: &'a [Geometry<'a>]) -> impl Iterator<Item = (Sphere, Id)> {
    (0..).zip(geometries).flat_map(move |(geometry, content)| {
        let count = if let Geometry::Spheres(spheres) = content { spheres.len() as u32 } else { 0 };
        let ids = (0..count).map(move |primitive| Id { geometry, primitive });
        ids.filter_map(move |id| Some((sphere(geometries, id)?, id)))
    })
}

/// A triangle that is there and can be hit.
fn triangle(geometries: &[Geometry<'_>], id: Id) -> Option<Triangle> {
    let Geometry::Triangles { positions, triangles } = geometries.get(id.geometry as usize)? else { return None };
    let corners = triangles.get(id.primitive as usize)?.map(|i| positions[i as usize]);
    Some(Triangle(corners)).filter(Triangle::is_proper)
}

/// A sphere that is there and can be hit.
fn sphere(geometries: &[Geometry<'_>], id: Id) -> Option<Sphere> {
    let Geometry::Spheres(spheres) = geometries.get(id.geometry as usize)? else { return None };
    spheres.get(id.primitive as usize).copied().filter(Sphere::is_proper)
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
        let id = |geometry, primitive| Id { geometry, primitive };
        assert_eq!(super::triangles(&geometries).map(|(_, id)| id).collect::<Vec<_>>(), [id(1, 4)]);
        assert_eq!(super::spheres(&geometries).map(|(_, id)| id).collect::<Vec<_>>(), [id(0, 6)]);
    }
}
