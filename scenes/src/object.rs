//! Objects: a shape, its albedo, what it emits, whether it casts shadows, and its rigid motion.

use std::borrow::Cow;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use halflight_trace::Geometry;

use crate::content::Collector;
use crate::{Content, Deformation, Emission, HeightField, Mesh, Revision, Rgb, Sphere, Texture};

/// What an object is made of, in rest position (the scene file's transform applied).
#[derive(Clone, Debug)]
pub enum Shape {
    /// A triangle mesh.
    Mesh(Mesh),
    /// Exact spheres.
    Spheres(Vec<Sphere>),
    /// A grid of heights. It stands upright: poses move it but do not turn it, and a scene file that asks for that is refused.
    Heights(HeightField),
}

impl Shape {
    /// The shape carried along by a pose.
    pub fn posed(&self, pose: Pose) -> Cow<'_, Shape> {
        if pose == Pose::IDENTITY {
            return Cow::Borrowed(self);
        }
        Cow::Owned(match self {
            Shape::Mesh(mesh) => Shape::Mesh(mesh.posed(pose)),
            Shape::Spheres(spheres) => {
                let moved = |sphere: &Sphere| Sphere { center: pose.point(sphere.center), radius: sphere.radius };
                Shape::Spheres(spheres.iter().map(moved).collect())
            }
            Shape::Heights(field) => Shape::Heights(field.translated(pose.translation)),
        })
    }

    /// The shape as the tracer takes it.
    pub fn geometry(&self) -> Geometry<'_> {
        let mesh = match self {
            Shape::Spheres(spheres) => return Geometry::Spheres(spheres),
            Shape::Mesh(mesh) => mesh,
            Shape::Heights(field) => field.mesh(),
        };
        Geometry::Triangles { positions: &mesh.positions, triangles: &mesh.triangles }
    }

    /// Hash of the shape.
    pub fn content(&self) -> Content {
        let content = match self {
            Shape::Mesh(mesh) => mesh.collect(Collector::new("mesh")),
            Shape::Spheres(spheres) => {
                Collector::new("spheres").list(spheres, |all, sphere| all.vec3(sphere.center).float(sphere.radius))
            }
            Shape::Heights(field) => field.collect(Collector::new("heights")),
        };
        content.finish()
    }
}

/// A rigid motion: rotate, then translate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Rotation about the origin.
    pub rotation: Quat,
    /// Translation in metres.
    pub translation: Vec3,
}

impl Pose {
    /// The rest pose.
    pub const IDENTITY: Pose = Pose { rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// A point carried along.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.rotation * p + self.translation
    }

    /// A direction carried along.
    pub fn direction(&self, d: Vec3) -> Vec3 {
        self.rotation * d
    }

    /// On the way from one pose to another: translation straight, rotation along the shorter arc.
    fn between(from: Pose, to: Pose, weight: f32) -> Pose {
        Pose {
            rotation: from.rotation.slerp(to.rotation, weight).normalize(),
            translation: from.translation.lerp(to.translation, weight),
        }
    }

    /// The same rotation about `pivot` instead of the origin.
    fn about(&self, pivot: Vec3) -> Pose {
        Pose { rotation: self.rotation, translation: self.translation + pivot - self.rotation * pivot }
    }
}

/// One object of a scene.
#[derive(Clone, Debug)]
pub struct Object {
    /// Unique within the scene.
    pub name: String,
    /// Geometry in rest position, undeformed.
    pub shape: Arc<Shape>,
    /// Hash of the shape.
    pub content: Content,
    /// Diffuse albedo in `[0, 1]`.
    pub albedo: Rgb,
    /// By which the albedo is multiplied, where the mesh has texture coordinates.
    pub texture: Option<Texture>,
    /// What it emits. An object that emits is an area light: a sphere a spherical one, a polygon a polygonal one.
    pub emission: Emission,
    /// Whether it takes part in light transport: blocks light and, for indirect light, reflects it from both its sides. A
    /// ground that only receives does not; a lamp that does not is seen by receivers but stands in nobody's way.
    pub casts: bool,
    /// Pose keys by time in seconds, sorted, on top of the rest position, rotating about [`Object::pivot`];
    /// empty means at rest.
    pub motion: Vec<(f32, Pose)>,
    /// The point about which the motion rotates.
    pub pivot: Vec3,
    /// How it changes its shape, before the motion carries it along.
    pub deformation: Option<Arc<Deformation>>,
}

impl Object {
    /// The shape at a time in seconds, not yet carried along, and its content.
    pub(crate) fn shape_at(&self, time: f32) -> (Arc<Shape>, Content) {
        match &self.deformation {
            Some(deformation) => {
                let shape = deformation.at(&self.shape, time);
                let content = shape.content();
                (Arc::new(shape), content)
            }
            None => (self.shape.clone(), self.content),
        }
    }

