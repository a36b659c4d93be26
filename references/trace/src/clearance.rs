//! How far off a surface its own rays start.

use glam::Vec3;

/// Rounding steps of the largest coordinate: a position on a triangle is a sum of a few rounded products of its corners,
/// carried by a rounded pose.
const STEPS: f32 = 16.0;

/// The same for a position of which nothing else is known: that was rounded once.
const STEPS_OF_POINTS: f32 = 2.0;

/// By how much a position on an object is to be moved along its geometric normal, so that rays which leave above the
/// surface do not meet it, as near as rounding permits. `reach` is the farthest from the world's origin that the
/// object gets; for one that was moved, how far it was moved plus the farthest from its own origin.
pub fn clearance(reach: f32) -> f32 {
    STEPS * f32::EPSILON * reach
}

/// The same for a position given from outside, on no object or an unknown one: enough for a surface whose triangles
/// are no larger than the position's distance from the origin.
pub fn clearance_of_point(position: Vec3) -> f32 {
    STEPS_OF_POINTS * f32::EPSILON * position.length()
}
