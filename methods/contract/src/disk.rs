//! Cache files: a header with the build time and a checksum, then the value's bytes.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use halflight_scenes::Content;

use crate::{BuildTime, Error, Result};

const MAGIC: &[u8; 8] = b"halfl-1\n";
const HEADER: usize = 24;

/// The build time and bytes of a cache file; `None` if there is no such file or it is not whole.
pub(crate) fn read(path: &Path) -> Option<(BuildTime, Vec<u8>)> {
    let file = fs::read(path).ok()?;
    let (header, bytes) = file.split_at_checked(HEADER)?;
    let word = |at: usize| u64::from_le_bytes(header[at..at + 8].try_into().expect("eight bytes"));
    (&header[..8] == MAGIC && word(16) == Content::of(bytes).revision().0).then(|| (BuildTime(word(8)), bytes.to_vec()))
}

/// Writes a cache file so that a reader sees all of it or nothing.
pub(crate) fn write(path: &Path, time: BuildTime, bytes: &[u8]) -> Result<()> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let fail = |source| Error::Cache { path: path.display().to_string(), source };
    let mut file = Vec::with_capacity(HEADER + bytes.len());
    file.extend_from_slice(MAGIC);
    file.extend_from_slice(&time.0.to_le_bytes());
    file.extend_from_slice(&Content::of(bytes).revision().0.to_le_bytes());
    file.extend_from_slice(bytes);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(fail)?;
    }
    // Two threads may write the same file at once: each needs a partial file of its own.
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let partial = path.with_extension(format!("partial-{}-{count}", std::process::id()));
    fs::write(&partial, file).map_err(fail)?;
    fs::rename(&partial, path).map_err(fail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_whole_is_not_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("deep").join("value");
        assert_eq!(read(&path), None);
        write(&path, BuildTime(12), b"some bytes").expect("writes");
        assert_eq!(read(&path), Some((BuildTime(12), b"some bytes".to_vec())));
        let whole = fs::read(&path).expect("reads");
        let spoiled = |at: usize| {
            let mut file = whole.clone();
            file[at] ^= 1;
            file
        };
        let [other_magic, other_checksum, other_bytes] = [0, 16, HEADER].map(spoiled);
        for file in
            [other_magic, other_checksum, other_bytes, whole[..HEADER].to_vec(), whole[..5].to_vec(), Vec::new()]
        {
            fs::write(&path, file).expect("writes");
            assert_eq!(read(&path), None);
        }
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        fs::write(&file, b"").expect("writes");
        let error = write(&file.join("value"), BuildTime(0), b"").expect_err("a file is no folder");
        assert!(error.to_string().contains("value"), "{error}");
    }
}
