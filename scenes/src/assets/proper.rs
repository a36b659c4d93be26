//! What every mesh must hold, whatever file it comes from.

use std::collections::HashMap;

use glam::Vec3;

use crate::check::{Checker, FAR};
use crate::{Mesh, SceneError, mesh};

/// A triangle counts as without area if it is thinner than this fraction of its longest edge: the resolution of the
/// coordinates.
const THINNEST: f64 = 1e-7;

/// What was mended of a mesh.
pub(crate) struct Mended {
    dropped: usize,
    normals: usize,
}

impl Mended {
    /// A line for each kind of repair.
    pub(crate) fn notices(&self, place: &str) -> Vec<String> {
        let all = [
            (self.dropped, format!("{place}: dropped {} triangles without area", self.dropped)),
            (
                self.normals,
                format!("{place}: {} normals had no length: taken from the faces around them", self.normals),
            ),
        ];
        all.into_iter().filter(|(count, _)| *count > 0).map(|(_, line)| line).collect()
    }
}

/// The mesh with unit normals, checked, and what was mended.
pub(super) fn mesh(check: Checker, raw: Mesh, drop_degenerate: bool) -> Result<(Mesh, Mended), SceneError> {
    let Mesh { positions, mut normals, uvs, triangles } = raw;
    let near = |position: &Vec3| position.to_array().iter().all(|v| v.abs() <= FAR);
    if let Some(index) = positions.iter().position(|position| !near(position)) {
        check.point(&format!("vertex {index}"), positions[index].to_array())?;
    }
    let found = triangles.len();
    let triangles = with_area(check, &positions, triangles, drop_degenerate)?;
    if triangles.is_empty() {
        return Err(check.invalid("faces", "at least one triangle with an area", found));
    }
    let dropped = found - triangles.len();
    let absent = normals.iter().filter(|normal| **normal == Vec3::ZERO).count();
    if normals.is_empty() || absent > 0 {
        let around = mesh::vertex_normals(&positions, &triangles);
        normals.resize(positions.len(), Vec3::ZERO);
        normals.iter_mut().zip(around).filter(|(normal, _)| **normal == Vec3::ZERO).for_each(|(to, from)| *to = from);
    }
    let normals = unit(check, normals)?;
    if let Some(index) = uvs.iter().position(|uv| uv.abs().max_element() > FAR || uv.is_nan()) {
        return Err(check.invalid(&format!("texture coordinates {index}"), "finite numbers", uvs[index]));
    }
    Ok((Mesh { positions, normals, uvs, triangles }, Mended { dropped, normals: absent }))
}

/// The mesh with one vertex a position and nothing but positions.
pub(super) fn welded(raw: &Mesh) -> Mesh {
    let mut positions = Vec::new();
    let mut known = HashMap::new();
    let mut join = |position: &Vec3| {
        // Adding 0 makes one of the two zeros.
        *known.entry(position.to_array().map(|v| (v + 0.0).to_bits())).or_insert_with(|| {
            positions.push(*position);
            positions.len() as u32 - 1
        })
    };
    let joined: Vec<u32> = raw.positions.iter().map(&mut join).collect();
    // An index beyond the vertices stays so, for the check to name it.
    let index = |i: u32| joined.get(i as usize).copied().unwrap_or(u32::MAX);
    let triangles = raw.triangles.iter().map(|triangle| triangle.map(index)).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

fn with_area(
    check: Checker,
    positions: &[Vec3],
    triangles: Vec<[u32; 3]>,
    drop_degenerate: bool,
) -> Result<Vec<[u32; 3]>, SceneError> {
    let mut kept = Vec::with_capacity(triangles.len());
    for (index, indices) in triangles.into_iter().enumerate() {
        let place = || format!("triangle {index}");
        if let Some(beyond) = indices.into_iter().find(|i| *i as usize >= positions.len()) {
            return Err(check.invalid(&place(), format!("vertex indices below {}", positions.len()), beyond));
        }
        match has_area(indices.map(|i| positions[i as usize])) {
            true => kept.push(indices),
            false if drop_degenerate => {}
            false => {
                let expected = "an area above 0 (or drop_degenerate = true in the scene)";
                return Err(check.invalid(&place(), expected, indices.map(|i| positions[i as usize].to_array())));
            }
        }
    }
    Ok(kept)
}

fn has_area(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    ab.cross(ac).length() > THINNEST * longest
}

/// Squared lengths that differ from 1 by no more than rounding to `f32` makes them.
const ROUNDING: f64 = 4e-7;

/// What is unit already stays to the last bit, so that a file that was written from a scene holds the same normals again.
fn unit(check: Checker, normals: Vec<Vec3>) -> Result<Vec<Vec3>, SceneError> {
    let unit = |(index, normal): (usize, Vec3)| match (normal.as_dvec3().length_squared() - 1.0).abs() < ROUNDING {
        true => Ok(normal),
        false => check.direction(&format!("normal {index}"), normal.to_array()),
    };
    normals.into_iter().enumerate().map(unit).collect()
}
