//! What blocks light on its way to receivers.

use glam::Vec3;
use halflight_proxies::{SelfShadow, seen};
use halflight_scenes::{Frame, Mesh, PosedObject, Scene, Shape, Sphere, Which};
use halflight_trace::World;

use crate::receiver::Receiver;

/// The blockers of one frame.
pub(crate) enum Visibility {
    /// Traced geometry.
    Traced {
        /// Objects that cast shadows, posed.
        world: Box<World>,
        /// For each object, how to leave it; `None` for one that no ray can hit.
        surfaces: Vec<Option<Surface>>,
    },
    /// Spheres seen under a self-shadow rule.
    Spheres {
        /// All spheres, posed.
        spheres: Vec<Sphere>,
        /// The rule.
        rule: SelfShadow,
    },
}

/// What the rays of receivers on an object must know of it.
pub(crate) struct Surface {
    /// The farthest from the origin that it gets.
    reach: f32,
    /// Whether it is a height field: above a point on it there is nothing else of it, while on the way along a normal there
    /// may be, such as the far side of a steep pit.
    graph: bool,
}

/// Rays leave a height field straight up, at the distance from its plane that they would have along its normal, as long as the
/// normal rises by at least this (slopes up to 86°).
const STEEPEST: f32 = 1.0 / 16.0;

/// How far off its own surface a receiver's rays start, in rounding steps of the largest coordinate of the object that it lies
/// on: a position on a triangle is a sum of a few rounded products of its corners. What lies on nothing that casts needs none.
const OFFSET_STEPS: f32 = 16.0;

/// The same for a receiver of which only the position is known: that was rounded once.
const OFFSET_STEPS_OF_POINTS: f32 = 2.0;

impl Visibility {
    /// The real geometry of a frame.
    pub(crate) fn traced(scene: &Scene, frame: &Frame) -> Self {
        let surface = |posed: &PosedObject| match &scene.objects[posed.object] {
            object if object.casts => Some(Surface {
                reach: reach(&object.shape) + posed.pose.translation.length(),
                graph: matches!(*object.shape, Shape::Heights(_)),
            }),
            _ => None,
        };
        let surfaces = frame.objects.iter().map(surface).collect();
        Visibility::Traced { world: Box::new(scene.world(frame, Which::Casters)), surfaces }
    }

    /// What a receiver sees of the blockers.
    pub(crate) fn from(&self, receiver: &Receiver) -> View<'_> {
        match self {
            Visibility::Traced { world, surfaces } => {
                let surface = receiver.object.map(|object| surfaces[object as usize].as_ref());
                View::Rays { world, origin: receiver.position + off(receiver, surface) }
            }
            Visibility::Spheres { spheres, rule } => View::Circles(circles(receiver, spheres, *rule)),
        }
    }
}

/// The step from a receiver, on a known object or none, to where its rays start.
fn off(receiver: &Receiver, surface: Option<Option<&Surface>>) -> Vec3 {
    let normal = receiver.geometric_normal;
    match surface {
        Some(Some(Surface { reach, graph: true })) => {
            let steepness = normal.z.abs().max(STEEPEST).copysign(normal.z);
            f32::EPSILON * OFFSET_STEPS * reach / steepness * Vec3::Z
        }
        Some(Some(Surface { reach, graph: false })) => f32::EPSILON * OFFSET_STEPS * reach * normal,
        Some(None) => Vec3::ZERO,
        None => f32::EPSILON * OFFSET_STEPS_OF_POINTS * receiver.position.length() * normal,
    }
}

/// The farthest from the origin that a shape gets.
fn reach(shape: &Shape) -> f32 {
    let of_mesh = |mesh: &Mesh| mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
    match shape {
        Shape::Mesh(mesh) => of_mesh(mesh),
        Shape::Heights(field) => of_mesh(field.mesh()),
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
