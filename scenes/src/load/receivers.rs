//! Receivers of a scene file.

use std::sync::Arc;

use glam::Vec2;

use crate::assets::Assets;
use crate::check::Checker;
use crate::format::{GridFile, ReceiversFile};
use crate::{Camera, Grid, Object, Placement, SceneError, Shape};

use super::MOST_PIXELS;

pub(super) fn load(
    check: Checker,
    assets: &Assets,
    file: &ReceiversFile,
    objects: &[Object],
    camera: Option<&Camera>,
) -> Result<Placement, SceneError> {
    match (&file.camera, &file.vertices, &file.grid, &file.points, &file.heights) {
        (Some(_), None, None, None, None) => match camera {
            Some(_) => Ok(Placement::Camera),
            None => Err(check.invalid("receivers.camera", "a [camera] in the scene", "none")),
        },
        (None, Some(file), None, None, None) => vertices(check, &file.object, objects),
        (None, None, Some(file), None, None) => grid(check, file, objects),
        (None, None, None, Some(file), None) => {
            let asset = assets.read("receivers.points", &file.file, file.sha256.as_deref())?;
            Ok(Placement::Points(Arc::new(asset.points()?)))
        }
        (None, None, None, None, Some(file)) => heights(check, &file.object, objects),
        (camera, vertices, grid, points, heights) => {
            let given = [
                ("camera", camera.is_some()),
                ("vertices", vertices.is_some()),
                ("grid", grid.is_some()),
                ("points", points.is_some()),
                ("heights", heights.is_some()),
            ];
            Err(check.not_one("receivers", &given))
        }
    }
}

fn vertices(check: Checker, name: &str, objects: &[Object]) -> Result<Placement, SceneError> {
    let field = "receivers.vertices.object";
    let object = find(check, field, name, objects)?;
    match &*objects[object].shape {
        Shape::Mesh(_) => Ok(Placement::Vertices { object }),
        _ => Err(check.invalid(field, "an object with a mesh", name)),
    }
}

fn heights(check: Checker, name: &str, objects: &[Object]) -> Result<Placement, SceneError> {
    let field = "receivers.heights.object";
    let object = find(check, field, name, objects)?;
    match &*objects[object].shape {
        Shape::Heights(_) => Ok(Placement::Heights { object }),
        _ => Err(check.invalid(field, "an object with heights", name)),
    }
}

fn grid(check: Checker, file: &GridFile, objects: &[Object]) -> Result<Placement, SceneError> {
    let [width, height] = file.size.map(|side| check.positive("receivers.grid.size", side));
    for cells in file.resolution {
        check.count("receivers.grid.resolution", cells, MOST_PIXELS)?;
    }
    let on = file.object.as_ref().map(|name| find(check, "receivers.grid.object", name, objects));
    Ok(Placement::Grid(Grid {
        center: check.point("receivers.grid.center", file.center)?,
        size: Vec2::new(width?, height?),
        resolution: file.resolution,
        normal: check.direction("receivers.grid.normal", file.normal)?,
        object: on.transpose()?,
    }))
}

fn find(check: Checker, field: &str, name: &str, objects: &[Object]) -> Result<usize, SceneError> {
    let names: Vec<&str> = objects.iter().map(|object| object.name.as_str()).collect();
    let expected = || format!("the name of an object, one of {names:?}");
    objects.iter().position(|object| object.name == name).ok_or_else(|| check.invalid(field, expected(), name))
}
