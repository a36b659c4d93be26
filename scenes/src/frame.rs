//! Frames: the scene posed at one time.

use std::borrow::Cow;
use std::sync::Arc;

use glam::Vec3;

use crate::{Content, Light, Pose, Receivers, Revision, Rgb, Shape};

/// An object of the scene at one time.
#[derive(Clone, Debug)]
pub struct PosedObject {
    /// Index into [`crate::Scene::objects`].
    pub object: usize,
    /// Its shape at this time, not yet carried along by the pose: that at rest unless it deforms.
    pub shape: Arc<Shape>,
    /// Hash of the shape.
    pub content: Content,
    /// Rigid motion from rest.
    pub pose: Pose,
    /// Changes exactly when shape, albedo, emission or pose does.
    pub revision: Revision,
}

impl PosedObject {
    /// The shape where it is.
    pub fn in_place(&self) -> Cow<'_, Shape> {
        self.shape.posed(self.pose)
    }
}

/// A light of the scene at one time.
#[derive(Clone, Debug)]
pub struct PosedLight {
    /// What it is now.
    pub light: Light,
    /// Changes exactly when what the light emits does.
    pub revision: Revision,
}

/// The posed scene at one time with its receivers.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Position in the sequence.
    pub index: usize,
    /// Seconds.
    pub time: f32,
    /// All objects, in the scene's order.
    pub objects: Vec<PosedObject>,
    /// All lights, in the scene's order.
    pub lights: Vec<PosedLight>,
    /// Where light is asked.
    pub receivers: Arc<Receivers>,
}

impl Frame {
    /// Its lights.
    pub fn lights(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter().map(|posed| &posed.light)
    }

    /// Radiance that arrives from all distant lights together along a unit direction, nothing in the way.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        self.lights().map(|light| light.radiance(direction)).sum()
    }
}
