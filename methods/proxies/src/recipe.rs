//! Sphere sets as derived data: made once, kept by content.

use glam::Vec3;
use halflight_contract::{Codec, Derived, Error, Flow, Job, Meter, Result};
use halflight_scenes::{Object, Scene, Shape, Sphere};

use crate::{BindingOf, MAX_COUNT, Proxy, SphereSet, sphere_set};

/// The sphere set of an object: `count` spheres at most around a mesh; an object that is exact spheres is its own set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpheresOf {
    /// Index into [`Scene::objects`].
    pub object: usize,
    /// Number of spheres, in 1..=[`MAX_COUNT`].
    pub count: usize,
}

impl Derived for SpheresOf {
    type Value = SphereSet;
    const NAME: &'static str = "spheres";
    const REVISION: &'static str = env!("HALFLIGHT_PROXIES_REVISION");

    fn key(&self, scene: &Scene) -> String {
        match scene.objects.get(self.object) {
            Some(object) => format!("{}-{}", object.content, self.count),
            None => format!("no object {}", self.object),
        }
    }

    fn make(&self, job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<SphereSet> {
        let Some(object) = job.scene.objects.get(self.object) else {
            let (name, objects) = (&job.scene.name, job.scene.objects.len());
            return Err(Error::Input(format!("sphere set: scene {name} has {objects} objects, found {}", self.object)));
        };
        if !(1..=MAX_COUNT).contains(&self.count) {
            let (name, count) = (&object.name, self.count);
            return Err(Error::Input(format!(
                "sphere set of {name}: expected 1 to {MAX_COUNT} spheres, found {count}"
            )));
        }
        match object.shape.as_ref() {
            Shape::Spheres(spheres) => Ok(SphereSet { spheres: spheres.clone(), outside_volume: 0.0 }),
            Shape::Mesh(mesh) => {
                let mut progress = |done, total| meter.progress("sphere set", done, total) == Flow::Continue;
                sphere_set(mesh, self.count, &mut progress).ok_or(Error::Cancelled)
            }
            Shape::Heights(_) => {
                let name = &object.name;
                Err(Error::Input(format!("sphere set of {name}: expected a mesh or spheres, found a height field")))
            }
        }
    }

    fn codec(&self) -> Option<Codec<SphereSet>> {
        Some(Codec { encode, decode })
    }
}

/// What stands for the objects of a job's scene, one entry an object: `None` for objects that cast no shadow, and for height fields, for
/// which spheres cannot stand.
pub fn proxies(job: &Job<'_, '_>, count: usize, meter: &mut dyn Meter) -> Result<Vec<Option<Proxy>>> {
    let proxy = |object: usize| {
        let spheres = SpheresOf { object, count };
        let Object { casts, shape, deformation, .. } = &job.scene.objects[object];
        match (*casts && !matches!(**shape, Shape::Heights(_)), deformation.is_some()) {
            (false, _) => Ok(None),
            (true, false) => Ok(Some(Proxy { set: job.derive(&spheres, meter)?, binding: None })),
            (true, true) => {
                let binding = Some(job.derive(&BindingOf(spheres), meter)?);
                Ok(Some(Proxy { set: job.derive(&spheres, meter)?, binding }))
            }
        }
    };
    (0..job.scene.objects.len()).map(proxy).collect()
}

const MAGIC: &[u8; 8] = b"spheres1";

/// The magic, the outside volume, then centre and radius of each sphere, as little-endian `f32`.
fn encode(set: &SphereSet) -> Vec<u8> {
    let floats = set.spheres.iter().flat_map(|s| [s.center.x, s.center.y, s.center.z, s.radius]);
    let bytes = std::iter::once(set.outside_volume).chain(floats).flat_map(f32::to_le_bytes);
    MAGIC.iter().copied().chain(bytes).collect()
}

fn decode(bytes: &[u8]) -> Option<SphereSet> {
    let (words, rest) = bytes.strip_prefix(MAGIC)?.as_chunks::<4>();
    let floats: Vec<f32> = words.iter().map(|word| f32::from_le_bytes(*word)).collect();
    let (outside_volume, floats) = floats.split_first()?;
    let (quads, left) = floats.as_chunks::<4>();
    let sphere = |[x, y, z, radius]: &[f32; 4]| Sphere { center: Vec3::new(*x, *y, *z), radius: *radius };
    let set = SphereSet { spheres: quads.iter().map(sphere).collect(), outside_volume: *outside_volume };
    let sound = |s: &Sphere| s.center.is_finite() && s.radius.is_finite() && s.radius >= 0.0;
    let whole = rest.is_empty() && left.is_empty() && set.outside_volume.is_finite() && set.outside_volume >= 0.0;
    (whole && set.spheres.iter().all(sound)).then_some(set)
}
