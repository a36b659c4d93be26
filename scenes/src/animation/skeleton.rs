//! Joints in a hierarchy.

use glam::{DAffine3, DQuat, DVec3};

use super::{Clip, Playback};

/// Scale, then rotate, then translate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transform {
    pub(crate) translation: DVec3,
    pub(crate) rotation: DQuat,
    pub(crate) scale: DVec3,
}

/// A joint; its transform is relative to its parent's.
#[derive(Clone, Debug)]
pub(crate) struct Joint {
    /// Comes before the joint itself.
    pub(crate) parent: Option<usize>,
    pub(crate) rest: Transform,
}

/// A hierarchy of joints and how they move.
#[derive(Clone, Debug)]
pub(crate) struct Skeleton {
    pub(crate) joints: Vec<Joint>,
    pub(crate) clip: Clip,
    pub(crate) playback: Playback,
}

impl Transform {
    pub(crate) const IDENTITY: Transform =
        Transform { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    pub(crate) fn affine(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

impl Skeleton {
    /// Each joint's transform to the skeleton's space at a time of the scene.
    pub(crate) fn pose_at(&self, time: f64) -> Vec<DAffine3> {
        let mut local: Vec<Transform> = self.joints.iter().map(|joint| joint.rest).collect();
        self.clip.apply(self.playback.clip_time(time, self.clip.duration), &mut local);
        self.world(&local)
    }

    /// The same as it stands without its clip.
    pub(crate) fn at_rest(&self) -> Vec<DAffine3> {
        self.world(&self.joints.iter().map(|joint| joint.rest).collect::<Vec<_>>())
    }

    fn world(&self, local: &[Transform]) -> Vec<DAffine3> {
        let mut world: Vec<DAffine3> = Vec::with_capacity(local.len());
        for (joint, transform) in self.joints.iter().zip(local) {
            let own = transform.affine();
            world.push(joint.parent.map_or(own, |parent| world[parent] * own));
        }
        world
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn children_follow_their_parents() {
        let quarter = DQuat::from_rotation_z(FRAC_PI_2);
        let at = |translation| Transform { translation, ..Transform::IDENTITY };
        let arm = Joint { parent: None, rest: Transform { rotation: quarter, ..at(DVec3::X) } };
        let hand = Joint { parent: Some(0), rest: at(DVec3::X * 2.0) };
        let skeleton = Skeleton { joints: vec![arm, hand], clip: Clip::default(), playback: Playback::default() };
        assert!(skeleton.at_rest()[1].translation.distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-12);
        assert_eq!(skeleton.pose_at(3.0), skeleton.at_rest());
    }
}
