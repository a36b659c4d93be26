//! The scenes that come with Halflight, and finding any scene by name or path.

use std::path::{Path, PathBuf};

use crate::{Scene, SceneError};

/// The folder of the shipped scenes: `HALFLIGHT_SCENES`, or the one beside these sources.
fn folder() -> PathBuf {
    match std::env::var_os("HALFLIGHT_SCENES") {
        Some(folder) => folder.into(),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("data"),
    }
}

/// Name, file and purpose of every shipped scene, by name. Files that do not even hold a purpose are left out: to
/// load one of them says what is wrong with it.
pub fn shipped() -> Vec<(String, PathBuf, String)> {
    let files = std::fs::read_dir(folder()).into_iter().flatten().flatten().map(|entry| entry.path());
    let scene_files = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let mut scenes: Vec<_> = scene_files.filter_map(|path| Some((stem(&path), purpose(&path)?, path))).collect();
    scenes.sort();
    scenes.into_iter().map(|(name, purpose, path)| (name, path, purpose)).collect()
}

/// Loads a shipped scene by its name, or any scene by the path of its file. Where `@FACTOR` follows, its receivers are as many
/// more or fewer as [`Scene::at_resolution`] says.
///
/// # Errors
/// A name that is neither, or what is wrong with the scene or the factor.
pub fn find(name_or_path: &str) -> Result<Scene, SceneError> {
    let shipped = shipped();
    if let Some((_, path, _)) = shipped.iter().find(|(name, ..)| name == name_or_path) {
        return Scene::load(path);
    }
    let path = Path::new(name_or_path);
    let is_factor = |text: &str| !text.contains(std::path::is_separator) && !text.ends_with(".toml");
    match name_or_path.rsplit_once('@') {
        Some((whole, factor)) if is_factor(factor) && !path.is_file() => return find(whole)?.at_resolution(factor),
        _ => {}
    }
    if path.is_file() || path.extension().is_some_and(|extension| extension == "toml") {
        return Scene::load(path);
    }
    let names: Vec<String> = shipped.into_iter().map(|(name, ..)| name).collect();
    Err(SceneError::Unknown { name: name_or_path.to_owned(), shipped: names.join(", ") })
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn purpose(path: &Path) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    let table: toml::Table = text.parse().ok()?;
    Some(table.get("purpose")?.as_str()?.trim().to_owned())
}
