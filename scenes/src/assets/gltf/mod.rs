//! glTF 2.0 and GLB: meshes with base colours, hierarchies, skins, animations. Space stays the file's, y up.

mod accessor;
mod bytes;
pub(crate) mod extras;
mod hierarchy;
mod material;
mod primitive;
pub(crate) mod survey;

use std::sync::Arc;

use gltf::{Document, Gltf, Node};

use crate::animation::{Playback, Skin};
use crate::assets::Asset;
use crate::check::Checker;
use crate::{Emission, Mesh, Rgb, SceneError, Texture};

use bytes::Buffers;

/// A mesh of one material, on its skeleton.
pub(crate) struct Part {
    /// As it stands without its animation.
    pub(crate) mesh: Mesh,
    pub(crate) skin: Skin,
    /// Whether the animation moves it.
    pub(crate) animated: bool,
    pub(crate) albedo: Rgb,
    pub(crate) texture: Option<Texture>,
    pub(crate) emission: Emission,
    /// What only files of ours say.
    pub(crate) ours: extras::Node,
}

/// What is taken of a file.
pub(crate) struct Wanted<'a> {
    /// Name or number of an animation.
    pub(crate) clip: Option<&'a str>,
    pub(crate) playback: Playback,
    pub(crate) drop_degenerate: bool,
}

/// A document and its bytes.
struct File<'a> {
    check: Checker<'a>,
    asset: &'a Asset,
    document: &'a Document,
    buffers: Buffers,
}

pub(super) fn read(asset: &Asset, wanted: &Wanted, notices: &mut Vec<String>) -> Result<Vec<Part>, SceneError> {
    let check = asset.check();
    let Gltf { document, blob } = Gltf::from_slice(&asset.bytes).map_err(|error| malformed(check, &error))?;
    let buffers = Buffers::load(asset, &document, blob)?;
    let file = File { check, asset, document: &document, buffers };
    let mut skeleton = hierarchy::skeleton(&file)?;
    let clip = wanted.clip.map(|name| hierarchy::clip(&file, &skeleton, name)).transpose()?;
    let moved = clip.as_ref().map_or_else(Vec::new, |clip| skeleton.moved(clip));
    skeleton.joints.clip = clip.unwrap_or_default();
    skeleton.joints.playback = wanted.playback;
    let joints = Arc::new(skeleton.joints.clone());
    let mut parts = Vec::new();
    for node in document.nodes().filter(|node| skeleton.shown[node.index()]) {
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            if let Some(skin) = primitive::read(&file, &skeleton, &joints, &node, &primitive, wanted, notices)? {
                let ours = extras::of(check, &place(&node), node.extras())?.unwrap_or_default();
                parts.push(Part { ours, ..part(&file, &primitive, skin, &moved, notices)? });
            }
        }
    }
    if parts.is_empty() {
        return Err(check.invalid("meshes", "at least one mesh of triangles in the scene", "none"));
    }
    Ok(parts)
}

fn part(
    file: &File,
    primitive: &gltf::Primitive,
    (mesh, skin): (Mesh, Skin),
    moved: &[bool],
    notices: &mut Vec<String>,
) -> Result<Part, SceneError> {
    let animated = skin.bones.iter().any(|bone| moved.get(bone.joint) == Some(&true));
    let material::Look { albedo, texture, emission } = material::look(file, &primitive.material(), &mesh, notices)?;
    Ok(Part { mesh, skin, animated, albedo, texture, emission, ours: extras::Node::default() })
}

/// One line of what may be several.
fn malformed(check: Checker, error: &gltf::Error) -> SceneError {
    let text: Vec<String> = match error {
        gltf::Error::Validation(found) => {
            found.iter().take(3).map(|(path, error)| format!("{path}: {error}")).collect()
        }
        other => vec![other.to_string()],
    };
    check.malformed("glTF", text.join("; ").replace('\n', ", "))
}

fn place(node: &Node) -> String {
    format!("nodes[{}]", node.index())
}
