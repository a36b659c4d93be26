//! `halflight merge`.

use super::{Ending, Out, say};
use anyhow::ensure;
use clap::Args;
use halflight_results::Store;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Merge {
    /// Results directories to take from. Where several know a cell, a run beats a failure and a failure a skip; of equals
    /// what DIR has stays, then the one named first
    #[arg(required = true, value_name = "FROM")]
    from: Vec<PathBuf>,
    #[command(flatten)]
    out: Out,
}

impl Merge {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let mut sources = Vec::new();
        for dir in &self.from {
            let source = Store::open(dir)?;
            ensure!(source.path().exists(), "{}: expected the results of a run", source.path().display());
            sources.push(source);
        }
        let mut store = Store::open(&self.out.out)?;
        let mut told = 0;
        let mut changed = false;
        for source in &sources {
            let merged = store.merge(source)?;
            changed |= merged.cells + merged.times + merged.scores + merged.images > 0;
            let from = source.dir().display();
            for warning in source.warnings().iter().chain(&merged.conflicts).chain(&merged.missing) {
                eprintln!("halflight: {from}: {warning}");
            }
            told += merged.conflicts.len() + merged.missing.len();
            say(&format!("{from}: {} cells, {} scores, {} images", merged.cells, merged.scores, merged.images));
        }
        let report = self.out.out.join("report.html");
        if changed || !report.exists() {
            super::report::write(&store, &report)?;
        }
        say(&format!("report: {}", report.display()));
        Ok(if told > 0 { Ending::Differs } else { Ending::Well })
    }
}
