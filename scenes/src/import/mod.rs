//! From models and a picture to the folder of a scene: `halflight import`.

mod camera;
mod digits;
mod folder;
mod lights;
mod model;
mod text;
mod view;

use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::assets::Assets;
use crate::check::Checker;
use crate::format::{SceneFile, Up};
use crate::load::read_toml;
use crate::{Object, Scene, SceneError};

use folder::{Copies, Staging};
use lights::Lights;
use model::Model;
use text::Ground;
use view::Bounds;

const MODELS: [&str; 5] = ["gltf", "glb", "obj", "off", "ply"];
const PICTURES: [&str; 2] = ["exr", "hdr"];

/// What is to become a scene, and how.
#[derive(Clone, Debug)]
pub struct Import {
    /// Models, at least one (glTF, GLB, OBJ, OFF, PLY), and at most one picture of the surroundings (EXR, HDR).
    pub files: Vec<PathBuf>,
    /// Name of the scene; that of the first model if none.
    pub name: Option<String>,
    /// The axis of OBJ, OFF and PLY files that points up; y if none.
    pub up: Option<Up>,
    /// Metres a unit of the models; 1 if none.
    pub unit: Option<f32>,
    /// Pixels of the camera across and down; of the model's camera, or 160 x 120, if none.
    pub size: Option<[usize; 2]>,
    /// Where light is asked.
    pub receivers: Wanted,
    /// Whether a ground goes below models that come without one of ours.
    pub ground: bool,
    /// Name or number of the animation that is played, `none` for none; the first if none is given.
    pub clip: Option<String>,
    /// Most frames.
    pub frames: usize,
    /// Frames a second.
    pub fps: f32,
    /// By which the models' lights are multiplied.
    pub light_scale: f32,
}

/// Where an imported scene asks for light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// At what the camera's pixels see.
    Camera,
    /// At the vertices of the first model's first mesh.
    Vertices,
    /// On the ground, in a grid.
    Ground,
}

impl Import {
    /// Of some files, with all that can be guessed left to guess.
    pub fn new(files: Vec<PathBuf>) -> Self {
        Import {
            files,
            name: None,
            up: None,
            unit: None,
            size: None,
            receivers: Wanted::Camera,
            ground: true,
            clip: None,
            frames: 240,
            fps: 24.0,
            light_scale: 1.0,
        }
    }
}

/// A scene that was made.
#[derive(Debug)]
pub struct Imported {
    /// Its file.
    pub file: PathBuf,
    /// The scene, loaded.
    pub scene: Scene,
    /// What was read, and what guessed, a line each.
    pub told: Vec<String>,
}

/// Makes a scene's folder, one with the scene's name if none is given: `NAME.toml`, and all files that it needs. With `force` the
/// folder may be there already.
///
/// # Errors
/// The first thing found wrong, with file, field and what was expected; nothing is left behind then.
pub fn import(request: &Import, out: Option<&Path>, force: bool) -> Result<Imported, SceneError> {
    let (paths, picture) = sorted(&request.files)?;
    let name = name(request, &paths[0])?;
    let out = out.unwrap_or(Path::new(&name));
    let names = object_names(&paths);
    let models = paths.iter().zip(&names).map(|(path, name)| Model::read(path, name, request));
    let models: Vec<Model> = models.collect::<Result<_, _>>()?;
    let draft = Draft::new(&models, picture.as_deref(), request)?;
    let staging = Staging::new(out, force)?;
    let scene_file = format!("{name}.toml");
    staging.fill(&draft.copies, &scene_file, &draft.text)?;
    let told = models.iter().map(|model| model.told.clone()).chain(draft.told).collect();
    let scene = load(&staging.folder.join(&scene_file), &draft.text, models);
    let scene = scene.map_err(|error| error.told_of(&staging.folder, out))?;
    staging.finish(&draft.copies, &scene_file)?;
    Ok(Imported { file: out.join(scene_file), scene, told })
}

