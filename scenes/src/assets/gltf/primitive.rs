//! Triangles of a mesh and what carries them.

use std::sync::Arc;

use glam::{DAffine3, DMat4, Vec2, Vec3};
use gltf::mesh::{Mode, Semantic};
use gltf::{Node, Primitive};

use super::hierarchy::Nodes;
use super::{File, Wanted};
use crate::animation::{Bone, Influences, Skeleton, Skin, strongest};
use crate::assets::proper;
use crate::{Mesh, SceneError};

/// A primitive as it stands at rest, and bound; none if it holds no triangles.
pub(super) fn read(
    file: &File,
    nodes: &Nodes,
    skeleton: &Arc<Skeleton>,
    node: &Node,
    primitive: &Primitive,
    wanted: &Wanted,
    notices: &mut Vec<String>,
) -> Result<Option<(Mesh, Skin)>, SceneError> {
    let place = format!("meshes[{}].primitives[{}]", node.mesh().map_or(0, |mesh| mesh.index()), primitive.index());
    if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        notices.push(format!("{}: {place}: points and lines left out", file.check.file.display()));
        return Ok(None);
    }
    if primitive.morph_targets().len() > 0 {
        notices.push(format!("{}: {place}: morph targets left out", file.check.file.display()));
    }
    let (mesh, mended) = proper::mesh(file.check, raw(file, &place, primitive)?, wanted.drop_degenerate)?;
    notices.extend(mended.notices(&format!("{}: {place}", file.check.file.display())));
    let Mesh { positions, normals, uvs, triangles } = mesh;
    let skin = match (node.skin(), influences(file, &place, primitive, positions.len())?) {
        (Some(skin), Some(influences)) => {
            let bones = bones(file, nodes, &skin)?;
            let most = influences.iter().flatten().map(|(bone, _)| usize::from(*bone)).max().unwrap_or(0);
            file.check.ensure(most < bones.len(), &place, &format!("joints below {}", bones.len()), most)?;
            Skin { skeleton: skeleton.clone(), bones, positions, normals, influences }
        }
        _ => Skin::rigid(skeleton.clone(), nodes.joint_of[node.index()], positions, normals),
    };
    let joints = skeleton.at_rest();
    // To the last bit, down to the signs of zeros: a model that was written from a scene is that scene's again.
    if skin.palette(&joints, DAffine3::IDENTITY) == [DAffine3::IDENTITY] {
        let (positions, normals) = (skin.positions.clone(), skin.normals.clone());
        return Ok(Some((Mesh { positions, normals, uvs, triangles }, skin)));
    }
    let (positions, normals) = skin.posed(&joints, DAffine3::IDENTITY);
    let posed = Mesh { positions, normals, uvs, triangles };
    proper::mesh(file.check, posed.clone(), true)?;
    Ok(Some((posed, skin)))
}

fn raw(file: &File, place: &str, primitive: &Primitive) -> Result<Mesh, SceneError> {
    let vectors = |semantic| -> Result<Vec<Vec3>, SceneError> {
        let Some(accessor) = primitive.get(&semantic) else { return Ok(Vec::new()) };
        Ok(file.numbers::<3>(&accessor)?.into_iter().map(|v| Vec3::from_array(v.map(|v| v as f32))).collect())
    };
    let (positions, mut normals) = (vectors(Semantic::Positions)?, vectors(Semantic::Normals)?);
    let mut uvs: Vec<Vec2> = match primitive.get(&Semantic::TexCoords(0)) {
        Some(accessor) => {
            file.numbers::<2>(&accessor)?.into_iter().map(|uv| Vec2::from_array(uv.map(|v| v as f32))).collect()
        }
        None => Vec::new(),
    };
    let matches = |count: usize| count == 0 || count == positions.len();
    let counts = (normals.len(), uvs.len());
    let expected = format!("normals and texture coordinates for {} positions", positions.len());
    file.check.ensure(matches(counts.0) && matches(counts.1), place, &expected, counts)?;
    let mut corners: Vec<u32> = match primitive.indices() {
        Some(accessor) => file.numbers::<1>(&accessor)?.into_iter().map(|[index]| index as u32).collect(),
        None => (0..positions.len() as u32).collect(),
    };
    if normals.iter().any(|normal| normal.length_squared() < 1e-12) {
        normals.clear();
    }
    if corners.len() < 3 {
        return Err(file.check.invalid(place, "at least three corners", corners.len()));
    }
    if primitive.mode() == Mode::Triangles {
        corners.truncate(corners.len() / 3 * 3);
    }
    if uvs.iter().any(|uv| !uv.is_finite()) {
        uvs.clear();
    }
    Ok(Mesh { positions, normals, uvs, triangles: triangles(primitive.mode(), &corners) })
}

fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleFan => corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]).collect(),
        Mode::TriangleStrip => {
            let turned = |(i, window): (usize, &[u32])| match i % 2 {
                0 => [window[0], window[1], window[2]],
                _ => [window[1], window[0], window[2]],
            };
            let all = corners.windows(3).enumerate().map(turned);
            // Strips are joined by triangles without area, which the format allows.
            all.filter(|[a, b, c]| a != b && b != c && c != a).collect()
        }
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}

/// None without joints and weights. All sets count; of more than four influences the strongest stay.
fn influences(
    file: &File,
    place: &str,
    primitive: &Primitive,
    vertices: usize,
) -> Result<Option<Vec<Influences>>, SceneError> {
    let mut all: Vec<Vec<(u16, f32)>> = vec![Vec::new(); vertices];
    let mut set = 0;
    while let (Some(joints), Some(weights)) =
        (primitive.get(&Semantic::Joints(set)), primitive.get(&Semantic::Weights(set)))
    {
        let (joints, weights) = (file.numbers::<4>(&joints)?, file.numbers::<4>(&weights)?);
        let counts = (joints.len(), weights.len());
        file.check.ensure(counts == (vertices, vertices), place, "joints and weights for each vertex", counts)?;
        for ((all, joints), weights) in all.iter_mut().zip(joints).zip(weights) {
            all.extend(joints.into_iter().zip(weights).map(|(joint, weight)| (joint as u16, weight as f32)));
        }
        set += 1;
    }
    Ok((set > 0).then(|| all.into_iter().map(strongest).collect()))
}

fn bones(file: &File, nodes: &Nodes, skin: &gltf::Skin) -> Result<Vec<Bone>, SceneError> {
    let joints: Vec<usize> = skin.joints().map(|node| nodes.joint_of[node.index()]).collect();
    let matrices = match skin.inverse_bind_matrices() {
        None => vec![DAffine3::IDENTITY; joints.len()],
        Some(accessor) => {
            let affine = |columns: [f64; 16]| DAffine3::from_mat4(DMat4::from_cols_array(&columns));
            file.numbers::<16>(&accessor)?.into_iter().map(affine).collect()
        }
    };
    let field = format!("skins[{}]", skin.index());
    file.check.ensure(matrices.len() >= joints.len(), &field, "an inverse bind matrix a joint", matrices.len())?;
    Ok(joints.into_iter().zip(matrices).map(|(joint, inverse_bind)| Bone { joint, inverse_bind }).collect())
}
