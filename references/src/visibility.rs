//! What blocks light on its way to receivers.

use glam::Vec3;
use halflight_proxies::{SelfShadow, seen};
use halflight_scenes::{Frame, PosedObject, Scene, Shape, Sphere, Which};
use halflight_trace::{World, clearance, clearance_of_point};

use crate::receiver::Receiver;

/// The blockers of one frame.
pub(crate) enum Visibility {
    /// Traced geometry.
    Traced {
        /// Objects that cast shadows, posed.
        world: Box<World>,
        /// For each object, the farthest from the origin that it gets; `None` for one that no ray can hit.
        reaches: Vec<Option<f32>>,
    },
    /// Spheres seen under a self-shadow rule.
    Spheres {
        /// All spheres, posed.
        spheres: Vec<Sphere>,
        /// The rule.
        rule: SelfShadow,
    },
}

impl Visibility {
    /// The real geometry of a frame.
    pub(crate) fn traced(scene: &Scene, frame: &Frame) -> Self {
        let reach_of = |posed: &PosedObject| match &scene.objects[posed.object] {
            object if object.casts => Some(reach(&object.shape) + posed.pose.translation.length()),
            _ => None,
        };
        let reaches = frame.objects.iter().map(reach_of).collect();
        Visibility::Traced { world: Box::new(scene.world(frame, Which::Casters)), reaches }
    }

    /// What a receiver sees of the blockers.
    pub(crate) fn from(&self, receiver: &Receiver) -> View<'_> {
        match self {
            Visibility::Traced { world, reaches } => {
                // What lies on nothing that casts needs none.
                let offset = match receiver.object.map(|object| reaches[object as usize]) {
                    Some(reach) => reach.map_or(0.0, clearance),
                    None => clearance_of_point(receiver.position),
                };
                View::Rays { world, origin: receiver.position + offset * receiver.geometric_normal }
            }
            Visibility::Spheres { spheres, rule } => View::Circles(circles(receiver, spheres, *rule)),
        }
    }
}

/// The farthest from the origin that a shape gets.
fn reach(shape: &Shape) -> f32 {
    match shape {
        Shape::Mesh(mesh) => mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max),
        Shape::Spheres(spheres) => spheres.iter().map(|s| s.center.length() + s.radius).fold(0.0, f32::max),
    }
}

/// The blockers as one receiver sees them.
pub(crate) enum View<'w> {
    /// Rays from an origin.
    Rays {
        /// What they may hit.
        world: &'w World,
        /// Where they start.
        origin: Vec3,
    },
    /// Blocked circles: centre and squared chord from the centre to the rim, the largest first.
    Circles(Vec<(Vec3, f32)>),
}

impl View<'_> {
    /// Whether each unit direction is blocked; the slices have equal lengths.
    pub(crate) fn blocked(&self, directions: &[Vec3], blocked: &mut [bool]) {
        match self {
            View::Rays { world, origin } => world.occluded_from(*origin, 0.0, directions, blocked),
            View::Circles(circles) => {
                for (direction, blocked) in directions.iter().zip(blocked) {
                    *blocked = circles.iter().any(|(axis, chord)| direction.distance_squared(*axis) <= *chord);
                }
            }
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
