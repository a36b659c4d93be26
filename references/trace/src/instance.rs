//! Bodies carried to other places by rigid motions: the top level of a world.

use std::sync::Arc;

use glam::{DMat3, DVec3, Quat, Vec3};

use crate::body::Body;
use crate::traced_ray::TracedRay;
use crate::wide::{BUNDLE, Bundle, Found, Kernel, Packet, Stack, is_within_reach};
use crate::world::Hit;

/// A body rotated about the origin, then translated.
///
/// Rays are carried into the body's space instead, in `f64` and rounded once to `f32`. There one ray meets one
/// hierarchy: a closed body leaks nowhere, whatever its pose. Against a ray in the world the rounded one passes by at
/// most `√3·2⁻²⁴` of its origin's distance from the body's origin, plus as much of the distance travelled; a ray that
/// must clear the surface it starts on has to start that much off it. Two bodies that touch are not sealed against
/// each other.
#[derive(Clone)]
pub struct Instance {
    body: Arc<Body>,
    to_body: DMat3,
    translation: DVec3,
    pub(crate) geometry: u32,
}

/// The box of an instance is larger than the body by what rounding carries rays into it, relative to all coordinates
/// that take part; rounding relative to the ray's own way is in the boxes' slack.
const MARGIN: f64 = 8.0 * f32::EPSILON as f64;

impl Instance {
    /// Hits name the body's geometries from index `geometry` on. An instance whose pose is not finite is never hit.
    pub fn new(body: Arc<Body>, rotation: Quat, translation: Vec3, geometry: u32) -> Self {
        let to_body = DMat3::from_quat(rotation.as_dquat().normalize()).transpose();
        Instance { body, to_body, translation: translation.as_dvec3(), geometry }
    }

    /// Whether it can be hit at all.
    pub(crate) fn is_proper(&self) -> bool {
        self.body.bounds().is_some() && is_within_reach(InstancePacket::bounds(self))
    }

    /// The ray as the body sees it.
    #[inline]
    fn carried(&self, ray: &TracedRay) -> Option<TracedRay> {
        let origin = self.to_body * (ray.origin.as_dvec3() - self.translation);
        let direction = self.to_body * ray.direction.as_dvec3();
        TracedRay::new(origin.as_vec3(), direction.as_vec3(), ray.t_min)
    }
}

/// A leaf of the top level: one instance, since to test it costs far more than its box.
pub(crate) struct InstancePacket(Instance);

impl Packet for InstancePacket {
    type Primitive = Instance;
    type Detail = Hit;
    type Scratch = Stack;

    const CAPACITY: usize = 1;

    fn bounds(instance: &Instance) -> [Vec3; 2] {
        let [low, high] = instance.body.bounds().unwrap_or_default().map(Vec3::as_dvec3);
        let (center, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let to_world = instance.to_body.transpose();
        let carried = to_world * center + instance.translation;
        let spread = to_world.abs() * half;
        let reach = carried.abs().max_element() + instance.translation.abs().max_element() + center.length();
        let margin = DVec3::splat(MARGIN * (reach + half.length()));
        [(carried - spread - margin).as_vec3(), (carried + spread + margin).as_vec3()]
    }

    fn pack(instances: &[Instance]) -> Self {
        InstancePacket(instances[0].clone())
    }

    #[inline(always)]
    fn candidates<K: Kernel>(&self, _: K, _: &TracedRay) -> u32 {
        1
    }

    fn hit(&self, _: usize, ray: &TracedRay, t_max: f32, stack: &mut Stack) -> Option<Found<Hit>> {
        let hit = self.0.body.closest(&self.0.carried(ray)?, t_max, stack)?;
        Some(Found { t: hit.t, detail: Hit { geometry: hit.geometry + self.0.geometry, ..hit } })
    }

    fn blocks_of<K: Kernel>(&self, _: K, _: u32, bundle: Bundle<'_>, stack: &mut Stack) -> u64 {
        let mut rays = [TracedRay::NONE; BUNDLE];
        let mut open = 0;
        for i in bundle.open() {
            if let Some(carried) = self.0.carried(&bundle.rays[i]) {
                rays[i] = carried;
                open |= 1 << i;
            }
        }
        self.0.body.any_of(Bundle { rays: &rays, ends: bundle.ends, open }, stack)
    }

    fn blocks(&self, _: usize, ray: &TracedRay, t_max: f32, stack: &mut Stack) -> bool {
        self.0.carried(ray).is_some_and(|carried| self.0.body.any(&carried, t_max, stack))
    }
}
