//! Wavefront OBJ: polygons with optional texture coordinates and normals. Groups and materials are ignored.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use crate::check::Checker;
use crate::{Mesh, SceneError, mesh};

use super::text::{Line, decoded, fan, lines};

/// Keywords that say nothing about the surface.
const IGNORED: [&str; 8] = ["g", "o", "s", "usemtl", "mtllib", "l", "p", "mg"];

/// Indices into positions, texture coordinates and normals.
type Corner = [Option<u32>; 3];

#[derive(Default)]
struct Obj {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    triangles: Vec<[Corner; 3]>,
}

pub(super) fn read(check: Checker, bytes: &[u8]) -> Result<Mesh, SceneError> {
    // A backslash at the end of a line continues it.
    let text = decoded(bytes).replace("\\\r\n", " ").replace("\\\n", " ");
    let mut obj = Obj::default();
    for line in lines(check, &text) {
        match line.words[0] {
            "v" => obj.positions.push(line.vec3(1)?),
            "vn" => obj.normals.push(line.vec3(1)?),
            "vt" => obj.uvs.push(Vec2::new(line.number(1, "a number")?, texture_v(&line)?)),
            "f" => {
                let words = &line.words[1..];
                let corners: Vec<Corner> =
                    words.iter().map(|word| obj.corner(&line, word)).collect::<Result<_, _>>()?;
                if corners.len() < 3 {
                    return Err(line.expected("at least three corners"));
                }
                obj.triangles.extend(fan(&corners));
            }
            word if IGNORED.contains(&word) => {}
            _ => return Err(line.expected("v, vt, vn or f (free-form surfaces are not read)")),
        }
    }
    Ok(obj.into_mesh())
}

fn texture_v(line: &Line) -> Result<f32, SceneError> {
    if line.words.len() > 2 { line.number(2, "a number") } else { Ok(0.0) }
}

impl Obj {
    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`; from 1, or from the end if negative.
    fn corner(&self, line: &Line, word: &str) -> Result<Corner, SceneError> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [None; 3];
        for (slot, part) in word.split('/').enumerate() {
            if slot > 2 || (slot == 0 && part.is_empty()) {
                return Err(line.expected("corners as position/uv/normal"));
            }
            if !part.is_empty() {
                let index: i64 = part.parse().map_err(|_| line.expected("corners as whole numbers"))?;
                let count = counts[slot] as i64;
                let from_start = if index < 0 { count + index } else { index - 1 };
                if !(0..count).contains(&from_start) {
                    let what = ["vertices", "texture coordinates", "normals"][slot];
                    return Err(line.expected(format!("indices within the {count} {what} above")));
                }
                corner[slot] = Some(from_start as u32);
            }
        }
        Ok(corner)
    }

    /// One vertex for each combination of indices. Missing normals come from the faces around a *position*, so that
    /// a seam of the texture is no crease.
    fn into_mesh(self) -> Mesh {
        let all = |slot: usize| self.triangles.iter().flatten().all(|corner| corner[slot].is_some());
        let (has_uvs, has_normals) = (all(1), all(2));
        let position = |corner: &Corner| corner[0].expect("every corner has a position");
        let smooth = match has_normals {
            true => Vec::new(),
            false => {
                let triangles: Vec<[u32; 3]> =
                    self.triangles.iter().map(|corners| corners.map(|c| position(&c))).collect();
                mesh::vertex_normals(&self.positions, &triangles)
            }
        };
        let mut mesh = Mesh::default();
        let mut known = HashMap::new();
        for corners in &self.triangles {
            let triangle = corners.map(|[p, uv, n]| {
                let corner = [p, uv.filter(|_| has_uvs), n.filter(|_| has_normals)];
                *known.entry(corner).or_insert_with(|| {
                    let at = position(&corner) as usize;
                    mesh.positions.push(self.positions[at]);
                    mesh.normals.push(corner[2].map_or_else(|| smooth[at], |n| self.normals[n as usize]));
                    mesh.uvs.extend(corner[1].map(|uv| self.uvs[uv as usize]));
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.triangles.push(triangle);
        }
        mesh
    }
}
