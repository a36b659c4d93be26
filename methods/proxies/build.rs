//! Gives the crate its source revision, so that cached sphere sets end with the code that made them.

use std::path::Path;

fn main() -> Result<(), halflight_revision::RevisionError> {
    halflight_revision::emit("HALFLIGHT_PROXIES_REVISION", Path::new(env!("CARGO_MANIFEST_DIR")))
}
