//! Meshes on skeletons: linear blend skinning (Magnenat-Thalmann et al. 1988).

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::{Skeleton, turned};
use crate::check::FAR;
use crate::content::Collector;

/// A joint that carries vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bone {
    pub(crate) joint: usize,
    /// From the space of the bound mesh to that of the joint.
    pub(crate) inverse_bind: DAffine3,
}

/// Indices of bones and their weights, which sum to 1.
pub(crate) type Influences = [(u16, f32); 4];

/// A mesh bound to a skeleton.
#[derive(Clone, Debug)]
pub(crate) struct Skin {
    pub(crate) skeleton: Arc<Skeleton>,
    pub(crate) bones: Vec<Bone>,
    /// Of the vertices as they are bound.
    pub(crate) positions: Vec<Vec3>,
    /// Unit normals.
    pub(crate) normals: Vec<Vec3>,
    /// One entry a vertex.
    pub(crate) influences: Vec<Influences>,
}

impl Skin {
    /// A mesh that one joint carries along.
    pub(crate) fn rigid(skeleton: Arc<Skeleton>, joint: usize, positions: Vec<Vec3>, normals: Vec<Vec3>) -> Self {
        let influences = vec![strongest(Vec::new()); positions.len()];
        let bones = vec![Bone { joint, inverse_bind: DAffine3::IDENTITY }];
        Skin { skeleton, bones, positions, normals, influences }
    }

    /// Positions and unit normals under the skeleton's joints ([`Skeleton::pose_at`]); `placed` leads from the skeleton's space
    /// to the scene's.
    pub(crate) fn posed(&self, joints: &[DAffine3], placed: DAffine3) -> (Vec<Vec3>, Vec<Vec3>) {
        let palette = self.palette(joints, placed);
        let vertices = self.positions.iter().zip(&self.normals).zip(&self.influences);
        vertices.map(|((position, normal), influences)| vertex(&palette, influences, *position, *normal)).unzip()
    }

    /// What carries bound points of each bone to the scene.
    pub(crate) fn palette(&self, joints: &[DAffine3], placed: DAffine3) -> Vec<DAffine3> {
        self.bones.iter().map(|bone| placed * joints[bone.joint] * bone.inverse_bind).collect()
    }

    /// A weighted sum of vertices, which weighs each bone by all that it carries of them.
    pub(crate) fn gather(&self, weights: &[(u32, f64)]) -> Carried {
        let mut bones = vec![Share::default(); self.bones.len()];
        for (vertex, weight) in weights {
            let position = self.positions[*vertex as usize].as_dvec3();
            for (bone, influence) in self.influences[*vertex as usize] {
                let (share, weight) = (&mut bones[usize::from(bone)], *weight * f64::from(influence));
                share.point += position * weight;
                share.weight += weight;
            }
        }
        let all = (0..).zip(bones).filter(|(_, share)| *share != Share::default());
        Carried(all.collect())
    }

    pub(crate) fn collect(&self, into: Collector) -> Collector {
        let skeleton = &self.skeleton;
        let doubles = |all: Collector, values: &[f64]| values.iter().fold(all, |all, v| all.bytes(&v.to_le_bytes()));
        let all = into.list(&self.bones, |all, bone| doubles(all.word(bone.joint), &bone.inverse_bind.to_cols_array()));
        let all = all.list(&self.positions, |all, p| all.vec3(*p)).list(&self.normals, |all, n| all.vec3(*n));
        let all = all.list(&self.influences, |all, four| {
            four.iter().fold(all, |all, (bone, weight)| all.word(usize::from(*bone)).float(*weight))
        });
        let all = all.list(&skeleton.joints, |all, joint| {
            let all = all.word(joint.parent.map_or(0, |parent| parent + 1));
            doubles(all, &joint.rest.affine().to_cols_array())
        });
        all.bytes(format!("{:?} {:?}", skeleton.clip, skeleton.playback).as_bytes())
    }
}

/// A point that follows a skin: a weighted sum of its vertices, as few terms as there are bones.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried(Vec<(u16, Share)>);

