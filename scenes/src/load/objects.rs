//! Objects of a scene file: shapes generated or read, brought into rest position.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use crate::assets::Assets;
use crate::check::{Checker, FAR};
use crate::format::{KeyFile, MeshFile, ObjectFile, RandomSpheresFile, Up};
use crate::random::SplitMix;
use crate::{Mesh, Object, Pose, SceneError, Shape, Sphere, mesh};

const MOST_SPHERES: usize = 1 << 20;

/// The rest transform: scale, rotate, translate.
struct Rest {
    scale: f32,
    rotation: Quat,
    translation: Vec3,
}

impl Rest {
    fn point(&self, p: Vec3) -> Vec3 {
        self.rotation * (p * self.scale) + self.translation
    }
}

pub(super) fn load(
    check: Checker,
    assets: &Assets,
    files: &[ObjectFile],
    notices: &mut Vec<String>,
) -> Result<Vec<Object>, SceneError> {
    check.ensure(!files.is_empty(), "objects", "at least one object", files.len())?;
    let mut objects: Vec<Object> = Vec::new();
    for (index, file) in files.iter().enumerate() {
        let field = format!("objects[{index}]");
        let taken = objects.iter().any(|other| other.name == file.name);
        let named = !file.name.is_empty() && !taken;
        check.ensure(named, &format!("{field}.name"), "a name that no other object has", &file.name)?;
        objects.push(object(check, assets, &field, file, notices)?);
    }
    Ok(objects)
}

fn object(
    check: Checker,
    assets: &Assets,
    field: &str,
    file: &ObjectFile,
    notices: &mut Vec<String>,
) -> Result<Object, SceneError> {
    let rotate = format!("{field}.rotate");
    let rotation = file.rotate.as_ref().map(|rotation| check.rotation(&rotate, rotation)).transpose()?;
    let rest = Rest {
        scale: check.positive(&format!("{field}.scale"), file.scale)?,
        rotation: rotation.unwrap_or(Quat::IDENTITY),
        translation: check.point(&format!("{field}.translate"), file.translate)?,
    };
    let shape = match shape(check, assets, field, file, notices)? {
        Shape::Mesh(mesh) => Shape::Mesh(rest_mesh(check, field, mesh, &rest)?),
        Shape::Spheres(spheres) => Shape::Spheres(rest_spheres(check, field, &spheres, &rest)?),
        Shape::Heights(heights) => {
            super::heights::upright(check, field, file)?;
            Shape::Heights(super::heights::at_rest(check, field, &heights, rest.scale, rest.translation)?)
        }
    };
    Ok(Object {
        name: file.name.clone(),
        content: shape.content(),
        shape: Arc::new(shape),
        albedo: check.albedo(&format!("{field}.albedo"), file.albedo)?,
        emission: check.radiance(&format!("{field}.emission"), file.emission)?,
        casts: file.casts,
        motion: motion(check, field, &file.motion)?,
        pivot: rest.translation,
    })
}

fn shape(
    check: Checker,
    assets: &Assets,
    field: &str,
    file: &ObjectFile,
    notices: &mut Vec<String>,
) -> Result<Shape, SceneError> {
    match (&file.mesh, &file.sphere, &file.random_spheres, &file.plane, &file.heights) {
        (Some(mesh), None, None, None, None) => {
            read_mesh(assets, &format!("{field}.mesh"), mesh, notices).map(Shape::Mesh)
        }
        (None, Some(sphere), None, None, None) => {
            let center = check.point(&format!("{field}.sphere.center"), sphere.center)?;
            let radius = check.positive(&format!("{field}.sphere.radius"), sphere.radius)?;
            Ok(Shape::Spheres(vec![Sphere { center, radius }]))
        }
        (None, None, Some(spheres), None, None) => {
            random_spheres(check, &format!("{field}.random_spheres"), spheres).map(Shape::Spheres)
        }
        (None, None, None, Some(plane), None) => {
            let size = plane.size.map(|side| check.positive(&format!("{field}.plane.size"), side));
            let [width, height] = size;
            Ok(Shape::Mesh(mesh::plane(Vec2::new(width?, height?))))
        }
        (None, None, None, None, Some(heights)) => {
            super::heights::load(check, assets, &format!("{field}.heights"), heights).map(Shape::Heights)
        }
        (mesh, sphere, spheres, plane, heights) => {
            let given = [
                ("mesh", mesh.is_some()),
                ("sphere", sphere.is_some()),
                ("random_spheres", spheres.is_some()),
                ("plane", plane.is_some()),
                ("heights", heights.is_some()),
            ];
            Err(check.not_one(field, &given))
        }
    }
}

fn read_mesh(assets: &Assets, field: &str, file: &MeshFile, notices: &mut Vec<String>) -> Result<Mesh, SceneError> {
    let asset = assets.read(field, &file.file, file.sha256.as_deref())?;
    let (mut mesh, dropped) = asset.mesh(file.weld, file.drop_degenerate)?;
    if dropped > 0 {
        notices.push(format!("{}: dropped {dropped} triangles without area", asset.path.display()));
    }
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