    /// Diffuse albedo at texture coordinates.
    pub fn albedo_at(&self, uv: Vec2) -> Rgb {
        self.texture.as_ref().map_or(self.albedo, |texture| self.albedo * texture.at(uv))
    }

    /// Whether it is the same at all times.
    pub fn rests(&self) -> bool {
        self.motion.is_empty() && self.deformation.is_none()
    }

    /// The pose at a time in seconds; the first and last key hold before and after.
    pub fn pose_at(&self, time: f32) -> Pose {
        let next = self.motion.partition_point(|(key, _)| *key <= time);
        let pose = match (next.checked_sub(1).map(|i| self.motion[i]), self.motion.get(next)) {
            (None, None) => return Pose::IDENTITY,
            (Some((_, last)), None) => last,
            (None, Some((_, first))) => *first,
            (Some((t0, from)), Some((t1, to))) => Pose::between(from, *to, (time - t0) / (t1 - t0)),
        };
        pose.about(self.pivot)
    }

    /// Whether it is an area light.
    pub fn emits(&self) -> bool {
        !self.emission.is_none()
    }

    /// The revision of the object with a shape under a pose: changes exactly when shape, albedo, texture, emission or pose does.
    pub(crate) fn revision(&self, shape: Content, pose: Pose) -> Revision {
        let posed = Collector::new("posed").content(shape).vec3(self.albedo);
        let posed = posed.list(self.texture.as_slice(), |all, texture| all.content(texture.content()));
        self.emission.collect(posed).quat(pose.rotation).vec3(pose.translation).finish().revision()
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::*;

    fn object(motion: Vec<(f32, Pose)>, pivot: Vec3) -> Object {
        let shape = Shape::Spheres(vec![Sphere { center: pivot, radius: 1.0 }]);
        let content = shape.content();
        Object {
            name: "ball".into(),
            shape: Arc::new(shape),
            content,
            albedo: Rgb::ONE,
            texture: None,
            emission: Emission::NONE,
            casts: true,
            motion,
            pivot,
            deformation: None,
        }
    }

    fn turn(degrees: f32, translation: Vec3) -> Pose {
        Pose { rotation: Quat::from_rotation_z(degrees.to_radians()), translation }
    }

    #[test]
    fn poses_interpolate_and_hold_at_the_ends() {
        let ball = object(vec![(1.0, turn(0.0, Vec3::ZERO)), (3.0, turn(90.0, Vec3::X))], Vec3::ZERO);
        assert_eq!(ball.pose_at(0.0), Pose::IDENTITY);
        assert_eq!(ball.pose_at(9.0), turn(90.0, Vec3::X));
        let middle = ball.pose_at(2.0);
        assert!(middle.rotation.angle_between(Quat::from_rotation_z(PI / 4.0)) < 1e-3);
        assert_eq!(middle.translation, Vec3::X * 0.5);
    }

    #[test]
    fn rotation_leaves_the_pivot_alone_on_the_whole_way() {
        let pivot = Vec3::new(2.0, 1.0, 0.5);
        let ball = object(vec![(0.0, turn(0.0, Vec3::ZERO)), (1.0, turn(170.0, Vec3::ZERO))], pivot);
        for time in [0.1, 0.4, 0.5, 0.9] {
            let pose = ball.pose_at(time);
            assert!(pose.point(pivot).distance(pivot) < 1e-6, "{time}");
            assert!(pose.direction(Vec3::X).distance(Vec3::X) > 0.1);
        }
    }

    #[test]
    fn revision_follows_shape_albedo_emission_and_pose_alone() {
        let ball = object(Vec::new(), Vec3::ZERO);
        let same = Object { name: "other".into(), ..ball.clone() };
        assert_eq!(ball.revision(ball.content, Pose::IDENTITY), same.revision(same.content, Pose::IDENTITY));
        assert_ne!(ball.revision(ball.content, Pose::IDENTITY), ball.revision(ball.content, turn(0.0, Vec3::X)));
        let grey = Object { albedo: Rgb::splat(0.5), ..ball.clone() };
        assert_ne!(ball.revision(ball.content, Pose::IDENTITY), grey.revision(grey.content, Pose::IDENTITY));
        let lamp = Object { emission: Rgb::X.into(), ..ball.clone() };
        assert_ne!(ball.revision(ball.content, Pose::IDENTITY), lamp.revision(lamp.content, Pose::IDENTITY));
        assert_ne!(ball.content, object(Vec::new(), Vec3::X).content);
    }
}
