//! `halflight report`.

use super::{Ending, Out, say};
use anyhow::{Context, ensure};
use clap::Args;
use halflight_reports::Against;
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
        let report = write(&store, &path)?;
        super::pareto::tell(&report, &Against::ALL, None, false, |_| true);
        say(&format!("report: {}", path.display()));
        Ok(Ending::Well)
    }
}

/// Makes the report of a store.
pub(super) fn write(store: &Store, path: &Path) -> anyhow::Result<halflight_reports::Report> {
    let report = halflight_reports::build(store, "Halflight");
    report.warnings.iter().for_each(|warning| eprintln!("halflight: {warning}"));
    std::fs::create_dir_all(store.dir()).with_context(|| store.dir().display().to_string())?;
    report.write(path)?;
    Ok(report)
}
