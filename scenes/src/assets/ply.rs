//! Polygon File Format (Turk 1994): ASCII and binary of either byte order.

mod header;
mod values;

use glam::{Vec2, Vec3};

use crate::check::Checker;
use crate::{Mesh, SceneError};

use super::text::fan;
use header::{Element, Header, Kind};
use values::Values;

pub(super) fn read(check: Checker, bytes: &[u8]) -> Result<Mesh, SceneError> {
    let (header, body) = header::parse(check, bytes)?;
    let mut values = Values::new(check, header.encoding, body);
    let mut mesh = Mesh::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(check, element, &mut values, &mut mesh)?,
            "face" => read_faces(check, &header, element, &mut values, &mut mesh)?,
            _ => skip(element, &mut values)?,
        }
    }
    values.finish()?;
    Ok(mesh)
}

/// The slots of a vertex, by the names in use for them.
const SLOTS: [&[&str]; 8] =
    [&["x"], &["y"], &["z"], &["nx"], &["ny"], &["nz"], &["s", "u", "texture_u"], &["t", "v", "texture_v"]];

fn read_vertices(check: Checker, element: &Element, values: &mut Values, mesh: &mut Mesh) -> Result<(), SceneError> {
    let slots: Vec<Option<usize>> = element.properties.iter().map(|property| slot(&property.name)).collect();
    let has = |wanted: std::ops::Range<usize>| wanted.into_iter().all(|slot| slots.contains(&Some(slot)));
    if !has(0..3) {
        return Err(check.malformed("header", "expected properties x, y and z of element vertex"));
    }
    let (has_normals, has_uvs) = (has(3..6), has(6..8));
    for index in 0..element.count {
        let place = || format!("vertex {index} of {}", element.count);
        let mut vertex = [0.0; SLOTS.len()];
        for (property, slot) in element.properties.iter().zip(&slots) {
            match (property.kind, slot) {
                (Kind::Scalar(scalar), Some(slot)) => vertex[*slot] = values.next(scalar, place)? as f32,
                (kind, _) => values.skip(kind, place)?,
            }
        }
        let [x, y, z, nx, ny, nz, u, v] = vertex;
        mesh.positions.push(Vec3::new(x, y, z));
        mesh.normals.extend(has_normals.then_some(Vec3::new(nx, ny, nz)));
        mesh.uvs.extend(has_uvs.then_some(Vec2::new(u, v)));
    }
    Ok(())
}

fn slot(name: &str) -> Option<usize> {
    SLOTS.iter().position(|names| names.contains(&name))
}

fn read_faces(
    check: Checker,
    header: &Header,
    element: &Element,
    values: &mut Values,
    mesh: &mut Mesh,
) -> Result<(), SceneError> {
    let is_corners = |name: &str| ["vertex_indices", "vertex_index"].contains(&name);
    if !element.properties.iter().any(|property| is_corners(&property.name)) {
        return Err(check.malformed("header", "expected a list property vertex_indices of element face"));
    }
    let vertices = header.elements.iter().find(|element| element.name == "vertex").map_or(0, |vertex| vertex.count);
    let mut corners = Vec::new();
    for index in 0..element.count {
        let place = || format!("face {index} of {}", element.count);
        for property in &element.properties {
            match property.kind {
                Kind::List { count, item } if is_corners(&property.name) => {
                    corners.clear();
                    for _ in 0..values.length(count, place)? {
                        let vertex = values.next(item, place)?;
                        let known = vertex.fract() == 0.0 && vertex >= 0.0 && vertex < vertices as f64;
                        if !known {
                            return Err(check.invalid(&place(), format!("vertex indices below {vertices}"), vertex));
                        }
                        corners.push(vertex as u32);
                    }
                    if corners.len() < 3 {
                        return Err(check.invalid(&place(), "at least three corners", corners.len()));
                    }
                    mesh.triangles.extend(fan(&corners));
                }
                kind => values.skip(kind, place)?,
            }
        }
    }
    Ok(())
}

fn skip(element: &Element, values: &mut Values) -> Result<(), SceneError> {
    for index in 0..element.count {
        let place = || format!("{} {index} of {}", element.name, element.count);
        for property in &element.properties {
            values.skip(property.kind, place)?;
        }
    }
    Ok(())
}
