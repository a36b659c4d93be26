//! Clearing away what no run can use any more.

use crate::Error;
use halflight_references::{Entry, REVISION, ReferenceStore, State};
use std::collections::HashSet;
use std::time::{Duration, SystemTime};

/// Why a file is cleared away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It was made, or begun, by another revision of the program.
    Outdated,
    /// It cannot be read.
    Damaged,
    /// It was begun and broken off, and finished since.
    Finished,
    /// It was left by a process that was killed while it wrote.
    Abandoned,
    /// It is as it should be, and nobody asks for it.
    Unneeded,
}

/// A file that was cleared away, or would be.
pub struct Pruned {
    /// The file.
    pub entry: Entry,
    /// Why.
    pub why: Reason,
}

/// How long a file may be on its way to its place; it takes well below a second.
const ON_ITS_WAY: Duration = Duration::from_secs(600);

/// Clears away what cannot be used any more; with `keep`, what can be used too, but for these keys. What is being made
/// stays. `dry_run` only tells.
///
/// # Errors
/// The store cannot be read, or a file not removed.
pub fn prune(store: &ReferenceStore, keep: Option<&HashSet<String>>, dry_run: bool) -> Result<Vec<Pruned>, Error> {
    let mut pruned = Vec::new();
    for entry in store.entries()? {
        let Some(why) = reason(&entry, store, keep) else { continue };
        if !dry_run {
            std::fs::remove_file(&entry.path).map_err(|source| Error::Io { path: entry.path.clone(), source })?;
        }
        pruned.push(Pruned { entry, why });
    }
    Ok(pruned)
}

fn reason(entry: &Entry, store: &ReferenceStore, keep: Option<&HashSet<String>>) -> Option<Reason> {
    let unneeded = |key: &str| keep.is_some_and(|keep| !keep.contains(key)).then_some(Reason::Unneeded);
    match &entry.state {
        State::Whole(provenance) if provenance.revision != REVISION => Some(Reason::Outdated),
        State::Whole(provenance) => unneeded(&provenance.key),
        State::Begun { in_use: true, .. } => None,
        State::Begun { provenance, .. } if provenance.revision != REVISION => Some(Reason::Outdated),
        State::Begun { provenance, .. } if store.get(&provenance.key).is_some() => Some(Reason::Finished),
        State::Begun { provenance, .. } => unneeded(&provenance.key),
        State::Damaged => Some(Reason::Damaged),
        State::Unplaced => {
            let age = SystemTime::now().duration_since(entry.modified).unwrap_or_default();
            (age > ON_ITS_WAY).then_some(Reason::Abandoned)
        }
    }
}

impl Reason {
    /// In words.
    pub fn told(self) -> &'static str {
        match self {
            Reason::Outdated => "made by another revision",
            Reason::Damaged => "damaged",
            Reason::Finished => "finished since",
            Reason::Abandoned => "abandoned",
            Reason::Unneeded => "not needed",
        }
    }
}
