//! One receiver of a frame.

use glam::Vec3;
use halflight_scenes::Frame;

/// Where light is asked.
pub(crate) struct Receiver {
    pub(crate) position: Vec3,
    pub(crate) geometric_normal: Vec3,
    pub(crate) normal: Vec3,
    /// The object it lies on, if that is known.
    pub(crate) object: Option<u32>,
}

impl Receiver {
    pub(crate) fn of(frame: &Frame, index: usize) -> Self {
        let all = &frame.receivers;
        Receiver {
            position: all.position[index],
            geometric_normal: all.geometric_normal[index],
            normal: all.normal[index],
            object: all.place[index].object,
        }
    }
}