/// A bone's part in a weighted sum of vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Share {
    /// Sum of bound positions, weighted.
    point: DVec3,
    /// Sum of the weights.
    weight: f64,
}

/// What carries points of each bone to the scene, at one time.
#[derive(Clone, Debug)]
pub struct Palette(pub(super) Vec<DAffine3>);

impl Carried {
    /// Where the point is.
    pub fn at(&self, palette: &Palette) -> Vec3 {
        let term = |(bone, share): &(u16, Share)| {
            let carrier = &palette.0[usize::from(*bone)];
            carrier.matrix3 * share.point + carrier.translation * share.weight
        };
        let posed = self.0.iter().map(term).sum::<DVec3>().as_vec3();
        match posed.is_finite() && posed.abs().max_element() <= FAR {
            true => posed,
            false => self.0.iter().map(|(_, share)| share.point).sum::<DVec3>().as_vec3(),
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}

fn vertex(palette: &[DAffine3], influences: &Influences, position: Vec3, normal: Vec3) -> (Vec3, Vec3) {
    let mut blend = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
    for (bone, weight) in influences.iter().filter(|(_, weight)| *weight != 0.0) {
        let (matrix, weight) = (&palette[usize::from(*bone)], f64::from(*weight));
        blend.matrix3 += matrix.matrix3 * weight;
        blend.translation += matrix.translation * weight;
    }
    let posed = blend.transform_point3(position.as_dvec3()).as_vec3();
    // Keys may move a joint beyond all bounds; what it carries stays where it is bound.
    match posed.abs().max_element() <= FAR && posed.is_finite() {
        true => (posed, turned(&blend.matrix3, normal)),
        false => (position, normal),
    }
}

/// The four strongest of some influences, weights scaled to a sum of 1; the first bone alone if there are none.
pub(crate) fn strongest(mut all: Vec<(u16, f32)>) -> Influences {
    all.retain(|(_, weight)| *weight > 0.0);
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    all.truncate(4);
    let sum: f32 = all.iter().map(|(_, weight)| weight).sum();
    let mut four = [(0, 0.0); 4];
    four[0].1 = 1.0;
    if sum > 0.0 {
        for (slot, (bone, weight)) in four.iter_mut().zip(all) {
            *slot = (bone, weight / sum);
        }
    }
    four
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    #[test]
    fn half_a_weight_is_half_the_way() {
        let moved = DAffine3::from_translation(DVec3::X);
        let four = strongest(vec![(0, 0.5), (1, 0.5)]);
        let (posed, normal) = vertex(&[DAffine3::IDENTITY, moved], &four, Vec3::Y, Vec3::Z);
        assert_eq!((posed, normal), (Vec3::new(0.5, 1.0, 0.0), Vec3::Z));
        let turn = DAffine3::from_quat(DQuat::from_rotation_x(1.0));
        assert!(
            vertex(&[turn], &strongest(Vec::new()), Vec3::Y, Vec3::Y).1.distance(Vec3::new(0.0, 0.5403, 0.8415)) < 1e-4
        );
    }

    #[test]
    fn beyond_all_bounds_things_stay_where_they_are_bound() {
        for scale in [1e30, 1e300, f64::INFINITY, f64::NAN] {
            let matrix = DAffine3::from_scale(DVec3::splat(scale));
            let four = strongest(Vec::new());
            assert_eq!(vertex(&[matrix], &four, Vec3::Y, Vec3::Z), (Vec3::Y, Vec3::Z), "{scale}");
            let carried = Carried(vec![(0, Share { point: DVec3::Y, weight: 1.0 })]);
            assert_eq!(carried.at(&Palette(vec![matrix])), Vec3::Y, "{scale}");
        }
    }

    #[test]
    fn the_four_strongest_are_kept() {
        let four = strongest(vec![(7, 0.1), (1, 0.4), (2, 0.0), (3, 0.2), (4, 0.2), (5, 0.1), (6, 0.05)]);
        assert_eq!(four.map(|(bone, _)| bone), [1, 3, 4, 5]);
        assert!((four.iter().map(|(_, weight)| weight).sum::<f32>() - 1.0).abs() < 1e-6);
    }
}
