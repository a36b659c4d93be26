//! Files that a scene names: read, checked against their hash, decoded by extension.

mod bvh;
mod color;
mod gltf;
mod height_map;
mod image;
mod obj;
mod off;
#[cfg_attr(not(feature = "oiio"), path = "assets/without_oiio.rs")]
mod oiio;
mod picture;
mod ply;
mod points;
mod proper;
mod text;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Component, Path, PathBuf};

use glam::Vec3;

use crate::check::Checker;
use crate::{Content, Mesh, SceneError, Texture};

pub(crate) use bvh::Capture;
pub(crate) use color::linear;
pub(crate) use gltf::extras;
pub(crate) use gltf::survey::{Punctual, Shines, Survey, View};
pub(crate) use gltf::{Part, Wanted};
pub(crate) use height_map::HeightMap;
pub(crate) use image::Image;
pub use oiio::open_image_io;
pub use points::read_points_csv;
pub(crate) use proper::Mended;

/// The folder that a scene's asset paths start from.
pub(crate) struct Assets<'a> {
    scene: &'a Path,
}

impl<'a> Assets<'a> {
    pub(crate) fn beside(scene: &'a Path) -> Self {
        Assets { scene }
    }

    /// The path of a file in the scene's folder or below: who opens a stranger's scene opens nothing else.
    pub(crate) fn within(&self, field: &str, file: &str) -> Result<PathBuf, SceneError> {
        let named = Path::new(file);
        let inside = named.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        let check = Checker { file: self.scene };
        let expected = "a path inside the scene's folder, without `..`";
        check.ensure(inside && !file.is_empty(), &format!("{field}.file"), expected, file)?;
        let folder = self.scene.parent().unwrap_or(Path::new(""));
        let path = folder.join(named);
        // Links may lead out as well.
        let real = |path: &Path| path.canonicalize().ok();
        let start = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        match (real(start), real(&path)) {
            (Some(folder), Some(real)) if !real.starts_with(&folder) => {
                Err(check.invalid(&format!("{field}.file"), expected, file))
            }
            _ => Ok(path),
        }
    }

    /// Reads a file and compares its SHA-256, where the scene gives one.
    pub(crate) fn read(&self, field: &str, file: &str, sha256: Option<&str>) -> Result<Asset, SceneError> {
        let path = self.within(field, file)?;
        let bytes = read(&path)?;
        if let Some(expected) = sha256 {
            let found = Content::of(&bytes).to_string();
            if !found.eq_ignore_ascii_case(expected) {
                let check = Checker { file: self.scene };
                let expected = format!("the hash of {}, {found}", path.display());
                return Err(check.invalid(&format!("{field}.sha256"), expected, sha256.unwrap_or_default()));
            }
        }
        Ok(Asset { path, bytes })
    }
}

pub(crate) fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    std::fs::read(path).map_err(|reason| SceneError::Unreadable { file: path.to_owned(), reason })
}

/// The bytes of a file.
pub(crate) struct Asset {
    pub(crate) path: PathBuf,
    bytes: Vec<u8>,
}

impl Asset {
    /// A checked mesh, and what was mended of it.
    pub(crate) fn mesh(&self, weld: bool, drop_degenerate: bool) -> Result<(Mesh, Mended), SceneError> {
        let check = self.check();
        let raw = match self.extension().as_str() {
            "obj" => obj::read(check, &self.bytes),
            "off" => off::read(check, &self.bytes),
            "ply" => ply::read(check, &self.bytes),
            other => Err(check.invalid("extension", "a mesh as .obj, .off or .ply", other)),
        }?;
        let raw = if weld { proper::welded(&raw) } else { raw };
        proper::mesh(check, raw, drop_degenerate)
    }

    /// The meshes of a glTF file.
    pub(crate) fn gltf(&self, wanted: &Wanted, notices: &mut Vec<String>) -> Result<Vec<Part>, SceneError> {
        self.of_gltf(|| gltf::read(self, wanted, notices))
    }

    /// What a glTF file holds besides meshes.
    pub(crate) fn survey(&self) -> Result<Survey, SceneError> {
        self.of_gltf(|| gltf::survey::survey(self))
    }

    fn of_gltf<T>(&self, read: impl FnOnce() -> Result<T, SceneError>) -> Result<T, SceneError> {
        match self.extension().as_str() {
            // The crate's validation lets some enumerations pass that it later unwraps.
            "gltf" | "glb" => catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
                Err(self.check().malformed("glTF", "expected names and numbers that glTF 2.0 knows"))
            }),
            other => Err(self.check().invalid("extension", "a model as .gltf or .glb", other)),
        }
    }

    /// Hash of the file.
    pub(crate) fn content(&self) -> Content {
        Content::of(&self.bytes)
    }

    /// Captured motion.
    pub(crate) fn capture(&self) -> Result<Capture, SceneError> {
        match self.extension().as_str() {
            "bvh" => bvh::read(self.check(), &self.bytes),
            other => Err(self.check().invalid("extension", "captured motion as .bvh", other)),
        }
    }

    /// A picture of radiance. What our own decoders read, they read whether or not OpenImageIO is built in.
    pub(crate) fn image(&self, notices: &mut Vec<String>) -> Result<Image, SceneError> {
        let check = self.check();
        match self.extension().as_str() {
            "exr" => image::read_exr(check, &self.bytes, notices),
            "hdr" => image::read_hdr(check, &self.bytes, notices),
            "png" | "jpg" | "jpeg" => picture::colors(check, "picture", &self.bytes),
            _ => oiio::image(check, notices),
        }
    }

    /// A picture of reflectances; `field` is what asks for it.
    pub(crate) fn texture(&self, field: &str, notices: &mut Vec<String>) -> Result<Texture, SceneError> {
        match picture::knows(&self.bytes) {
            true => picture::texture(self.check(), field, &self.bytes),
            false => picture::reflectances(self.check(), oiio::colors(self.check())?, notices),
        }
    }

    /// A picture of heights.
    pub(crate) fn height_map(&self) -> Result<HeightMap, SceneError> {
        let check = self.check();
        match self.extension().as_str() {
            "exr" => height_map::read_exr(check, &self.bytes),
            "png" => picture::heights(check, &self.bytes),
            _ => oiio::heights(check),
        }
    }

    /// Positions and unit normals.
    pub(crate) fn points(&self) -> Result<Vec<(Vec3, Vec3)>, SceneError> {
        points::parse(self.check(), &self.bytes)
    }

    pub(crate) fn check(&self) -> Checker<'_> {
        Checker { file: &self.path }
    }

    fn extension(&self) -> String {
        self.path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
    }
}
