//! Pinhole cameras.

use glam::Vec3;

use crate::content::Collector;

/// A pinhole camera with square pixels; pixel `(0, 0)` is at the top left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Eye position.
    pub eye: Vec3,
    /// Point looked at.
    pub target: Vec3,
    /// Up direction, not parallel to the view.
    pub up: Vec3,
    /// Vertical field of view in radians.
    pub vertical_fov: f32,
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Camera {
    /// Unit direction through a point of the picture in pixels: `(0, 0)` is its top left corner, a pixel's centre
    /// lies at `+ 0.5`.
    pub fn direction(&self, x: f32, y: f32) -> Vec3 {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        let up = right.cross(forward);
        let pixel = 2.0 * (0.5 * self.vertical_fov).tan() / self.height as f32;
        let (across, down) = (x - 0.5 * self.width as f32, y - 0.5 * self.height as f32);
        (forward + right * (across * pixel) - up * (down * pixel)).normalize()
    }

    pub(crate) fn collect(&self, into: Collector) -> Collector {
        let placed = into.vec3(self.eye).vec3(self.target).vec3(self.up);
        placed.float(self.vertical_fov).word(self.width).word(self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_is_upright_and_its_fov_vertical() {
        let camera = Camera {
            eye: Vec3::new(0.0, -5.0, 1.0),
            target: Vec3::new(0.0, 0.0, 1.0),
            up: Vec3::Z,
            vertical_fov: 60f32.to_radians(),
            width: 40,
            height: 20,
        };
        assert!(camera.direction(20.0, 10.0).distance(Vec3::Y) < 1e-6);
        let elevation = |d: Vec3| d.z.atan2(d.y).to_degrees();
        assert!((elevation(camera.direction(20.0, 0.0)) - 30.0).abs() < 1e-4, "the top edge looks up");
        assert!((elevation(camera.direction(20.0, 20.0)) + 30.0).abs() < 1e-4);
        // Square pixels: the right edge lies as far as twice the top edge on the image plane, towards +x.
        let right = camera.direction(40.0, 10.0);
        assert!((right.x / right.y - 2.0 * 30f32.to_radians().tan()).abs() < 1e-5);
    }
}
