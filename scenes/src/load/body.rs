//! A body for a captured skeleton: limbs as capsules, blended, each vertex carried by the limbs that are near.

use glam::Vec3;

use crate::Mesh;
use crate::animation::{Clip, Influences, Playback, Skeleton, strongest};
use crate::assets::Capture;
use crate::solids::{Capsule, blob, nearness};

pub(super) struct Body {
    pub(super) mesh: Mesh,
    /// Bones are joints.
    pub(super) influences: Vec<Influences>,
}

/// Radii at the two ends of a limb as shares of the body's size, by what its joint's name holds; the first that fits counts.
const LIMBS: [(&[&str], [f32; 2]); 9] = [
    (&["thumb", "finger", "index"], [0.010, 0.008]),
    (&["hand", "wrist"], [0.016, 0.014]),
    (&["toe", "foot", "ankle"], [0.024, 0.018]),
    (&["upleg", "hip", "thigh"], [0.050, 0.036]),
    (&["leg", "knee", "shin"], [0.034, 0.024]),
    (&["collar", "clavicle"], [0.040, 0.034]),
    (&["arm", "shoulder", "elbow"], [0.027, 0.020]),
    (&["neck"], [0.030, 0.030]),
    (&["head"], [0.050, 0.050]),
];
/// Of what is named otherwise: the trunk.
const TRUNK: [f32; 2] = [0.065, 0.065];
/// Of how far limbs blend, and how far skin follows its neighbours, as shares of the body's size.
const BLEND: f32 = 0.006;
const SOFTNESS: f32 = 0.012;
/// Shorter limbs are joints that coincide.
const SHORTEST: f32 = 1e-3;

/// The body at rest; none if no limb has a length.
pub(super) fn around(capture: &Capture, thickness: f32, resolution: u32) -> Option<Body> {
    let skeleton = Skeleton { joints: capture.joints.clone(), clip: Clip::default(), playback: Playback::default() };
    let world = skeleton.at_rest();
    let at = |joint: usize| world[joint].translation.as_vec3();
    let inner = capture.joints.iter().enumerate().filter_map(|(joint, own)| Some((own.parent?, at(joint))));
    let tips = capture.tips.iter().map(|(joint, offset)| (*joint, world[*joint].transform_point3(*offset).as_vec3()));
    let limbs: Vec<(usize, Vec3)> = inner.chain(tips).collect();
    let ends = || limbs.iter().flat_map(|(joint, to)| [at(*joint), *to]);
    let size = ends().fold(Vec3::NEG_INFINITY, Vec3::max) - ends().fold(Vec3::INFINITY, Vec3::min);
    let size = size.max_element();
    let mut carriers = Vec::new();
    let mut capsules = Vec::new();
    for (joint, to) in limbs {
        let (from, scale) = (at(joint), thickness * size);
        if from.distance(to) > SHORTEST * size {
            capsules.push(capsule(from, to, radii(&capture.names[joint]).map(|radius| radius * scale)));
            carriers.push(joint as u16);
        }
    }
    if capsules.is_empty() {
        return None;
    }
    let mesh = blob(&capsules, BLEND * thickness * size, resolution);
    let influence = |p: &Vec3| strongest(merged(&carriers, &nearness(&capsules, SOFTNESS * thickness * size, *p)));
    let influences = mesh.positions.iter().map(influence).collect();
    Some(Body { mesh, influences })
}

/// A limb may be shorter than its radii differ.
fn capsule(from: Vec3, to: Vec3, [start, end]: [f32; 2]) -> Capsule {
    let change = 0.9 * from.distance(to);
    Capsule { from, to, radii: [start, end.clamp(start - change, start + change)] }
}

fn radii(name: &str) -> [f32; 2] {
    let name = name.to_lowercase();
    let fits = |(words, _): &&(&[&str], [f32; 2])| words.iter().any(|word| name.contains(word));
    LIMBS.iter().find(fits).map_or(TRUNK, |(_, radii)| *radii)
}

/// A joint may carry several limbs.
fn merged(carriers: &[u16], weights: &[f32]) -> Vec<(u16, f32)> {
    let mut all: Vec<(u16, f32)> = Vec::new();
    for (joint, weight) in carriers.iter().zip(weights) {
        match all.iter_mut().find(|(other, _)| other == joint) {
            Some((_, sum)) => *sum += weight,
            None => all.push((*joint, *weight)),
        }
    }
    all
}
