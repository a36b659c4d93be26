//! Estimates kept on disk by what they depend on.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};

use halflight_contract::{Cache, Flow, Meter};
use halflight_scenes::{Content, Layout};

use crate::estimate::Sampler;
use crate::partial::{Begun, Partial};
use crate::{Achieved, Error, Estimate, Provenance, Request, Result, pixels};

/// A folder of estimates, each a picture `KEY.exr` followed by the SHA-256 of its bytes in hex, which picture readers do not
/// look at. A file that is not whole, or bears another's name, counts as missing. What is being made lies in `KEY.begun`.
#[derive(Clone, Debug)]
pub struct ReferenceStore {
    folder: PathBuf,
}

/// A file of a store.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Where it lies.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// When it was last written.
    pub modified: SystemTime,
    /// What it is.
    pub state: State,
}

/// What there is of an estimate.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// All of it.
    Whole(Provenance),
    /// Some receivers, of an estimate that is being made or was broken off.
    Begun {
        /// What is being made.
        provenance: Provenance,
        /// Receivers that are done.
        done: usize,
        /// Whether someone works on it now.
        in_use: bool,
    },
    /// A file that cannot be used.
    Damaged,
    /// A file on its way to its place, or left by one who was killed just then.
    Unplaced,
}

/// Hex digits at the end of a file.
const CHECKSUM: usize = 64;

const WHOLE: &str = "exr";
const BEGUN: &str = "begun";
/// What the extension of a file that is on its way begins with.
const UNPLACED: &str = "partial-";

