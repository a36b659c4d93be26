//! Each source's unoccluded light times the share of the source that is visible.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use halflight_scenes::KeyLight;
use halflight_trace::Ray;

use super::{Plan, Scratch, Term};
use crate::emitters::{Emitters, Points};
use crate::receiver::Receiver;
use crate::sampling::{KeySampler, Sobol, mix};
use crate::unoccluded::open_key;
use crate::visibility::{View, Visibility};

/// `Σ E V̄` over the sources: `E` the unoccluded light of a source and `V̄` the share of it that is visible, as convolution
/// methods have it (Soler and Sillion 1998). `V̄` is by area over a mesh's triangles that face the receiver, by solid angle
/// over a sphere or key light; what lies below the receiver's horizon counts neither way.
pub(crate) struct MeanVisibility {
    pub(crate) emitters: Arc<Emitters>,
    pub(crate) keys: Vec<KeyLight>,
    pub(crate) visibility: Visibility,
}

impl Term for MeanVisibility {
    fn sample(&self, receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch) {
        let (view, start) = (self.visibility.from(receiver), self.visibility.start(receiver));
        let mut source = 0;
        let mut each = |light: DVec3, ray: &dyn Fn([f32; 2]) -> Option<Ray>| {
            source += 1;
            if light != DVec3::ZERO {
                share(receiver, plan, mix(seed, source), light, ray, &view, scratch);
            }
        };
        for key in &self.keys {
            let sampler = KeySampler::new(key);
            each(open_key(key, receiver.normal.as_dvec3()), &|point| {
                Some(view.ray(sampler.direction(point), f32::INFINITY))
            });
        }
        for object in self.emitters.objects() {
            let points = Points::new(object, start);
            let light = object.iter().map(|emitter| emitter.open(start, receiver.normal)).sum();
            each(light, &|point| points.towards(point).map(|(direction, distance)| view.ray(direction, distance)));
        }
    }

    fn known(&self, receiver: &Receiver, _: &mut Scratch) -> DVec3 {
        let keys = self.keys.iter().map(|key| open_key(key, receiver.normal.as_dvec3())).sum::<DVec3>();
        keys + self.emitters.open(self.visibility.start(receiver), receiver.normal)
    }
}

/// Adds the light of one source, spread over rays towards it.
fn share(
    receiver: &Receiver,
    plan: Plan,
    seed: u64,
    light: DVec3,
    ray: &dyn Fn([f32; 2]) -> Option<Ray>,
    view: &View<'_>,
    scratch: &mut Scratch,
) {
    let bundle = &mut scratch.bundle;
    for batch in 0..plan.batches {
        let sobol = Sobol::new(mix(seed, u64::from(batch)));
        bundle.rays.clear();
        let above = |ray: &Ray| receiver.normal.dot(ray.direction) > 0.0;
        bundle.rays.extend((0..plan.per_batch).filter_map(|i| ray(sobol.point(i)).filter(above)));
        bundle.blocked.clear();
        bundle.blocked.resize(bundle.rays.len(), false);
        view.occluded(&bundle.rays, &mut bundle.blocked);
        let value: Vec3 = (light / bundle.rays.len().max(1) as f64).as_vec3();
        bundle.blocked.iter().for_each(|blocked| scratch.batches.shadow_ray(batch, value, *blocked));
    }
    bundle.rays.clear();
}
