//! Writing a scene's folder: whole or not at all.

use std::path::{Component, Path, PathBuf};

use crate::SceneError;
use crate::check::Checker;

/// Files that belong into a scene's folder, by their path in it.
#[derive(Default)]
pub(super) struct Copies(Vec<(PathBuf, PathBuf)>);

impl Copies {
    /// Adds a file; the same file may come twice, another under the same path may not.
    pub(super) fn add(&mut self, from: &Path, to: &str) -> Result<(), SceneError> {
        let check = Checker { file: from };
        let to: PathBuf = Path::new(to).components().filter(|part| !matches!(part, Component::CurDir)).collect();
        let inside = to.components().all(|part| matches!(part, Component::Normal(_)));
        check.ensure(inside, "name", "a path below the file that names it, without `..`", &to)?;
        match self.0.iter().find(|(_, other)| *other == to) {
            Some((other, _)) if other == from => {}
            Some((other, _)) => return Err(check.invalid("name", "names that differ", other.display())),
            None => self.0.push((from.to_owned(), to)),
        }
        Ok(())
    }

    fn write(&self, folder: &Path) -> Result<(), SceneError> {
        for (from, to) in &self.0 {
            let to = folder.join(to);
            make(to.parent().unwrap_or(folder))?;
            std::fs::copy(from, &to).map_err(|reason| unwritten(&to, reason))?;
        }
        Ok(())
    }
}

/// A folder beside the one that is wanted, which takes its place in the end and is cleared away otherwise.
pub(super) struct Staging {
    pub(super) folder: PathBuf,
    out: PathBuf,
}

impl Staging {
    /// Refuses a folder that is there already, if it is not to be written into.
    pub(super) fn new(out: &Path, force: bool) -> Result<Self, SceneError> {
        let check = Checker { file: out };
        let free = !out.exists() || (force && out.is_dir());
        check.ensure(
            free,
            "--out",
            "a folder that is not there yet (--force writes into one that is)",
            "one that is",
        )?;
        let name = out.file_name().ok_or_else(|| check.invalid("--out", "a folder with a name", out))?;
        let staging = format!(".{}.{}", name.to_string_lossy(), std::process::id());
        let folder = out.with_file_name(staging);
        make(&folder)?;
        Ok(Staging { folder, out: out.to_owned() })
    }

    pub(super) fn fill(&self, copies: &Copies, scene: &str, text: &str) -> Result<(), SceneError> {
        copies.write(&self.folder)?;
        let path = self.folder.join(scene);
        std::fs::write(&path, text).map_err(|reason| unwritten(&path, reason))
    }

    /// Moves everything to where it belongs.
    pub(super) fn finish(self, copies: &Copies, scene: &str) -> Result<(), SceneError> {
        let moved = |from: &Path, to: &Path| std::fs::rename(from, to).map_err(|reason| unwritten(to, reason));
        if !self.out.exists() {
            return moved(&self.folder, &self.out);
        }
        for file in copies.0.iter().map(|(_, to)| to.as_path()).chain([Path::new(scene)]) {
            let to = self.out.join(file);
            make(to.parent().unwrap_or(&self.out))?;
            moved(&self.folder.join(file), &to)?;
        }
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn make(folder: &Path) -> Result<(), SceneError> {
    std::fs::create_dir_all(folder).map_err(|reason| unwritten(folder, reason))
}

fn unwritten(file: &Path, reason: std::io::Error) -> SceneError {
    SceneError::Unwritable { file: file.to_owned(), reason }
}
