//! Estimates kept on disk by what they depend on.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use halflight_contract::{Cache, Meter};
use halflight_scenes::{Content, Layout};

use crate::estimate::estimate_onwards;
use crate::partial::Partial;
use crate::{Error, Estimate, REVISION, Request, Result, pixels};

/// A folder of estimates, each a picture `KEY.exr` followed by the SHA-256 of its bytes in hex, which picture readers do not
/// look at. A file that is not whole counts as missing.
#[derive(Clone, Debug)]
pub struct ReferenceStore {
    folder: PathBuf,
}

/// Hex digits at the end of a file.
const CHECKSUM: usize = 64;

impl ReferenceStore {
    /// The store in a folder, which is made if there is none.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn open(folder: impl Into<PathBuf>) -> Result<Self> {
        let folder = folder.into();
        fs::create_dir_all(&folder).map_err(|error| failure(&folder, error))?;
        Ok(ReferenceStore { folder })
    }

    /// Where the estimate of a key lies, if it is there.
    pub fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{key}.exr"))
    }

    /// The estimate of a key; `None` if it is missing or damaged.
    pub fn get(&self, key: &str) -> Option<Estimate> {
        let file = fs::read(self.path(key)).ok()?;
        let (picture, checksum) = file.split_at_checked(file.len().checked_sub(CHECKSUM)?)?;
        (Content::of(picture).to_string().as_bytes() == checksum).then(|| pixels::decode(picture))?
    }

    /// Keeps an estimate, laid out as its frame's receivers, with notes on its making (ASCII). A reader sees all of it or
    /// nothing.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn put(&self, key: &str, estimate: &Estimate, layout: Layout, notes: &str) -> Result<()> {
        static WRITES: AtomicU64 = AtomicU64::new(0);
        let path = self.path(key);
        let mut bytes = pixels::encode(estimate, layout, notes).map_err(|error| failure(&path, error))?;
        let checksum = Content::of(&bytes).to_string();
        bytes.extend_from_slice(checksum.as_bytes());
        let write = WRITES.fetch_add(1, Ordering::Relaxed);
        let partial = self.folder.join(format!("{key}.partial-{}-{write}", std::process::id()));
        fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, &path)).map_err(|error| {
            let _ = fs::remove_file(&partial);
            failure(&path, error)
        })
    }
}

fn failure(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::Store { path: path.to_owned(), message: error.to_string() }
}

/// The estimate that answers a request from the store, or made and kept there; with its key, and whether it was made. One that
/// was begun and broken off goes on where it stopped, to the same bits.
///
/// # Errors
/// As [`crate::estimate()`], or the store cannot be written.
pub fn obtain(
    store: &ReferenceStore,
    request: &Request<'_>,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<(Estimate, String, bool)> {
    let key = request.key();
    if let Some(kept) = store.get(&key).filter(|kept| kept.mean.len() == request.frame.receivers.len()) {
        return Ok((kept, key, false));
    }
    let mut partial = Partial::at(store.folder.join(format!("{key}.begun")));
    let begun = partial.resume();
    let mut keep = |estimate: &Estimate, first: usize| {
        partial.keep(estimate, first).map_err(|error| failure(partial.path(), error))
    };
    let made = estimate_onwards(request, begun, &mut keep, cache, meter)?;
    let notes = format!(
        "halflight reference {} of {}, scene {:?}, frame {}, seed {}, {:?}, revision {REVISION}, key {key}",
        request.reference,
        request.quantity,
        request.scene.name.escape_default().to_string(),
        request.frame.index,
        request.seed,
        request.quality,
    );
    store.put(&key, &made, request.frame.receivers.layout, &notes.escape_default().to_string())?;
    partial.remove();
    Ok((made, key, true))
}
