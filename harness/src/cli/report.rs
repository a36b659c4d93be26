//! `halflight report`.

use super::{Ending, Out, say};
use anyhow::{Context, ensure};
use clap::Args;
use halflight_reports::{Against, Benchmark, read_criterion};
use halflight_results::Store;
use std::path::{Path, PathBuf};

/// Where criterion leaves its results.
const CRITERION: &str = "target/criterion";

#[derive(Args)]
pub(super) struct Report {
    #[command(flatten)]
    out: Out,
    /// Folder of criterion's results, to be shown too; target/criterion, where it is there, if not given
    #[arg(long, value_name = "DIR")]
    criterion: Option<PathBuf>,
}

impl Report {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let store = Store::open(&self.out.out)?;
        ensure!(store.path().exists(), "{}: expected the results of a run", store.path().display());
        let path = self.out.out.join("report.html");
        let report = match &self.criterion {
            Some(folder) => write_with(&store, read_criterion(folder)?, Vec::new(), &path)?,
            None => write(&store, &path)?,
        };
        super::pareto::tell(&report, &Against::ALL, None, false, |_| true);
        say(&format!("report: {}", path.display()));
        Ok(Ending::Well)
    }
}

/// Makes the report of a store, with what `cargo bench` measured where that is to be found.
pub(super) fn write(store: &Store, path: &Path) -> anyhow::Result<halflight_reports::Report> {
    let folder = Path::new(CRITERION);
    match read_criterion(folder) {
        Ok(benchmarks) => write_with(store, benchmarks, Vec::new(), path),
        // Nobody asked for it.
        Err(error) => {
            write_with(store, Vec::new(), folder.exists().then(|| error.to_string()).into_iter().collect(), path)
        }
    }
}

fn write_with(
    store: &Store,
    benchmarks: Vec<Benchmark>,
    warnings: Vec<String>,
    path: &Path,
) -> anyhow::Result<halflight_reports::Report> {
    let mut report = halflight_reports::build(store, "Halflight");
    report.scalings = crate::scaling::of(store);
    report.rates = crate::rates::of(store);
    report.benchmarks = benchmarks;
    report.warnings.extend(warnings);
    report.warnings.iter().for_each(|warning| eprintln!("halflight: {warning}"));
    std::fs::create_dir_all(store.dir()).with_context(|| store.dir().display().to_string())?;
    report.write(path)?;
    Ok(report)
}
