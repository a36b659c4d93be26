//! What blocks light on its way to receivers.

use std::sync::Arc;

use glam::Vec3;
use halflight_proxies::{SelfShadow, seen};
use halflight_scenes::Sphere;
use halflight_trace::Ray;

use crate::receiver::Receiver;
use crate::traced::Traced;

/// The blockers of one frame.
#[derive(Clone)]
pub(crate) struct Visibility {
    pub(crate) blockers: Blockers,
    /// Whether all that lies below the horizontal plane is blocked.
    pub(crate) upper_sky: bool,
}

#[derive(Clone)]
pub(crate) enum Blockers {
    /// Traced geometry.
    Traced(Arc<Traced>),
    /// Spheres seen under a self-shadow rule.
    Spheres {
        /// All spheres, posed.
        spheres: Arc<Vec<Sphere>>,
        /// The rule.
        rule: SelfShadow,
    },
}

impl Visibility {
    /// Where a receiver's rays start. Lamps are looked for from there: a ray that starts elsewhere than where it was aimed from
    /// may graze the lamp itself before it ends.
    pub(crate) fn start(&self, receiver: &Receiver) -> Vec3 {
        match &self.blockers {
            Blockers::Traced(traced) => traced.lift(receiver.object, receiver.position, receiver.geometric_normal),
            Blockers::Spheres { .. } => receiver.position,
        }
    }

    /// What a receiver sees of the blockers.
    pub(crate) fn from(&self, receiver: &Receiver) -> View<'_> {
        let sight = match &self.blockers {
            Blockers::Traced(traced) => Sight::Rays { traced, origin: self.start(receiver) },
            Blockers::Spheres { spheres, rule } => Sight::Circles(circles(receiver, spheres, *rule)),
        };
        View { sight, upper_sky: self.upper_sky }
    }
}

/// The blockers as one receiver sees them.
pub(crate) struct View<'w> {
    sight: Sight<'w>,
    upper_sky: bool,
}

enum Sight<'w> {
    /// Rays from an origin.
    Rays { traced: &'w Traced, origin: Vec3 },
    /// Blocked circles: centre and squared chord from the centre to the rim, the largest first.
    Circles(Vec<(Vec3, f32)>),
}

impl View<'_> {
    /// Whether the distance is blocked in each unit direction; the slices have equal lengths.
    pub(crate) fn blocked(&self, directions: &[Vec3], blocked: &mut [bool]) {
        match &self.sight {
            Sight::Rays { traced, origin } => traced.world.occluded_from(*origin, 0.0, directions, blocked),
            Sight::Circles(circles) => {
                for (direction, blocked) in directions.iter().zip(&mut *blocked) {
                    *blocked = circles.iter().any(|(axis, chord)| direction.distance_squared(*axis) <= *chord);
                }
            }
        }
        if self.upper_sky {
            directions.iter().zip(blocked).for_each(|(direction, blocked)| *blocked |= direction.z < 0.0);
        }
    }

    /// A ray as far as a point of the scene; circles know no distances.
    pub(crate) fn ray(&self, direction: Vec3, distance: f32) -> Ray {
        match &self.sight {
            Sight::Rays { origin, .. } => Ray { origin: *origin, direction, t_min: 0.0, t_max: distance },
            Sight::Circles(_) => unreachable!("spheres are proxies under distant light alone"),
        }
    }

    /// Whether anything lies on each ray.
    pub(crate) fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        match &self.sight {
            Sight::Rays { traced, .. } => traced.world.occluded(rays, blocked),
            Sight::Circles(_) => unreachable!("spheres are proxies under distant light alone"),
        }
    }
}

/// The circles that reach above the receiver's horizon. As chords, small circles keep their size in `f32`.
fn circles(receiver: &Receiver, spheres: &[Sphere], rule: SelfShadow) -> Vec<(Vec3, f32)> {
    let mut circles: Vec<(Vec3, f32)> = spheres
        .iter()
        .filter_map(|sphere| seen(rule, receiver.position, receiver.geometric_normal, sphere))
        .filter(|circle| circle.axis.dot(receiver.normal) > -circle.sin_angle)
        .map(|circle| (circle.axis, 2.0 * circle.sin_angle * circle.sin_angle / (1.0 + circle.cos_angle())))
        .collect();
    circles.sort_by(|a, b| b.1.total_cmp(&a.1));
    circles
}
