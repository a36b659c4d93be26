//! Sphere sets carried along with a frame.

use std::sync::Arc;

use halflight_scenes::{Frame, Object, PosedObject, Scene, Shape, Sphere};

use crate::{Binding, SphereSet};

/// What stands for an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Proxy {
    /// Its spheres in rest position.
    pub set: Arc<SphereSet>,
    /// What carries them along with an object that changes its shape.
    pub binding: Option<Arc<Binding>>,
}

impl Proxy {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.set.spheres.as_slice()) + self.binding.as_ref().map_or(0, |binding| binding.bytes())
    }

    /// The spheres of an object where it is at a time.
    pub(crate) fn posed(&self, of: &Object, object: &PosedObject, time: f32) -> Vec<Sphere> {
        let carried = |center| object.pose.point(center);
        let spheres = self.set.spheres.iter();
        match (&self.binding, &*object.shape) {
            (Some(binding), Shape::Mesh(mesh)) => {
                let palette = of.deformation.as_ref().and_then(|deformation| deformation.palette(time));
                let pairs = spheres.zip(binding.centers(&mesh.positions, palette.as_ref()));
                pairs.map(|(sphere, center)| Sphere { center: carried(center), radius: sphere.radius }).collect()
            }
            _ => spheres.map(|sphere| Sphere { center: carried(sphere.center), radius: sphere.radius }).collect(),
        }
    }
}

/// The spheres of all casting objects at one time, those of an object together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PosedSpheres {
    /// Spheres in world space.
    pub spheres: Vec<Sphere>,
    /// The object in [`Scene::objects`] that each belongs to.
    pub object: Vec<u32>,
}

/// The blockers of a frame: `proxies` holds one entry an object, in the scene's order. Objects that do not cast and
/// objects without a proxy contribute nothing.
pub fn blockers(scene: &Scene, frame: &Frame, proxies: &[Option<Proxy>]) -> PosedSpheres {
    let mut posed = PosedSpheres::default();
    for entry in frame.objects.iter().filter(|entry| scene.objects[entry.object].casts) {
        let Some(Some(proxy)) = proxies.get(entry.object) else { continue };
        posed.spheres.extend(proxy.posed(&scene.objects[entry.object], entry, frame.time));
        posed.object.resize(posed.spheres.len(), entry.object as u32);
    }
    posed
}
