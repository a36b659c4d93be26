//! `halflight export --csv`, `--parquet`.

use super::{Ending, say};
use anyhow::{Context, ensure};
use clap::Args;
use halflight_results::Store;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(super) struct Table {
    /// Write the results as comma-separated values, a row a cell and reference; `list columns` tells what the columns mean
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// The same as Parquet
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,
}

impl Table {
    /// Writes the results in a directory.
    pub(super) fn write(&self, dir: Option<&Path>) -> anyhow::Result<Ending> {
        let store = Store::open(dir.unwrap_or(Path::new("halflight-out")))?;
        ensure!(store.path().exists(), "{}: expected the results of a run", store.path().display());
        let table = crate::Table::of(&store);
        if let Some(file) = &self.csv {
            put(file, table.csv().as_bytes(), table.rows)?;
        }
        if let Some(file) = &self.parquet {
            put(file, &parquet(&table)?, table.rows)?;
        }
        Ok(Ending::Well)
    }
}

#[cfg(feature = "parquet")]
fn parquet(table: &crate::Table) -> anyhow::Result<Vec<u8>> {
    table.parquet().context("encoding Parquet")
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: &crate::Table) -> anyhow::Result<Vec<u8>> {
    anyhow::bail!("--parquet: this build was made without the feature `parquet`, expected one with it")
}

/// Beside its place first, so that an older file is replaced whole or not at all.
fn put(file: &Path, bytes: &[u8], rows: usize) -> anyhow::Result<()> {
    let beside = file.with_added_extension(format!("{}.tmp", std::process::id()));
    let put = std::fs::write(&beside, bytes).and_then(|()| std::fs::rename(&beside, file));
    put.inspect_err(|_| drop(std::fs::remove_file(&beside))).with_context(|| file.display().to_string())?;
    say(&format!("{rows} rows: {}", file.display()));
    Ok(())
}
