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
    let Gltf { document, blob } = Gltf::from_slice(&asset.bytes).map_err(|error| malformed(asset, &error))?;
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
fn malformed(asset: &Asset, error: &gltf::Error) -> SceneError {
    let check = asset.check();
    if let Some(version) = version(&asset.bytes).filter(|version| !version.starts_with("2.")) {
        return check.invalid("asset.version", "2.0", version);
    }
    let text: Vec<String> = match error {
        gltf::Error::Validation(found) => {
            // What follows an extension that we lack may be its consequence.
            let lacking = found.iter().filter(|(_, error)| *error == gltf::json::validation::Error::Unsupported);
            let others = found.iter().filter(|(_, error)| *error != gltf::json::validation::Error::Unsupported);
            lacking.chain(others).take(3).map(|(path, error)| format!("{path}: {error}")).collect()
        }
        other => vec![other.to_string()],
    };
    check.malformed("glTF", text.join("; ").replace('\n', ", "))
}

/// The version that a file says it has.
fn version(bytes: &[u8]) -> Option<String> {
    #[derive(serde::Deserialize)]
    struct Versioned {
        asset: Version,
    }
    #[derive(serde::Deserialize)]
    struct Version {
        version: String,
    }
    match bytes {
        [b'g', b'l', b'T', b'F', 1, 0, 0, 0, ..] => Some("1.0".into()),
        _ => gltf::json::deserialize::from_slice::<Versioned>(bytes).ok().map(|file| file.asset.version),
    }
}

fn place(node: &Node) -> String {
    format!("nodes[{}]", node.index())
}
