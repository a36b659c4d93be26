//! A model: what it is, what of it is a guess, and its entry in the scene.

use std::path::{Path, PathBuf};

use super::{Import, digits, text};
use crate::assets::{Asset, Assets, Survey};
use crate::check::Checker;
use crate::format::{ObjectFile, Up};
use crate::load::{objects, read_toml};
use crate::{Object, SceneError, Shape};

/// Albedo of models without materials.
const GREY: [f32; 3] = [0.7; 3];

/// A model and all that its file brings.
pub(super) struct Model {
    /// Where it was found.
    pub(super) path: PathBuf,
    /// Its entry in the scene.
    pub(super) entry: String,
    pub(super) objects: Vec<Object>,
    /// Metres a unit of the file.
    pub(super) unit: f32,
    /// Seconds of the clip that it plays.
    pub(super) seconds: f64,
    pub(super) survey: Survey,
    /// What was taken from the file, and what guessed.
    pub(super) told: String,
    /// What was left out or repaired.
    pub(super) notices: Vec<String>,
}

/// What a file says about where up is.
enum Axis {
    Given(Up),
    Guessed(Up),
    /// By its format.
    Fixed,
}

impl Model {
    /// Reads a model; `name` is its object's.
    pub(super) fn read(path: &Path, name: &str, request: &Import) -> Result<Self, SceneError> {
        let (check, assets) = (Checker { file: path }, Assets::beside(path));
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let asset = assets.read("name", &file, None)?;
        let is_gltf = is_gltf(path);
        let survey = if is_gltf { asset.survey()? } else { Survey::default() };
        let axis = axis(check, is_gltf, request.up)?;
        let unit = check.positive("--unit", request.unit.unwrap_or(1.0))?;
        let clip = clip(check, &survey, request.clip.as_deref())?;
        let entry = entry(name, &file, &asset, &axis, unit, clip.map(|clip| clip.0));
        let mut notices = survey.notices.iter().map(|notice| format!("{file}: {notice}")).collect();
        let objects = load(path, &assets, &entry, &mut notices)?;
        let told = format!("{file}: {}, {}, {}", size(&objects), axis.told(), told_unit(is_gltf, request.unit));
        let seconds = clip.map_or(0.0, |clip| clip.1);
        Ok(Model { path: path.to_owned(), entry, objects, unit, seconds, survey, told, notices })
    }
}

pub(super) fn is_gltf(path: &Path) -> bool {
    ["gltf", "glb"].contains(&super::extension(path).as_str())
}

fn axis(check: Checker, is_gltf: bool, asked: Option<Up>) -> Result<Axis, SceneError> {
    match (is_gltf, asked) {
        (true, Some(Up::Z)) => Err(check.invalid("--up", "y: glTF files have y up by their format", "z")),
        (true, _) => Ok(Axis::Fixed),
        (false, Some(up)) => Ok(Axis::Given(up)),
        (false, None) => Ok(Axis::Guessed(Up::Y)),
    }
}

impl Axis {
    fn up(&self) -> Up {
        match self {
            Axis::Given(up) | Axis::Guessed(up) => *up,
            Axis::Fixed => Up::Y,
        }
    }

    fn told(&self) -> &'static str {
        match self {
            Axis::Fixed => "y up by its format",
            Axis::Given(Up::Y) => "y up as asked for",
            Axis::Given(Up::Z) => "z up as asked for",
            Axis::Guessed(_) => "y up by guess, as in most such files (--up z if it lies on its side)",
        }
    }
}

fn told_unit(is_gltf: bool, asked: Option<f32>) -> String {
    match (asked, is_gltf) {
        (Some(unit), _) => format!("a unit is {unit:?} m as asked for"),
        (None, true) => "in metres by its format".to_owned(),
        (None, false) => "in metres by guess (--unit mm and the like if not)".to_owned(),
    }
}

/// The clip to be played and its length in seconds.
fn clip<'a>(check: Checker, survey: &'a Survey, asked: Option<&str>) -> Result<Option<(&'a str, f64)>, SceneError> {
    let chosen = match asked {
        Some("none") => None,
        None => survey.clips.first(),
        Some(_) if survey.clips.is_empty() => None,
        Some(name) => Some(survey.clips.iter().find(|clip| clip.name == name).ok_or_else(|| {
            let names: Vec<&str> = survey.clips.iter().map(|clip| clip.name.as_str()).collect();
            check.invalid("--clip", format!("none or one of {names:?}"), name)
        })?),
    };
    Ok(chosen.map(|clip| (clip.name.as_str(), clip.seconds)))
}

fn entry(name: &str, file: &str, asset: &Asset, axis: &Axis, unit: f32, clip: Option<&str>) -> String {
    let (file_text, hash) = (text::string(file), asset.content());
    let about = format!("file = {file_text}, sha256 = \"{hash}\"");
    let shape = match (axis, axis.up()) {
        (Axis::Fixed, _) => {
            let clip = clip.map_or_else(String::new, |clip| {
                format!(", clip = {}, play = {{ repeat = true }}", text::string(clip))
            });
            format!("gltf = {{ {about}{clip}, drop_degenerate = true }}\n")
        }
        (_, Up::Y) => format!("mesh = {{ {about}, up = \"y\", drop_degenerate = true }}\n"),
        (_, Up::Z) => format!("mesh = {{ {about}, up = \"z\", drop_degenerate = true }}\n"),
    };
    let scale = if unit == 1.0 { String::new() } else { format!("scale = {unit:?} # metres a unit\n") };
    let albedo = match axis {
        Axis::Fixed => String::new(),
        _ => format!("albedo = {GREY:?} # the file's materials are not read\n"),
    };
    format!("\n[[objects]]\nname = {}\n{shape}{scale}{albedo}", text::string(name))
}

/// Entries without the rest of a scene.
#[derive(serde::Deserialize)]
struct Entries {
    objects: Vec<ObjectFile>,
}

pub(super) fn load(
    path: &Path,
    assets: &Assets,
    entries: &str,
    notices: &mut Vec<String>,
) -> Result<Vec<Object>, SceneError> {
    let check = Checker { file: path };
    let Entries { objects } = read_toml(check, entries)?;
    objects::load(check, assets, &objects, notices)
}

fn size(objects: &[Object]) -> String {
    let triangles = |object: &Object| match &*object.shape {
        Shape::Mesh(mesh) => mesh.triangles.len(),
        _ => 0,
    };
    let count: usize = objects.iter().map(triangles).sum();
    let bounds = super::view::Bounds::of(&objects.iter().collect::<Vec<_>>(), 1, 1.0);
    let [x, y, z] = bounds.sides().to_array().map(|side| digits::number(f64::from(side as f32)));
    format!("{count} triangles, {x} x {y} x {z} m")
}