/// y up to z up, x stays.
fn upright(v: DVec3) -> DVec3 {
    DVec3::new(v.x, -v.z, v.y)
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Models, at least one, and the picture; paths lead to the files themselves, not to links.
fn sorted(files: &[PathBuf]) -> Result<(Vec<PathBuf>, Option<PathBuf>), SceneError> {
    let (mut models, mut picture) = (Vec::new(), None);
    for file in files {
        let check = Checker { file };
        let kind = extension(file);
        if !MODELS.contains(&kind.as_str()) && !PICTURES.contains(&kind.as_str()) {
            let expected = format!("a model as one of {MODELS:?} or a picture as one of {PICTURES:?}");
            return Err(check.invalid("extension", expected, kind));
        }
        let unreadable = |reason| SceneError::Unreadable { file: file.clone(), reason };
        let real = file.canonicalize().map_err(unreadable)?;
        if MODELS.contains(&kind.as_str()) {
            models.push(real);
        } else if let Some(other) = picture.replace(real) {
            return Err(check.invalid("picture", "at most one", other.display()));
        }
    }
    if models.is_empty() {
        let none = Path::new("import");
        let file = files.first().map_or(none, PathBuf::as_path);
        return Err(Checker { file }.invalid("models", format!("at least one of {MODELS:?}"), "none"));
    }
    Ok((models, picture))
}

/// Of the scene: what may be a file's stem.
fn name(request: &Import, model: &Path) -> Result<String, SceneError> {
    let name = request.name.clone().unwrap_or_else(|| stem(model));
    let holds =
        !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\', '@']) && text::one_line(&name) == name;
    Checker { file: model }.ensure(holds, "--name", "a name without slashes and @, not hidden", name)
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Each model's stem, with a number where another has it.
fn object_names(paths: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = vec!["ground".into()];
    for path in paths {
        let fresh = |name: &String| !names.contains(name);
        let numbered = (2..).map(|number| format!("{}-{number}", stem(path)));
        let name = std::iter::once(stem(path)).chain(numbered).find(fresh);
        names.extend(name);
    }
    names.split_off(1)
}

/// A scene's file before it is written.
struct Draft {
    text: String,
    copies: Copies,
    told: Vec<String>,
}

impl Draft {
    fn new(models: &[Model], picture: Option<&Path>, request: &Import) -> Result<Self, SceneError> {
        let check = Checker { file: &models[0].path };
        let fps = check.positive("--fps", request.fps)?;
        check.positive("--light-scale", request.light_scale)?;
        let frames = frames(models, request);
        let objects: Vec<&Object> = models.iter().flat_map(|model| &model.objects).collect();
        let bounds = Bounds::of(&objects, frames, fps);
        let lights = Lights::of(models, picture, &bounds, request)?;
        let complete = models.iter().any(|model| model.survey.scene.is_some());
        let ground = (request.ground && !complete).then(|| Ground::below(&bounds));
        let (camera, camera_told) = camera::table(models, &bounds, request);
        let receivers = receivers(check, request.receivers, models, ground.as_ref())?;

        let mut text = head(models, picture);
        text += &camera;
        text += &format!("\n[receivers]\n{receivers}");
        models.iter().for_each(|model| text += &model.entry);
        text += &ground.as_ref().map_or_else(String::new, Ground::entry);
        text += &lights.lamps;
        text += &lights.lights;
        if frames > 1 {
            text += &format!("\n[frames]\ncount = {frames}\nfps = {fps:?}\n");
        }
        let mut told = models.iter().flat_map(|model| model.notices.clone()).collect::<Vec<_>>();
        told.extend(lights.told);
        told.push(camera_told);
        Ok(Draft { text, copies: copies(models, &lights.pictures)?, told })
    }
}

/// As long as the longest clip.
fn frames(models: &[Model], request: &Import) -> usize {
    let seconds = models.iter().map(|model| model.seconds).fold(0.0, f64::max);
    ((seconds * f64::from(request.fps)).round() as usize).clamp(1, request.frames.max(1))
}

fn receivers(check: Checker, wanted: Wanted, models: &[Model], ground: Option<&Ground>) -> Result<String, SceneError> {
    match wanted {
        Wanted::Camera => Ok("camera = {}\n".to_owned()),
        Wanted::Vertices => Ok(format!("vertices = {{ object = {} }}\n", text::string(&models[0].objects[0].name))),
        Wanted::Ground => {
            let missing = || check.invalid("--receivers", "camera or vertices, since there is no ground", "ground");
            ground.map(Ground::receivers).ok_or_else(missing)
        }
    }
}

fn head(models: &[Model], picture: Option<&Path>) -> String {
    let file = |path: &Path| text::one_line(&path.file_name().unwrap_or_default().to_string_lossy());
    let names: Vec<String> = models.iter().map(|model| file(&model.path)).collect();
    let light = picture.map_or_else(String::new, |picture| format!(" in the light of {}", file(picture)));
    let mut head = text::comment("Made by `halflight import`:");
    models.iter().for_each(|model| head += &text::comment(&model.told));
    head + &format!("purpose = {}\n", text::string(&format!("{}{light}", names.join(", "))))
}

fn copies(models: &[Model], pictures: &[(PathBuf, String)]) -> Result<Copies, SceneError> {
    let mut copies = Copies::default();
    for model in models {
        let file = model.path.file_name().unwrap_or_default().to_string_lossy();
        copies.add(&model.path, &file)?;
        for file in &model.survey.files {
            let beside = Assets::beside(&model.path).within("uri", file)?;
            // Pictures that nothing is made of may be missing; what is needed was read by now.
            if beside.is_file() {
                copies.add(&beside, file)?;
            }
        }
    }
    pictures.iter().try_for_each(|(from, to)| copies.add(from, to))?;
    Ok(copies)
}

/// The scene as it stands in its folder, without reading its models once more.
fn load(path: &Path, text: &str, models: Vec<Model>) -> Result<Scene, SceneError> {
    let check = Checker { file: path };
    let mut file: SceneFile = read_toml(check, text)?;
    let others = file.objects.split_off(models.len());
    let (mut objects, mut notices) = (Vec::new(), Vec::new());
    for model in models {
        objects.extend(model.objects);
        notices.extend(model.notices);
    }
    if !others.is_empty() {
        objects.extend(crate::load::objects::load(check, &Assets::beside(path), &others, &mut notices)?);
    }
    let mut names: Vec<&str> = objects.iter().map(|object| object.name.as_str()).collect();
    names.sort_unstable();
    if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(check.invalid("objects.name", "models whose names differ", pair[0]));
    }
    Scene::assemble(path, &file, objects, notices)
}
