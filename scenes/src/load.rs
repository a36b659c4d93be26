//! From a scene file to a scene.

mod animated;
mod body;
mod emission;
mod heights;
mod lights;
pub(crate) mod objects;
mod receivers;
mod solids;

use std::path::Path;

use crate::assets::Assets;
use crate::check::Checker;
use crate::content::Content;
use crate::format::{CameraFile, FramesFile, SceneFile};
use crate::{Bodies, Camera, Object, Placement, Scene, SceneError};

/// Most pixels along a side of a picture or grid, frames, and receivers over all frames: a plan holds every frame at once, about
/// 80 bytes a receiver.
pub(crate) const MOST_PIXELS: usize = 1 << 14;
const MOST_FRAMES: usize = 1 << 20;
pub(crate) const MOST_RECEIVERS: usize = 1 << 25;

impl Scene {
    /// Loads and checks a scene file. Asset paths in it are relative to its folder.
    ///
    /// # Errors
    /// The first thing found wrong, with file, field and what was expected.
    pub fn load(path: &Path) -> Result<Scene, SceneError> {
        let bytes = crate::assets::read(path)?;
        let check = Checker { file: path };
        let text = str::from_utf8(&bytes)
            .map_err(|error| check.malformed(format!("byte {}", error.valid_up_to()), "expected UTF-8 text"))?;
        Scene::parse(path, text)
    }

    /// The same from text: `path` names the scene in its stem and in errors, and its folder holds the assets.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse(path: &Path, text: &str) -> Result<Scene, SceneError> {
        let check = Checker { file: path };
        let file: SceneFile = read_toml(check, text)?;
        let assets = Assets::beside(path);
        let mut notices = Vec::new();
        let objects = objects::load(check, &assets, &file.objects, &mut notices)?;
        Scene::assemble(path, &file, objects, notices)
    }

    /// The scene of a file whose objects are loaded already.
    pub(crate) fn assemble(
        path: &Path,
        file: &SceneFile,
        objects: Vec<Object>,
        mut notices: Vec<String>,
    ) -> Result<Scene, SceneError> {
        let (check, assets) = (Checker { file: path }, Assets::beside(path));
        let lights = lights::load(check, &assets, &file.lights, &mut notices)?;
        let lit = !lights.is_empty() || objects.iter().any(Object::emits);
        check.ensure(lit, "lights", "at least one light, or an object with emission", lights.len())?;
        let camera = file.camera.as_ref().map(|camera| load_camera(check, camera)).transpose()?;
        let placement = receivers::load(check, &assets, &file.receivers, &objects, camera.as_ref())?;
        let (frame_count, fps) = load_frames(check, &file.frames)?;
        let scene = Scene {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            purpose: load_purpose(check, &file.purpose)?,
            content: Content::of(b""),
            objects,
            lights,
            camera,
            placement,
            frame_count,
            fps,
            notices,
            bodies: Bodies::default(),
        };
        let receivers = scene.facts().receivers.saturating_mul(scene.frame_count);
        let bound = format!("at most {MOST_RECEIVERS} over all frames");
        check.ensure(receivers <= MOST_RECEIVERS, "receivers", &bound, receivers)?;
        if matches!(scene.placement, Placement::Camera) && !scene.frame(0).receivers.valid.contains(&true) {
            return Err(check.invalid("camera", "a view of at least one object in frame 0", "none"));
        }
        Ok(Scene { content: scene.compute_content(), ..scene })
    }
}

pub(crate) fn read_toml<T: serde::de::DeserializeOwned>(check: Checker, text: &str) -> Result<T, SceneError> {
    toml::from_str(text).map_err(|error| syntax(check, text, &error))
}

/// TOML's own messages span several lines; what remains here is one with its place.
fn syntax(check: Checker, text: &str, error: &toml::de::Error) -> SceneError {
    let start = error.span().map_or(0, |span| span.start.min(text.len()));
    let line = text.as_bytes()[..start].iter().filter(|byte| **byte == b'\n').count() + 1;
    check.malformed(format!("line {line}"), error.message().trim().replace('\n', ", "))
}

fn load_purpose(check: Checker, purpose: &str) -> Result<String, SceneError> {
    let line = purpose.trim();
    check.ensure(!line.is_empty() && !line.contains('\n'), "purpose", "one line of text", purpose)?;
    Ok(line.to_owned())
}

fn load_frames(check: Checker, frames: &FramesFile) -> Result<(usize, f32), SceneError> {
    Ok((check.count("frames.count", frames.count, MOST_FRAMES)?, check.positive("frames.fps", frames.fps)?))
}

fn load_camera(check: Checker, camera: &CameraFile) -> Result<Camera, SceneError> {
    let eye = check.point("camera.eye", camera.eye)?;
    let target = check.point("camera.target", camera.target)?;
    let up = check.direction("camera.up", camera.up)?;
    let view = check.direction("camera.target", (target - eye).into())?;
    check.ensure(
        view.cross(up).length() > 1e-4,
        "camera.up",
        "a direction that is not parallel to the view",
        camera.up,
    )?;
    check.ensure(camera.fov > 0.0 && camera.fov < 180.0, "camera.fov", "degrees between 0 and 180", camera.fov)?;
    Ok(Camera {
        eye,
        target,
        up,
        vertical_fov: camera.fov.to_radians(),
        width: check.count("camera.width", camera.width, MOST_PIXELS)?,
        height: check.count("camera.height", camera.height, MOST_PIXELS)?,
    })
}
