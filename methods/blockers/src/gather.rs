//! Gathering the circles of all blockers that matter at a receiver.

use glam::Vec3;
use halflight_proxies::{Circle, SelfShadow, seen};
use halflight_scenes::Sphere;

/// Which blockers count.
#[derive(Clone, Copy, Debug)]
pub struct Gather {
    /// Self-shadow rule.
    pub self_shadow: SelfShadow,
    /// Circles with a smaller sine of the angular radius are skipped; 0 skips none.
    pub min_sin_angle: f32,
}

/// Blockers looked at while gathering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Circles accumulated.
    pub accumulated: u64,
    /// Spheres that the self-shadow rules removed.
    pub removed: u64,
    /// Circles below the smallest angle.
    pub too_small: u64,
}

impl Gather {
    /// Calls `accumulate` with the circle of each blocker that counts, in the order given.
    pub fn circles(
        &self,
        position: Vec3,
        normal: Vec3,
        spheres: &[Sphere],
        tally: &mut Tally,
        mut accumulate: impl FnMut(&Circle),
    ) {
        for sphere in spheres {
            match seen(self.self_shadow, position, normal, sphere) {
                None => tally.removed += 1,
                Some(circle) if circle.sin_angle < self.min_sin_angle => tally.too_small += 1,
                Some(circle) => {
                    tally.accumulated += 1;
                    accumulate(&circle);
                }
            }
        }
    }
}
