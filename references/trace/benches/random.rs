//! Numbers for the benches.

use std::f32::consts::TAU;

use glam::Vec3;

/// Deterministic numbers in `[0, 1)` (a linear congruential generator's high bits).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In `[-1, 1)`.
    pub(crate) fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform over the sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let (z, azimuth) = (self.signed(), TAU * self.unit());
        let radius = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(radius * azimuth.cos(), radius * azimuth.sin(), z)
    }
}
