//! The same scene with more or fewer receivers: `NAME@FACTOR`.

use std::path::PathBuf;

use crate::load::{MOST_PIXELS, MOST_RECEIVERS};
use crate::{Placement, Scene, SceneError};

impl Scene {
    /// The scene with the resolution of its camera or grid times a factor, given as text; its name ends in `@FACTOR`. Pixels
    /// and cells are rounded to whole numbers, one at least.
    ///
    /// # Errors
    /// The factor is no number above zero, the resolution becomes too large, or the receivers are vertices or points, which
    /// have no resolution.
    pub fn at_resolution(&self, factor: &str) -> Result<Scene, SceneError> {
        let wrong = |expected: String, found: String| {
            let (file, field) = (PathBuf::from(&self.name), format!("@{factor}"));
            SceneError::Invalid { file, field, expected, found }
        };
        let number: f64 = factor.parse().ok().filter(|f: &f64| *f > 0.0 && f.is_finite()).ok_or_else(|| {
            wrong("a factor above zero after the scene's name, such as @0.5".to_owned(), factor.to_owned())
        })?;
        let scaled = |cells: usize| ((cells as f64 * number).round() as usize).max(1);
        let mut scene = self.clone();
        let [width, height] = match (&mut scene.placement, &mut scene.camera) {
            (Placement::Grid(grid), _) => {
                grid.resolution = grid.resolution.map(scaled);
                grid.resolution
            }
            (Placement::Camera, Some(camera)) => {
                (camera.width, camera.height) = (scaled(camera.width), scaled(camera.height));
                [camera.width, camera.height]
            }
            _ => return Err(wrong("receivers of a camera or a grid".to_owned(), "vertices or points".to_owned())),
        };
        let few = width.max(height) <= MOST_PIXELS && width * height * self.frame_count <= MOST_RECEIVERS;
        if !few {
            let expected = format!("at most {MOST_PIXELS} a side and {MOST_RECEIVERS} receivers over all frames");
            return Err(wrong(expected, format!("{width} by {height}")));
        }
        Ok(Scene { name: format!("{}@{factor}", self.name), content: scene.compute_content(), ..scene })
    }
}
