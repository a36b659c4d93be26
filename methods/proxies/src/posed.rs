//! Sphere sets carried along with a frame.

use std::sync::Arc;

use halflight_scenes::{Frame, Scene, Sphere};

use crate::SphereSet;

/// The spheres of all casting objects at one time, those of an object together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PosedSpheres {
    /// Spheres in world space.
    pub spheres: Vec<Sphere>,
    /// The object in [`Scene::objects`] that each belongs to.
    pub object: Vec<u32>,
}

/// The blockers of a frame: `sets` holds one entry an object, in the scene's order. Objects that do not cast and
/// objects without a set contribute nothing.
pub fn blockers(scene: &Scene, frame: &Frame, sets: &[Option<Arc<SphereSet>>]) -> PosedSpheres {
    let mut posed = PosedSpheres::default();
    for entry in frame.objects.iter().filter(|entry| scene.objects[entry.object].casts) {
        let Some(Some(set)) = sets.get(entry.object) else { continue };
        let carried = |sphere: &Sphere| Sphere { center: entry.pose.point(sphere.center), radius: sphere.radius };
        posed.spheres.extend(set.spheres.iter().map(carried));
        posed.object.resize(posed.spheres.len(), entry.object as u32);
    }
    posed
}