impl ReferenceStore {
    /// The store in a folder, which is made if there is none.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn open(folder: impl Into<PathBuf>) -> Result<Self> {
        let store = ReferenceStore::at(folder);
        fs::create_dir_all(&store.folder).map_err(|error| failure(&store.folder, error))?;
        Ok(store)
    }

    /// The store in a folder for reading: without the folder it is empty.
    pub fn at(folder: impl Into<PathBuf>) -> Self {
        ReferenceStore { folder: folder.into() }
    }

    /// Where the estimate of a key lies, if it is there.
    pub fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{key}.{WHOLE}"))
    }

    /// The estimate of a key; `None` if it is missing or damaged.
    pub fn get(&self, key: &str) -> Option<Estimate> {
        Some(self.get_with_provenance(key)?.0)
    }

    /// The estimate of a key and where it comes from; `None` if it is missing or damaged.
    pub fn get_with_provenance(&self, key: &str) -> Option<(Estimate, Provenance)> {
        read(&self.path(key), key)
    }

    /// What there is of an estimate; `None` if nothing is there.
    pub fn state(&self, key: &str) -> Option<State> {
        [WHOLE, BEGUN].iter().find_map(|extension| {
            let path = self.folder.join(format!("{key}.{extension}"));
            path.exists().then(|| state(&path))?
        })
    }

    /// Every file of the store, sorted by path. Files that no store makes are not listed.
    ///
    /// # Errors
    /// The folder is there and cannot be read.
    pub fn entries(&self) -> Result<Vec<Entry>> {
        let files = match fs::read_dir(&self.folder) {
            Ok(files) => files,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(failure(&self.folder, error)),
        };
        let mut paths: Vec<PathBuf> = files.filter_map(|file| Some(file.ok()?.path())).collect();
        paths.sort();
        Ok(paths.into_iter().filter_map(Entry::of).collect())
    }

    /// Keeps an estimate under its provenance's key, laid out as its frame's receivers. A reader sees all of it or nothing.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn put(&self, estimate: &Estimate, layout: Layout, provenance: &Provenance) -> Result<()> {
        static WRITES: AtomicU64 = AtomicU64::new(0);
        let key = &provenance.key;
        let path = self.path(key);
        let mut bytes = pixels::encode(estimate, layout, provenance).map_err(|error| failure(&path, error))?;
        let checksum = Content::of(&bytes).to_string();
        bytes.extend_from_slice(checksum.as_bytes());
        let write = WRITES.fetch_add(1, Ordering::Relaxed);
        let unplaced = self.folder.join(format!("{key}.{UNPLACED}{}-{write}", std::process::id()));
        fs::write(&unplaced, bytes).and_then(|()| fs::rename(&unplaced, &path)).map_err(|error| {
            let _ = fs::remove_file(&unplaced);
            failure(&path, error)
        })
    }

    /// The file of an estimate that is being made, locked; waits while someone else works on it.
    fn lock(&self, key: &str, meter: &mut dyn Meter) -> Result<Partial> {
        let path = self.folder.join(format!("{key}.{BEGUN}"));
        loop {
            if let Some(partial) = Partial::lock(path.clone()).map_err(|error| failure(&path, error))? {
                return Ok(partial);
            }
            if meter.progress("made by another process", 0, 1) == Flow::Cancel {
                return Err(Error::Contract(halflight_contract::Error::Cancelled));
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    }
}

impl Entry {
    /// A file as the store sees it; `None` if it is none of the store's.
    fn of(path: PathBuf) -> Option<Self> {
        let about = path.metadata().ok()?;
        let state = state(&path)?;
        Some(Entry { bytes: about.len(), modified: about.modified().ok()?, path, state })
    }
}

fn state(path: &Path) -> Option<State> {
    let key = path.file_stem()?.to_str()?;
    match path.extension()?.to_str()? {
        WHOLE => Some(read(path, key).map_or(State::Damaged, |(_, provenance)| State::Whole(provenance))),
        BEGUN => {
            // A lock that was free is let go at once.
            let in_use = matches!(Partial::lock(path.to_owned()), Ok(None));
            let begun = fs::read(path).ok().and_then(|bytes| Begun::read(&bytes)).filter(|b| b.provenance.key == key);
            Some(match begun {
                Some(Begun { provenance, done }) => State::Begun { provenance, done, in_use },
                // Its first words are being written.
                None if in_use => State::Unplaced,
                None => State::Damaged,
            })
        }
        extension => extension.starts_with(UNPLACED).then_some(State::Unplaced),
    }
}

fn read(path: &Path, key: &str) -> Option<(Estimate, Provenance)> {
    let file = fs::read(path).ok()?;
    let (picture, checksum) = file.split_at_checked(file.len().checked_sub(CHECKSUM)?)?;
    let whole = Content::of(picture).to_string().as_bytes() == checksum;
    whole.then(|| pixels::decode(picture))?.filter(|(_, provenance)| provenance.key == key)
}

fn failure(path: &Path, error: impl std::fmt::Display) -> Error {
    Error::Store { path: path.to_owned(), message: error.to_string() }
}

/// The estimate that answers a request from the store, or made and kept there; with its key, and whether it was made. One that
/// was begun and broken off goes on where it stopped, to the same bits; one that another process is making is waited for.
///
/// # Errors
/// As [`crate::estimate()`], or the store cannot be written.
pub fn obtain(
    store: &ReferenceStore,
    request: &Request<'_>,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<(Estimate, String, bool)> {
    let frame = request.frame;
    let mut provenance = Provenance::of(request);
    let key = provenance.key.clone();
    let kept = || store.get(&key).filter(|kept| kept.mean.len() == frame.receivers.len());
    if let Some(kept) = kept() {
        return Ok((kept, key, false));
    }
    // First, so that what cannot be made leaves no file.
    let sampler = Sampler::new(request, cache, meter)?;
    let mut partial = store.lock(&key, meter)?;
    if let Some(kept) = kept() {
        partial.remove();
        return Ok((kept, key, false));
    }
    let begun = partial.resume(&provenance).map_err(|error| failure(partial.path(), error))?;
    let mut keep = |estimate: &Estimate, first: usize| {
        partial.keep(estimate, first).map_err(|error| failure(partial.path(), error))
    };
    let made = sampler.all(frame, begun, &mut keep, meter)?;
    provenance.achieved = Some(Achieved::of(&made, frame, request.quality, sampler.level));
    store.put(&made, frame.receivers.layout, &provenance)?;
    partial.remove();
    Ok((made, key, true))
}
