//! Making references.

use super::Need;
use crate::Error;
use crate::execute::guarded;
use crate::progress::Progress;
use crate::recorder::Recorder;
use halflight_contract::Cache;
use halflight_references::{ReferenceStore, obtain};
use std::path::Path;

/// What came of making references.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Built {
    /// Those that were made, or begun before and finished.
    pub made: usize,
    /// Those that were there.
    pub there: usize,
    /// Those that could not be made.
    pub failed: usize,
}

/// Makes what is missing or damaged. What fails is told on standard error, and the rest goes on. After a kill the next call
/// goes on where this one stopped.
///
/// # Errors
/// The store cannot be made.
pub fn build(needs: &[Need<'_>], cache: &Path, show_progress: bool) -> Result<Built, Error> {
    let store = ReferenceStore::open(cache.join("references"))?;
    let mut progress = if show_progress { Progress::new(needs.len()) } else { Progress::silent() };
    let mut built = Built::default();
    // Derived data are of one scene alone: they are let go with it.
    for needs in needs.chunk_by(|a, b| std::ptr::eq(a.stage, b.stage)) {
        let derived = Cache::in_folder(&cache.join("derived"));
        for need in needs {
            let label = need.label();
            progress.begin(&label);
            let mut steps = |what: &str, done, total| progress.within(&label, what, done, total);
            let mut meter = Recorder::new(&mut steps);
            let made = guarded(|| obtain(&store, &need.request(), &derived, &mut meter).map_err(|e| e.to_string()));
            let (count, outcome) = match made {
                Ok((.., true)) => (&mut built.made, "made".to_owned()),
                Ok((.., false)) => (&mut built.there, "there".to_owned()),
                Err(error) => (&mut built.failed, format!("FAILED: {error}")),
            };
            *count += 1;
            progress.end(&label, &outcome);
        }
    }
    Ok(built)
}
