//! Objects of a scene file: shapes generated or read, brought into rest position.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Quat, Vec2, Vec3};

use crate::assets::{Assets, Image};
use crate::check::{Checker, FAR};
use crate::format::{KeyFile, MeshFile, ObjectFile, RandomSpheresFile, Up};
use crate::random::SplitMix;
use crate::{Mesh, Object, Pose, SceneError, Shape, Sphere, mesh};

const MOST_SPHERES: usize = 1 << 20;

/// The rest transform: scale, rotate, translate.
pub(super) struct Rest {
    pub(super) scale: f32,
    pub(super) rotation: Quat,
    pub(super) translation: Vec3,
}

impl Rest {
    pub(super) fn affine(&self) -> DAffine3 {
        let (rotation, translation) = (self.rotation.as_dquat().normalize(), self.translation.as_dvec3());
        DAffine3::from_scale_rotation_translation(DVec3::splat(f64::from(self.scale)), rotation, translation)
    }

    pub(super) fn point(&self, p: Vec3) -> Vec3 {
        self.rotation * (p * self.scale) + self.translation
    }
}

pub(crate) fn load(
    check: Checker,
    assets: &Assets,
    files: &[ObjectFile],
    notices: &mut Vec<String>,
) -> Result<Vec<Object>, SceneError> {
    check.ensure(!files.is_empty(), "objects", "at least one object", files.len())?;
    let mut objects: Vec<Object> = Vec::new();
    for (index, file) in files.iter().enumerate() {
        let source = Source { check, assets, field: format!("objects[{index}]"), file };
        for object in source.objects(notices)? {
            let taken = objects.iter().any(|other| other.name == object.name);
            let named = !object.name.is_empty() && !taken;
            let expected = "a name that no other object has";
            check.ensure(named, &format!("{}.name", source.field), expected, &object.name)?;
            objects.push(object);
        }
    }
    Ok(objects)
}

/// An entry of a scene file.
pub(super) struct Source<'a> {
    pub(super) check: Checker<'a>,
    pub(super) assets: &'a Assets<'a>,
    pub(super) field: String,
    pub(super) file: &'a ObjectFile,
}

impl Source<'_> {
    fn objects(&self, notices: &mut Vec<String>) -> Result<Vec<Object>, SceneError> {
        self.only_one_shape()?;
        self.only_plain_emission()?;
        let rest = self.rest()?;
        match (&self.file.gltf, &self.file.character) {
            (Some(gltf), _) => self.gltf(gltf, &rest, notices),
            (_, Some(character)) => Ok(vec![self.character(character, &rest)?]),
            _ => {
                let picture = self.emission_map(notices)?;
                let shape = self.placed(self.shape(picture.as_ref(), notices)?, &rest)?;
                let deformation = self.deformation(&shape, &rest)?;
                let object = self.object(shape, &rest)?;
                Ok(vec![Object { deformation, emission: self.emission(&object, picture)?, ..object }])
            }
        }
    }

    fn rest(&self) -> Result<Rest, SceneError> {
        let (check, field, file) = (self.check, &self.field, self.file);
        let rotate = format!("{field}.rotate");
        let rotation = file.rotate.as_ref().map(|rotation| check.rotation(&rotate, rotation)).transpose()?;
        Ok(Rest {
            scale: check.positive(&format!("{field}.scale"), file.scale)?,
            rotation: rotation.unwrap_or(Quat::IDENTITY),
            translation: check.point(&format!("{field}.translate"), file.translate)?,
        })
    }

    /// An object of a shape that is in place, with what the entry says of all objects.
    pub(super) fn object(&self, shape: Shape, rest: &Rest) -> Result<Object, SceneError> {
        let (check, field, file) = (self.check, &self.field, self.file);
        let missing = || check.invalid(&format!("{field}.albedo"), "three numbers in [0, 1]", "none");
        let albedo = match (file.albedo, &file.gltf) {
            (None, Some(_)) => [1.0; 3],
            (albedo, _) => albedo.ok_or_else(missing)?,
        };
        Ok(Object {
            name: file.name.clone(),
            content: shape.content(),
            shape: Arc::new(shape),
            albedo: check.albedo(&format!("{field}.albedo"), albedo)?,
            texture: None,
            emission: check.radiance(&format!("{field}.emission"), file.emission)?.into(),
            casts: file.casts,
            motion: motion(check, field, &file.motion)?,
            pivot: rest.translation,
            deformation: None,
        })
    }

    pub(super) fn placed(&self, shape: Shape, rest: &Rest) -> Result<Shape, SceneError> {
        let (check, field) = (self.check, &self.field);
        Ok(match shape {
            Shape::Mesh(mesh) => Shape::Mesh(rest_mesh(check, field, mesh, rest)?),
            Shape::Spheres(spheres) => Shape::Spheres(rest_spheres(check, field, &spheres, rest)?),
            Shape::Heights(heights) => {
                super::heights::upright(check, field, self.file)?;
                Shape::Heights(super::heights::at_rest(check, field, &heights, rest.scale, rest.translation)?)
            }
        })
    }

    fn only_one_shape(&self) -> Result<(), SceneError> {
        let file = self.file;
        let given = [
            ("mesh", file.mesh.is_some()),
            ("sphere", file.sphere.is_some()),
            ("random_spheres", file.random_spheres.is_some()),
            ("plane", file.plane.is_some()),
            ("heights", file.heights.is_some()),
            ("ball", file.ball.is_some()),
            ("block", file.block.is_some()),
            ("cylinder", file.cylinder.is_some()),
            ("blob", file.blob.is_some()),
            ("character", file.character.is_some()),
            ("gltf", file.gltf.is_some()),
        ];
        match given.iter().filter(|(_, given)| *given).count() {
            1 => Ok(()),
            _ => Err(self.check.not_one(&self.field, &given)),
        }
    }

    fn shape(&self, emission: Option<&Image>, notices: &mut Vec<String>) -> Result<Shape, SceneError> {
        let (check, assets, file) = (self.check, self.assets, self.file);
        let at = |name: &str| format!("{}.{name}", self.field);
        if let Some(mesh) = &file.mesh {
            read_mesh(assets, &at("mesh"), mesh, notices).map(Shape::Mesh)
        } else if let Some(sphere) = &file.sphere {
            let center = check.point(&at("sphere.center"), sphere.center)?;
            let radius = check.positive(&at("sphere.radius"), sphere.radius)?;
            Ok(Shape::Spheres(vec![Sphere { center, radius }]))
        } else if let Some(spheres) = &file.random_spheres {
            random_spheres(check, &at("random_spheres"), spheres).map(Shape::Spheres)
        } else if let Some(plane) = &file.plane {
            let [width, height] = plane.size.map(|side| check.positive(&at("plane.size"), side));
            let size = Vec2::new(width?, height?);
            Ok(Shape::Mesh(match emission {
                None => mesh::plane(size),
                Some(picture) => mesh::cells(size, picture.width, picture.height),
            }))
        } else if let Some(heights) = &file.heights {
            super::heights::load(check, assets, &at("heights"), heights, notices).map(Shape::Heights)
        } else {
            super::solids::load(check, &self.field, file).map(Shape::Mesh)
        }
    }
}

