//! The camera that a model brings, or one that has all models in view.

use glam::DVec3;

use super::model::Model;
use super::view::{self, Bounds};
use super::{Import, digits};
use crate::assets::View;

/// Pixels of a picture whose size nobody gives.
const PIXELS: f64 = 160.0 * 120.0;
const SIZE: [usize; 2] = [160, 120];
/// A target and a size count as long as the camera still has them.
const TOLERANCE: f64 = 1e-3;

/// The table of the scene file, and what to tell of it.
pub(super) fn table(models: &[Model], bounds: &Bounds, request: &Import) -> (String, String) {
    match models.iter().find_map(|model| Some((model, model.survey.camera.as_ref()?))) {
        Some((model, view)) => {
            (brought(view, f64::from(model.unit), bounds, request), "camera: of the file".to_owned())
        }
        None => {
            let size = request.size.unwrap_or(SIZE);
            let (eye, target) = view::framed(bounds, size[0] as f64 / size[1] as f64);
            (
                written(eye, target, None, view::FOV, size),
                "camera: three-quarter view from the front, by guess".to_owned(),
            )
        }
    }
}

fn written(eye: [f32; 3], target: [f32; 3], up: Option<[f32; 3]>, fov: f32, [width, height]: [usize; 2]) -> String {
    let up = up.map_or_else(String::new, |up| format!("up = {up:?}\n"));
    format!("\n[camera]\neye = {eye:?}\ntarget = {target:?}\n{up}fov = {fov:?}\nwidth = {width}\nheight = {height}\n")
}

fn brought(view: &View, unit: f64, bounds: &Bounds, request: &Import) -> String {
    let [forward, up] = [view.forward, view.up].map(super::upright);
    let eye = super::upright(view.eye) * unit;
    let aimed = view.extras.target.map(|target| super::upright(DVec3::from_array(target.map(f64::from))) * unit);
    let aimed = aimed.filter(|target| (*target - eye).try_normalize().is_some_and(|d| d.distance(forward) < TOLERANCE));
    let target = aimed.map(|target| target.as_vec3().to_array()).unwrap_or_else(|| {
        let distance = (bounds.center() - eye).dot(forward).max(0.1 * bounds.size());
        digits::within(eye + forward * distance, bounds.size())
    });
    // Upright cameras, all but those that look straight up or down, need no word of it.
    let upright = forward.cross(up).z.abs() < TOLERANCE && up.z > TOLERANCE;
    let up = (!upright).then(|| digits::direction(up));
    let fov = digits::number(f64::from(view.fov).to_degrees());
    written(eye.as_vec3().to_array(), target, up, fov, size(view, request))
}

fn size(view: &View, request: &Import) -> [usize; 2] {
    let aspect = f64::from(view.aspect.unwrap_or(4.0 / 3.0));
    let fits = |size: &[usize; 2]| (size[0] as f64 / size[1] as f64 / aspect - 1.0).abs() < TOLERANCE;
    let height = (PIXELS / aspect).sqrt().round().clamp(1.0, 1e4);
    let own = [(height * aspect).round().clamp(1.0, 1e4) as usize, height as usize];
    request.size.or(view.extras.size.filter(|size| size[1] > 0 && fits(size))).unwrap_or(own)
}
