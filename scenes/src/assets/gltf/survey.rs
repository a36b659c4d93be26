//! What a file holds besides meshes: lights, a camera, animations, and the files that it needs.

use glam::{DAffine3, DVec3};
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind as Written;
use gltf::{Document, Gltf};

use super::bytes::{self, Buffers};
use super::hierarchy::{self, Nodes};
use super::{File, extras, malformed, place};
use crate::SceneError;
use crate::assets::Asset;

/// In the file's space, y up, as it stands without its animations.
#[derive(Default)]
pub(crate) struct Survey {
    pub(crate) lights: Vec<Punctual>,
    pub(crate) camera: Option<View>,
    pub(crate) clips: Vec<Animation>,
    /// Buffers and pictures beside the file, paths relative to it.
    pub(crate) files: Vec<String>,
    /// What an export of ours says of the whole.
    pub(crate) scene: Option<extras::Scene>,
    pub(crate) notices: Vec<String>,
}

/// Of KHR_lights_punctual.
pub(crate) struct Punctual {
    pub(crate) shines: Shines,
    /// Lux or candela, times its colour.
    pub(crate) intensity: DVec3,
    pub(crate) extras: extras::Node,
}

pub(crate) enum Shines {
    /// From afar; unit direction towards the light.
    From(DVec3),
    /// From a point.
    At(DVec3),
}

/// A perspective camera.
pub(crate) struct View {
    pub(crate) eye: DVec3,
    /// Unit.
    pub(crate) forward: DVec3,
    /// Unit, at right angles to `forward`.
    pub(crate) up: DVec3,
    /// Vertical, in radians.
    pub(crate) fov: f32,
    /// Width by height.
    pub(crate) aspect: Option<f32>,
    pub(crate) extras: extras::Node,
}

pub(crate) struct Animation {
    /// Name, or number where that is not its own.
    pub(crate) name: String,
    pub(crate) seconds: f64,
}

pub(in crate::assets) fn survey(asset: &Asset) -> Result<Survey, SceneError> {
    let check = asset.check();
    let Gltf { document, blob } = Gltf::from_slice(&asset.bytes).map_err(|error| malformed(asset, &error))?;
    let file = File { check, asset, document: &document, buffers: Buffers::load(asset, &document, blob)? };
    let nodes = hierarchy::skeleton(&file)?;
    let at_rest = nodes.joints.at_rest();
    let shown = document.default_scene().or_else(|| document.scenes().next());
    let ours = shown.map(|scene| extras::of(check, &format!("scenes[{}]", scene.index()), scene.extras()));
    let mut survey = Survey {
        clips: clips(&file, &nodes)?,
        files: files(&document),
        scene: ours.transpose()?.flatten(),
        ..Survey::default()
    };
    for node in document.nodes().filter(|node| nodes.shown[node.index()]) {
        let carrier = at_rest[nodes.joint_of[node.index()]];
        let ours = || extras::of(check, &place(&node), node.extras()).map(Option::unwrap_or_default);
        if let Some(light) = node.light() {
            survey.lights.extend(punctual(&light, carrier, ours()?, &mut survey.notices));
        }
        let Some(camera) = node.camera() else { continue };
        match camera.projection() {
            Projection::Perspective(lens) if survey.camera.is_none() => {
                survey.camera = view(carrier, lens.yfov(), lens.aspect_ratio(), ours()?);
            }
            _ => survey.notices.push(format!("{}: camera left out: the first perspective one is taken", place(&node))),
        }
    }
    Ok(survey)
}

/// None of a light that shines nowhere.
fn punctual(
    light: &gltf::khr_lights_punctual::Light,
    carrier: DAffine3,
    extras: extras::Node,
    notices: &mut Vec<String>,
) -> Option<Punctual> {
    let intensity = DVec3::from_array(light.color().map(f64::from)) * f64::from(light.intensity());
    let shines = match light.kind() {
        Written::Directional => Shines::From(carrier.matrix3.z_axis.try_normalize()?),
        Written::Point => Shines::At(carrier.translation),
        Written::Spot { .. } => {
            notices.push(format!("lights[{}]: spot light without its cone: it shines all around", light.index()));
            Shines::At(carrier.translation)
        }
    };
    let shining = intensity.is_finite() && intensity.min_element() >= 0.0 && intensity.max_element() > 0.0;
    shining.then_some(Punctual { shines, intensity, extras })
}

fn view(carrier: DAffine3, fov: f32, aspect: Option<f32>, extras: extras::Node) -> Option<View> {
    let forward = (-carrier.matrix3.z_axis).try_normalize()?;
    let up = carrier.matrix3.y_axis.reject_from_normalized(forward).try_normalize()?;
    let aspect = aspect.filter(|aspect| aspect.is_finite() && *aspect > 0.0);
    Some(View { eye: carrier.translation, forward, up, fov, aspect, extras })
}

fn clips(file: &File, nodes: &Nodes) -> Result<Vec<Animation>, SceneError> {
    let names: Vec<Option<&str>> = file.document.animations().map(|animation| animation.name()).collect();
    let own = |name: &&str| !name.is_empty() && names.iter().filter(|other| **other == Some(*name)).count() == 1;
    let clip = |(index, name): (usize, &Option<&str>)| {
        let name = name.filter(own).map_or_else(|| index.to_string(), str::to_owned);
        let seconds = hierarchy::clip(file, nodes, &name)?.duration;
        Ok(Animation { name, seconds })
    };
    names.iter().enumerate().map(clip).collect()
}

fn files(document: &Document) -> Vec<String> {
    let buffers = document.buffers().filter_map(|buffer| match buffer.source() {
        gltf::buffer::Source::Uri(uri) => Some(uri),
        gltf::buffer::Source::Bin => None,
    });
    let images = document.images().filter_map(|image| match image.source() {
        gltf::image::Source::Uri { uri, .. } => Some(uri),
        gltf::image::Source::View { .. } => None,
    });
    let mut files: Vec<String> =
        buffers.chain(images).filter(|uri| !uri.starts_with("data:")).map(bytes::unescaped).collect();
    files.sort();
    files.dedup();
    files
}
