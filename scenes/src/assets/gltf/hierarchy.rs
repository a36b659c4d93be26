//! Nodes as joints, and animations as clips.

use glam::{DMat4, DQuat, DVec3};
use gltf::animation::Interpolation as Written;
use gltf::animation::Property;

use super::{File, place};
use crate::SceneError;
use crate::animation::{Clip, Interpolation, Joint, Keys, Playback, Skeleton, Track, Transform};

/// A joint for each node.
pub(super) struct Nodes {
    pub(super) joints: Skeleton,
    /// The joint of each node.
    pub(super) joint_of: Vec<usize>,
    /// Whether a node belongs to the scene that the file shows.
    pub(super) shown: Vec<bool>,
}

impl Nodes {
    /// For each joint whether a clip moves it, or one above it.
    pub(super) fn moved(&self, clip: &Clip) -> Vec<bool> {
        let mut moved: Vec<bool> = Vec::new();
        for (index, joint) in self.joints.joints.iter().enumerate() {
            let own = clip.tracks.iter().any(|track| track.joint == index);
            moved.push(own || joint.parent.is_some_and(|parent| moved[parent]));
        }
        moved
    }
}

pub(super) fn skeleton(file: &File) -> Result<Nodes, SceneError> {
    let nodes: Vec<gltf::Node> = file.document.nodes().collect();
    let mut parents: Vec<Option<usize>> = vec![None; nodes.len()];
    for node in &nodes {
        for child in node.children() {
            if parents[child.index()].replace(node.index()).is_some() || child.index() == node.index() {
                return Err(file.check.invalid(&place(&child), "at most one parent, another node", "more"));
            }
        }
    }
    // Parents before children; what is never reached runs in a circle.
    let mut order: Vec<usize> = (0..nodes.len()).filter(|node| parents[*node].is_none()).collect();
    let mut next = 0;
    while let Some(node) = order.get(next).copied() {
        order.extend(nodes[node].children().map(|child| child.index()));
        next += 1;
    }
    if order.len() < nodes.len() {
        return Err(file.check.invalid("nodes", "a hierarchy without circles", "one"));
    }
    let mut joint_of = vec![0; nodes.len()];
    order.iter().enumerate().for_each(|(joint, node)| joint_of[*node] = joint);
    let mut joints = Vec::new();
    for node in &order {
        joints.push(Joint { parent: parents[*node].map(|parent| joint_of[parent]), rest: rest(file, &nodes[*node])? });
    }
    let mut shown = roots(file, nodes.len());
    for node in &order {
        if let Some(parent) = parents[*node] {
            shown[*node] |= shown[parent];
        }
    }
    Ok(Nodes { joints: Skeleton { joints, clip: Clip::default(), playback: Playback::default() }, joint_of, shown })
}

/// The nodes at the top of the default scene, or the first; all of them in a file without scenes.
fn roots(file: &File, nodes: usize) -> Vec<bool> {
    match file.document.default_scene().or_else(|| file.document.scenes().next()) {
        None => vec![true; nodes],
        Some(scene) => {
            let mut top = vec![false; nodes];
            scene.nodes().for_each(|node| top[node.index()] = true);
            top
        }
    }
}

fn rest(file: &File, node: &gltf::Node) -> Result<Transform, SceneError> {
    let transform = match node.transform() {
        gltf::scene::Transform::Matrix { matrix } => {
            let (scale, rotation, translation) =
                DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))).to_scale_rotation_translation();
            Transform { translation, rotation, scale }
        }
        gltf::scene::Transform::Decomposed { translation, rotation, scale } => Transform {
            translation: DVec3::from_array(translation.map(f64::from)),
            rotation: unit(rotation.map(f64::from)).unwrap_or(DQuat::NAN),
            scale: DVec3::from_array(scale.map(f64::from)),
        },
    };
    let holds = transform.translation.is_finite() && transform.rotation.is_finite() && transform.scale.is_finite();
    file.check.ensure(holds, &place(node), "a finite transform with a rotation that is not zero", node.transform())?;
    Ok(transform)
}

fn unit(xyzw: [f64; 4]) -> Option<DQuat> {
    let rotation = DQuat::from_array(xyzw);
    (rotation.is_finite() && rotation.length_squared() > 1e-12).then(|| rotation.normalize())
}

/// An animation by its name, or its number.
pub(super) fn clip(file: &File, nodes: &Nodes, wanted: &str) -> Result<Clip, SceneError> {
    let by_name = file.document.animations().find(|animation| animation.name() == Some(wanted));
    let by_number = || wanted.parse().ok().and_then(|number| file.document.animations().nth(number));
    let animation = by_name.or_else(by_number).ok_or_else(|| {
        let names: Vec<String> = file
            .document
            .animations()
            .enumerate()
            .map(|(i, a)| a.name().map_or(i.to_string(), str::to_owned))
            .collect();
        file.check.invalid("animations", format!("one of {names:?}"), wanted)
    })?;
    let mut tracks = Vec::new();
    for (index, channel) in animation.channels().enumerate() {
        let field = format!("animations[{}].channels[{index}]", animation.index());
        let joint = nodes.joint_of[channel.target().node().index()];
        tracks.extend(track(file, &field, joint, &channel)?);
    }
    Ok(Clip::new(tracks))
}

/// None for a channel of morph weights.
fn track(
    file: &File,
    field: &str,
    joint: usize,
    channel: &gltf::animation::Channel,
) -> Result<Option<Track>, SceneError> {
    let sampler = channel.sampler();
    let times: Vec<f64> = file.numbers::<1>(&sampler.input())?.into_iter().map(|[time]| time).collect();
    let ascend = times.windows(2).all(|pair| pair[0] < pair[1]);
    file.check.ensure(ascend, field, "times that ascend", times.len())?;
    let (interpolation, values) = match sampler.interpolation() {
        Written::Linear => (Interpolation::Linear, 1),
        Written::Step => (Interpolation::Step, 1),
        Written::CubicSpline => (Interpolation::Cubic, 3),
    };
    let keys = keys(file, channel, interpolation)?;
    let count = match &keys {
        None => return Ok(None),
        Some(Keys::Translations(values) | Keys::Scales(values)) => values.len(),
        Some(Keys::Rotations(values)) => values.len(),
    };
    let expected = format!("{} values for {} times", values * times.len(), times.len());
    file.check.ensure(count == values * times.len(), field, &expected, count)?;
    Ok(keys.map(|keys| Track { joint, times, keys, interpolation }))
}

fn keys(
    file: &File,
    channel: &gltf::animation::Channel,
    interpolation: Interpolation,
) -> Result<Option<Keys>, SceneError> {
    let output = channel.sampler().output();
    let vectors = || Ok::<_, SceneError>(file.numbers::<3>(&output)?.into_iter().map(DVec3::from_array).collect());
    Ok(match channel.target().property() {
        Property::Translation => Some(Keys::Translations(vectors()?)),
        Property::Scale => Some(Keys::Scales(vectors()?)),
        Property::Rotation => {
            // Tangents of splines are no rotations.
            let rotation = |xyzw: [f64; 4]| match interpolation {
                Interpolation::Cubic => DQuat::from_array(xyzw),
                _ => unit(xyzw).unwrap_or(DQuat::IDENTITY),
            };
            Some(Keys::Rotations(file.numbers::<4>(&output)?.into_iter().map(rotation).collect()))
        }
        Property::MorphTargetWeights => None,
    })
}
