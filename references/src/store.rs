//! Estimates kept on disk by what they depend on.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use halflight_contract::{Cache, Meter};
use halflight_scenes::{Content, Frame, Layout, Scene};

use crate::{Error, Estimate, Quality, REVISION, Reference, Result, estimate, pixels};

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

/// Names an estimate by all that it depends on and nothing else: the reference, the posed objects that cast shadows, the
/// lights, the receivers, the quality, the seed and [`REVISION`]. Neither the scene's name nor its camera counts.
pub fn key(reference: &Reference, scene: &Scene, frame: &Frame, quality: &Quality, seed: u64) -> String {
    let mut parts = vec![
        "reference".to_owned(),
        REVISION.to_owned(),
        reference.id(),
        format!("seed {seed}, receivers {:016x}", frame.receivers.revision.0),
        format!(
            "error {:08x}, samples {} to {}, batches {}",
            quality.standard_error.to_bits(),
            quality.min_samples,
            quality.max_samples,
            quality.batches
        ),
    ];
    for posed in frame.objects.iter().filter(|posed| scene.objects[posed.object].casts) {
        let bits = |values: &[f32]| values.iter().map(|v| format!("{:08x}", v.to_bits())).collect::<String>();
        let (turn, shift) = (posed.pose.rotation.to_array(), posed.pose.translation.to_array());
        parts.push(format!("object {} {} {}", scene.objects[posed.object].content, bits(&turn), bits(&shift)));
    }
    parts.extend(scene.lights.iter().map(|light| format!("light {}", light.content())));
    Content::of_parts(parts.iter().map(String::as_bytes)).to_string()
}

/// The estimate of a reference from the store, or made and kept there; with its key, and whether it was made.
///
/// # Errors
/// As [`estimate()`], or the store cannot be written.
#[allow(clippy::too_many_arguments, reason = "what a reference depends on, and where it goes")]
pub fn obtain(
    store: &ReferenceStore,
    reference: &Reference,
    scene: &Scene,
    frame: &Frame,
    quality: &Quality,
    seed: u64,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<(Estimate, String, bool)> {
    let key = key(reference, scene, frame, quality, seed);
    if let Some(kept) = store.get(&key).filter(|kept| kept.mean.len() == frame.receivers.len()) {
        return Ok((kept, key, false));
    }
    let made = estimate(reference, scene, frame, quality, seed, cache, meter)?;
    let notes = format!(
        "halflight reference {reference} of scene {:?}, frame {}, seed {seed}, {quality:?}, revision {REVISION}, key {key}",
        scene.name.escape_default().to_string(),
        frame.index
    );
    store.put(&key, &made, frame.receivers.layout, &notes)?;
    Ok((made, key, true))
}
