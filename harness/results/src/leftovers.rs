//! What killed writers leave behind, swept by whoever opens the store.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What is younger may be in use: a file on its way to its place, or a claim between its making and its lock.
const OLD: Duration = Duration::from_secs(600);

/// Removes files that were on their way to their place, and claims that nobody holds, once they are old. What cannot be
/// removed, as in a directory that is only to be read, does no harm and stays.
pub(crate) fn sweep(dir: &Path) {
    let unplaced = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "tmp");
    for path in [dir.join("images"), dir.to_owned()].iter().flat_map(|folder| old(folder)).filter(unplaced) {
        let _ = fs::remove_file(path);
    }
    let claims = dir.join("claims");
    for path in old(&claims) {
        let unheld = File::open(&path).and_then(|file| file.try_lock().map(|()| file).map_err(Into::into));
        if unheld.is_ok() {
            let _ = fs::remove_file(path);
        }
    }
    // Only what is empty goes.
    let _ = fs::remove_dir(claims);
}

/// The old files of a folder.
fn old(folder: &Path) -> Vec<PathBuf> {
    let is_old = |path: &PathBuf| {
        let age = path.metadata().ok().filter(|m| m.is_file())?.modified().ok()?.elapsed().ok()?;
        (age > OLD).then_some(())
    };
    let files = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    files.filter(|path| is_old(path).is_some()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Key, Store};
    use std::time::SystemTime;

    fn aged(path: &Path) {
        let file = File::options().append(true).create(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - 2 * OLD).unwrap();
    }

    #[test]
    fn opening_sweeps_what_is_old_and_nobodys() {
        let dir = tempfile::tempdir().unwrap();
        let path = |name: &str| dir.path().join(name);
        fs::create_dir(path("images")).unwrap();
        let store = Store::open(dir.path()).unwrap();
        let (held, left) = (Key::of_bytes(b"held"), Key::of_bytes(b"left"));
        let claim = store.claim(&held).unwrap();
        let [held, left] = [held, left].map(|key| path("claims").join(key.as_str()));
        let gone = [path("images/.abc-1-0.tmp"), path("report.77.tmp"), left];
        let kept = [path("images/abc.exr"), path("notes.txt"), held];
        gone.iter().chain(&kept).for_each(|path| aged(path));
        fs::write(path("images/.def-2-0.tmp"), "on its way").unwrap();
        Store::open(dir.path()).unwrap();
        assert!(gone.iter().all(|path| !path.exists()));
        assert!(kept.iter().all(|path| path.exists()) && path("images/.def-2-0.tmp").exists());
        drop(claim);
        assert!(!path("claims").exists());
    }

    #[test]
    fn a_folder_of_old_claims_goes_with_them() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir(dir.path().join("claims")).unwrap();
        aged(&dir.path().join("claims").join("x"));
        Store::open(dir.path()).unwrap();
        assert!(!dir.path().join("claims").exists());
        // What is not there is not made.
        sweep(&dir.path().join("nowhere"));
        assert!(!dir.path().join("nowhere").exists());
    }
}
