//! Writes `docs/stress.md` with its plots: `cargo run --release -p halflight-tests --example stress`.

use std::error::Error;
use std::path::Path;

use halflight_tests::stress;

fn main() -> Result<(), Box<dyn Error>> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let found = stress::measure(&stress::sphere_blockers(halflight_registry::methods()));
    std::fs::create_dir_all(docs.join("stress"))?;
    std::fs::write(docs.join("stress.md"), stress::markdown(&found))?;
    std::fs::write(docs.join("stress/onset.svg"), stress::onsets(&found)?)?;
    std::fs::write(docs.join("stress/irradiance.svg"), stress::irradiance(&found)?)?;
    Ok(())
}
