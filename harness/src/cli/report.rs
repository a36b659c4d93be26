//! `halflight report`.

use super::{Ending, Out, say};
use anyhow::{Context, ensure};
use clap::Args;
use halflight_results::Store;
use std::path::Path;

#[derive(Args)]
pub(super) struct Report {
    #[command(flatten)]
    out: Out,
}

impl Report {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let store = Store::open(&self.out.out)?;
        ensure!(store.path().exists(), "{}: expected the results of a run", store.path().display());
        let path = self.out.out.join("report.html");
        write(&store, &path)?;
        say(&format!("report: {}", path.display()));
        Ok(Ending::Well)
    }
}

/// Makes the report of a store.
pub(super) fn write(store: &Store, path: &Path) -> anyhow::Result<()> {
    let report = halflight_reports::build(store, "Halflight");
    report.warnings.iter().for_each(|warning| eprintln!("halflight: {warning}"));
    std::fs::create_dir_all(store.dir()).with_context(|| store.dir().display().to_string())?;
    Ok(report.write(path)?)
}
