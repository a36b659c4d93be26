//! What changes its shape: procedural deformations, characters, glTF models.

use std::sync::Arc;

use glam::{DAffine3, DQuat, Quat, Vec3};

use super::body;
use super::objects::{Rest, Source};
use crate::animation::{Bone, Kind, Playback, Skeleton, Skin};
use crate::assets::{Part, Wanted};
use crate::format::{CharacterFile, GltfFile, PlayFile};
use crate::{Deformation, Form, Mesh, Object, Procedural, SceneError, Shape};

/// From y up to z up: x stays.
fn upright() -> DAffine3 {
    DAffine3::from_quat(DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2))
}

impl Source<'_> {
    /// The change of shape that the entry asks for.
    pub(super) fn deformation(&self, shape: &Shape, rest: &Rest) -> Result<Option<Arc<Deformation>>, SceneError> {
        let Some(heights) = &self.file.heights else { return self.procedural(shape, rest) };
        self.no_deform()?;
        let swell = super::heights::swell(self.check, &format!("{}.heights", self.field), heights, rest)?;
        Ok(swell.map(|swell| Arc::new(Deformation::new(Kind::Swell(swell), rest.affine()))))
    }

    /// The deformation by formula that the entry asks for.
    fn procedural(&self, shape: &Shape, rest: &Rest) -> Result<Option<Arc<Deformation>>, SceneError> {
        let (check, field) = (self.check, format!("{}.deform", self.field));
        let Some(file) = &self.file.deform else { return Ok(None) };
        check.ensure(matches!(shape, Shape::Mesh(_)), &field, "only beside a mesh or a solid", &self.file.name)?;
        let angle = |degrees| check.number(&format!("{field}.degrees"), degrees).map(|d| f64::from(d).to_radians());
        let length = |name: &str, value| check.positive(&format!("{field}.{name}"), value).map(f64::from);
        let share = |name: &str, value: f32| {
            check.ensure(value.abs() < 1.0, &format!("{field}.egg.{name}"), "a number between -1 and 1", value)
        };
        let form = match (&file.twist, &file.bend, &file.flap, &file.egg) {
            (Some(twist), None, None, None) => {
                Form::Twist { angle: angle(twist.degrees)?, height: length("twist.height", twist.height)? }
            }
            (None, Some(bend), None, None) => {
                Form::Bend { angle: angle(bend.degrees)?, length: length("bend.length", bend.length)? }
            }
            (None, None, Some(flap), None) => {
                Form::Flap { angle: angle(flap.degrees)?, hinge: length("flap.hinge", flap.hinge)? }
            }
            (None, None, None, Some(egg)) => {
                Form::Egg { stretch: share("stretch", egg.stretch)?.into(), taper: share("taper", egg.taper)?.into() }
            }
            (twist, bend, flap, egg) => {
                let given = [
                    ("twist", twist.is_some()),
                    ("bend", bend.is_some()),
                    ("flap", flap.is_some()),
                    ("egg", egg.is_some()),
                ];
                return Err(check.not_one(&field, &given));
            }
        };
        let procedural = Procedural { form, period: length("period", file.period)? };
        Ok(Some(Arc::new(Deformation::new(Kind::Procedural(procedural), rest.affine()))))
    }

    /// A body around captured motion.
    pub(super) fn character(&self, file: &CharacterFile, rest: &Rest) -> Result<Object, SceneError> {
        let (check, field) = (self.check, format!("{}.character", self.field));
        self.no_deform()?;
        let capture = self.assets.read(&field, &file.file, file.sha256.as_deref())?.capture()?;
        let thickness = check.positive(&format!("{field}.thickness"), file.thickness)?;
        let holds = (16..=512).contains(&file.resolution);
        check.ensure(holds, &format!("{field}.resolution"), "a whole number in 16..=512", file.resolution)?;
        let body = body::around(&capture, thickness, file.resolution as u32).ok_or_else(|| {
            check.invalid(&field, "a skeleton with at least one bone that has a length", capture.joints.len())
        })?;
        let playback = self.playback(&field, &file.play)?;
        let skeleton = Skeleton { joints: capture.joints, clip: capture.clip, playback };
        let bind = skeleton.at_rest();
        let bones = bind.iter().enumerate().map(|(joint, bind)| Bone { joint, inverse_bind: bind.inverse() }).collect();
        let Mesh { positions, normals, uvs, triangles } = body.mesh;
        let skin = Skin { skeleton: Arc::new(skeleton), bones, positions, normals, influences: body.influences };
        let (positions, normals) = skin.posed(&bind, upright());
        let mesh = Mesh { positions, normals, uvs, triangles };
        let shape = self.placed(Shape::Mesh(mesh), rest)?;
        let deformation = Deformation::new(Kind::Skin(skin), rest.affine() * upright());
        Ok(Object { deformation: Some(Arc::new(deformation)), ..self.object(shape, rest)? })
    }

    /// The meshes of a glTF file, one object for each of its materials.
    pub(super) fn gltf(
        &self,
        file: &GltfFile,
        rest: &Rest,
        notices: &mut Vec<String>,
    ) -> Result<Vec<Object>, SceneError> {
        let field = format!("{}.gltf", self.field);
        self.no_deform()?;
        let (clip, playback) = (file.clip.as_deref(), self.playback(&field, &file.play)?);
        let wanted = Wanted { clip, playback, drop_degenerate: file.drop_degenerate };
        let parts = self.assets.read(&field, &file.file, file.sha256.as_deref())?.gltf(&wanted, notices)?;
        let several = parts.len() > 1;
        let name = |index: usize| if several { format!("{}.{index}", self.file.name) } else { self.file.name.clone() };
        parts.into_iter().enumerate().map(|(index, part)| self.part(name(index), part, rest)).collect()
    }

    fn part(&self, name: String, part: Part, rest: &Rest) -> Result<Object, SceneError> {
        let Mesh { positions, normals, uvs, triangles } = part.mesh;
        let turn = |v: Vec3| Vec3::new(v.x, -v.z, v.y);
        let positions = positions.into_iter().map(turn).collect();
        let normals: Vec<Vec3> = normals.into_iter().map(turn).collect();
        // Where nothing turns them, unit normals need no second rounding.
        let kept = (rest.rotation == Quat::IDENTITY).then(|| normals.clone());
        let shape = match (self.placed(Shape::Mesh(Mesh { positions, normals, uvs, triangles }), rest)?, kept) {
            (Shape::Mesh(mesh), Some(normals)) => Shape::Mesh(Mesh { normals, ..mesh }),
            (shape, _) => shape,
        };
        let object = self.object(shape, rest)?;
        let deformation = || Deformation::new(Kind::Skin(part.skin), rest.affine() * upright());
        let plain = self.file.albedo.is_some();
        Ok(Object {
            name,
            albedo: if plain { object.albedo } else { part.albedo },
            texture: if plain { None } else { part.texture },
            emission: part.emission.plus(object.emission.of(0)),
            casts: object.casts && part.ours.casts.unwrap_or(true),
            pivot: part.ours.pivot.map_or(object.pivot, |pivot| rest.point(turn(pivot.into()))),
            deformation: part.animated.then(|| Arc::new(deformation())),
            ..object
        })
    }

    fn playback(&self, field: &str, play: &PlayFile) -> Result<Playback, SceneError> {
        let number = |name: &str, value| self.check.number(&format!("{field}.play.{name}"), value).map(f64::from);
        Ok(Playback { start: number("start", play.start)?, speed: number("speed", play.speed)?, repeat: play.repeat })
    }

    fn no_deform(&self) -> Result<(), SceneError> {
        let holds = self.file.deform.is_none();
        self.check.ensure(
            holds,
            &format!("{}.deform", self.field),
            "only beside a mesh or a solid",
            &self.file.name,
        )?;
        Ok(())
    }
}