fn read_mesh(assets: &Assets, field: &str, file: &MeshFile, notices: &mut Vec<String>) -> Result<Mesh, SceneError> {
    let asset = assets.read(field, &file.file, file.sha256.as_deref())?;
    let (mut mesh, mended) = asset.mesh(file.weld, file.drop_degenerate)?;
    notices.extend(mended.notices(&asset.path.display().to_string()));
    if let Up::Y = file.up {
        let upright = |v: &mut Vec3| *v = Vec3::new(v.x, -v.z, v.y);
        mesh.positions.iter_mut().chain(&mut mesh.normals).for_each(upright);
    }
    Ok(mesh)
}

fn rest_mesh(check: Checker, field: &str, mesh: Mesh, rest: &Rest) -> Result<Mesh, SceneError> {
    let positions: Vec<Vec3> = mesh.positions.iter().map(|p| rest.point(*p)).collect();
    if let Some(far) = positions.iter().find(|p| p.abs().max_element() > FAR) {
        return Err(check.invalid(field, "coordinates of at most 1e9 after scale, rotate and translate", far));
    }
    let normals = mesh.normals.iter().map(|n| (rest.rotation * *n).normalize()).collect();
    let mesh = Mesh { positions, normals, ..mesh };
    match (0..mesh.triangles.len()).find(|triangle| mesh.face_normal(*triangle) == Vec3::ZERO) {
        None => Ok(mesh),
        Some(triangle) => {
            let expected = "a scale and translation under which no triangle loses its area to rounding";
            Err(check.invalid(field, expected, format!("triangle {triangle} at {}", mesh.corners(triangle)[0])))
        }
    }
}

fn rest_spheres(check: Checker, field: &str, spheres: &[Sphere], rest: &Rest) -> Result<Vec<Sphere>, SceneError> {
    let placed = |sphere: &Sphere| {
        let radius = check.positive(&format!("{field}.scale: radius"), sphere.radius * rest.scale)?;
        let center = check.point(&format!("{field}.translate: center"), rest.point(sphere.center).into())?;
        Ok(Sphere { center, radius })
    };
    spheres.iter().map(placed).collect()
}

fn random_spheres(check: Checker, field: &str, file: &RandomSpheresFile) -> Result<Vec<Sphere>, SceneError> {
    check.count(&format!("{field}.count"), file.count, MOST_SPHERES)?;
    let low = check.point(&format!("{field}.low"), file.low)?;
    let high = check.point(&format!("{field}.high"), file.high)?;
    check.ensure(low.cmple(high).all(), &format!("{field}.high"), "a corner not below `low`", file.high)?;
    let [least, most] = file.radius;
    let holds = least > 0.0 && least <= most && most <= FAR;
    check.ensure(
        holds,
        &format!("{field}.radius"),
        "a positive least and a not smaller greatest radius",
        file.radius,
    )?;
    let mut random = SplitMix(file.seed);
    let sphere = |_| {
        let inside = Vec3::new(random.unit(), random.unit(), random.unit());
        Sphere { center: low + (high - low) * inside, radius: least + (most - least) * random.unit() }
    };
    Ok((0..file.count).map(sphere).collect())
}

fn motion(check: Checker, field: &str, keys: &[KeyFile]) -> Result<Vec<(f32, Pose)>, SceneError> {
    let mut motion: Vec<(f32, Pose)> = Vec::new();
    for (index, key) in keys.iter().enumerate() {
        let field = format!("{field}.motion[{index}]");
        let time = check.number(&format!("{field}.time"), key.time)?;
        let later = motion.last().is_none_or(|(last, _)| time > *last);
        check.ensure(later, &format!("{field}.time"), "a time after the one before", time)?;
        let rotate = format!("{field}.rotate");
        let rotation = key.rotate.as_ref().map(|rotation| check.rotation(&rotate, rotation)).transpose()?;
        let translation = check.point(&format!("{field}.translate"), key.translate)?;
        motion.push((time, Pose { rotation: rotation.unwrap_or(Quat::IDENTITY), translation }));
    }
    Ok(motion)
}
