//! Shapes that change over time: skins on skeletons, procedural deformations, height fields that swell.

mod clip;
mod procedural;
mod skeleton;
mod skin;
mod swell;

use glam::{DAffine3, DMat3, Vec3};

pub(crate) use clip::{Clip, Interpolation, Keys, Playback, Track};
pub use procedural::{Form, Procedural};
pub(crate) use skeleton::{Joint, Skeleton, Transform};
pub(crate) use skin::{Bone, Influences, Skin, strongest};
pub use skin::{Carried, Palette};
pub(crate) use swell::{Growth, Swell, Wave};

use crate::content::Collector;
use crate::{Content, Mesh, Shape};

/// How an object changes its shape; triangles and texture coordinates, or the grid, stay.
#[derive(Clone, Debug)]
pub struct Deformation {
    kind: Kind,
    /// From the space in which the deformation is written to the object's rest position.
    placed: DAffine3,
    content: Content,
}

#[derive(Clone, Debug)]
pub(crate) enum Kind {
    Skin(Skin),
    Procedural(Procedural),
    Swell(Swell),
}

impl Deformation {
    /// `placed` leads from the deformation's own space to the rest position of the scene and can be inverted.
    pub(crate) fn new(kind: Kind, placed: DAffine3) -> Self {
        let written = match &kind {
            Kind::Skin(skin) => skin.collect(Collector::new("skin")),
            Kind::Procedural(procedural) => Collector::new("procedural").bytes(format!("{procedural:?}").as_bytes()),
            Kind::Swell(swell) => Collector::new("swell").bytes(format!("{swell:?}").as_bytes()),
        };
        let content = placed.to_cols_array().iter().fold(written, |all, v| all.bytes(&v.to_le_bytes())).finish();
        Deformation { kind, placed, content }
    }

    /// Hash of all that decides the deformation.
    pub fn content(&self) -> Content {
        self.content
    }

    /// A weighted sum of the mesh's vertices as a point of its skeleton; none of a mesh without one.
    pub fn gather(&self, weights: &[(u32, f64)]) -> Option<Carried> {
        match &self.kind {
            Kind::Skin(skin) => Some(skin.gather(weights)),
            Kind::Procedural(_) | Kind::Swell(_) => None,
        }
    }

    /// What carries points of the skeleton at a time in seconds; none of a mesh without one.
    pub fn palette(&self, time: f32) -> Option<Palette> {
        match &self.kind {
            Kind::Skin(skin) => Some(Palette(skin.palette(&skin.skeleton.pose_at(f64::from(time)), self.placed))),
            Kind::Procedural(_) | Kind::Swell(_) => None,
        }
    }

    /// The shape at a time in seconds, made of the one at rest.
    pub fn at(&self, rest: &Shape, time: f32) -> Shape {
        let time = f64::from(time);
        match (rest, &self.kind) {
            (Shape::Heights(rest), Kind::Swell(swell)) => Shape::Heights(swell.at(rest, time)),
            (Shape::Mesh(rest), kind) => Shape::Mesh(self.deformed(kind, rest, time)),
            (rest, _) => rest.clone(),
        }
    }

    fn deformed(&self, kind: &Kind, rest: &Mesh, time: f64) -> Mesh {
        let (positions, normals) = match kind {
            Kind::Skin(skin) => skin.posed(&skin.skeleton.pose_at(time), self.placed),
            Kind::Procedural(procedural) => {
                let back = self.placed.inverse();
                let vertex = |(position, normal): (&Vec3, &Vec3)| {
                    let p = back.transform_point3(position.as_dvec3());
                    let linear = self.placed.matrix3 * procedural.derivative(p, time) * back.matrix3;
                    let moved = self.placed.transform_point3(procedural.point(p, time));
                    (moved.as_vec3(), turned(&linear, *normal))
                };
                rest.positions.iter().zip(&rest.normals).map(vertex).unzip()
            }
            Kind::Swell(_) => (rest.positions.clone(), rest.normals.clone()),
        };
        Mesh { positions, normals, uvs: rest.uvs.clone(), triangles: rest.triangles.clone() }
    }
}

/// A unit normal carried along by a linear map: by its cofactors, so that it stays normal to what the map carries along.
fn turned(linear: &DMat3, normal: Vec3) -> Vec3 {
    let DMat3 { x_axis, y_axis, z_axis } = *linear;
    let cofactors = DMat3::from_cols(y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis));
    (cofactors * normal.as_dvec3())
        .try_normalize()
        .filter(|unit| unit.is_finite())
        .map_or(normal, |unit| unit.as_vec3())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn normals_stay_normal_under_any_linear_map() {
        let map = DMat3::from_cols(DVec3::new(2.0, 0.1, 0.0), DVec3::new(0.3, 0.7, -0.2), DVec3::new(0.0, 0.5, 1.1));
        let (u, v) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 0.2));
        let normal = turned(&map, u.cross(v).normalize().as_vec3()).as_dvec3();
        assert!(normal.dot(map * u).abs() < 1e-6 && normal.dot(map * v).abs() < 1e-6);
        assert!(normal.dot((map * u).cross(map * v)) > 0.0);
        assert_eq!(turned(&DMat3::ZERO, Vec3::Z), Vec3::Z);
    }
}
