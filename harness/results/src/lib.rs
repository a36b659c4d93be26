//! What a run leaves behind: records, their keys, the store that holds them, and pictures as EXR.
//!
//! A results directory is
//!
//! ```text
//! DIR/results.jsonl        one JSON object a line, append-only: runs, skips, failures, scores,
//!                          cross-checks
//! DIR/images/<sha256>.exr  pictures and references, named by the hash of their bytes
//! DIR/claims/<key>         cells that are being run now; nothing of a finished run
//! ```
//!
//! Scores are lines of their own, so a picture can be scored again (another reference, a newer metric) without being
//! made again. Images are named by their content, so equal pictures are stored once and a damaged file is noticed.
//!
//! ```no_run
//! # fn main() -> Result<(), halflight_results::StoreError> {
//! use halflight_results::{Record, Store};
//! let store = Store::open("halflight-out")?;
//! for record in store.outcomes() {
//!     if let Record::Run(run) = record {
//!         println!("{} {} {:?}", run.cell.scene, run.cell.method, run.image);
//!     }
//! }
//! # Ok(())
//! # }
//! ```

mod claim;
mod exr;
mod key;
mod leftovers;
mod lines;
mod merge;
mod picture;
mod record;
mod store;

pub use claim::Claim;
pub use key::{Key, KeyError};
pub use merge::Merged;
pub use picture::{Layout, Picture, PictureError, ReferencePicture};
pub use record::{
    CORRECTNESS_ONLY, Calibration, Cell, CrossCheck, Environment, Failure, Measured, Params, Phase, Record,
    ReferenceMade, Run, SCHEMA, Score, Skip, Storage, Times, Timing,
};
pub use store::{Store, StoreError};
