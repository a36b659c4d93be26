//! `halflight ledger`.

use super::{CacheDir, Ending, HowGood, say};
use crate::ledger::{Terms, chosen, measure, page};
use anyhow::Context;
use clap::{Args, Subcommand};
use halflight_results::Store;
use std::path::PathBuf;

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(super) struct Ledger {
    #[command(subcommand)]
    what: Option<What>,
    /// Where the page is written
    #[arg(long, value_name = "FILE", default_value = "reports/ledger.md")]
    out: PathBuf,
    /// Write nothing; exit with 1 if the page is not what the figures say
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    figures: Figures,
}

#[derive(Subcommand)]
enum What {
    /// Take the figures of rows and add them to the store
    Measure(Measure),
}

/// Where figures are kept.
#[derive(Args)]
struct Figures {
    /// Results directory that holds the figures
    #[arg(long, value_name = "DIR", default_value = "reports/ledger")]
    figures: PathBuf,
}

#[derive(Args)]
struct Measure {
    /// Rows, such as S1 S4; all if not given
    rows: Vec<String>,
    /// Rounds of every timing
    #[arg(long, value_name = "N", default_value_t = 7)]
    rounds: usize,
    #[command(flatten)]
    figures: Figures,
    #[command(flatten)]
    how_good: HowGood,
    #[command(flatten)]
    cache: CacheDir,
}

impl Ledger {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        if let Some(What::Measure(measure)) = &self.what {
            return measure.act();
        }
        let text = page(&Store::open(&self.figures.figures)?);
        let path = self.out.display();
        if !self.check {
            if let Some(folder) = self.out.parent() {
                std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
            }
            std::fs::write(&self.out, text).with_context(|| path.to_string())?;
            say(&path.to_string());
            return Ok(Ending::Well);
        }
        let stored = std::fs::read_to_string(&self.out).with_context(|| path.to_string())?;
        if stored == text {
            return Ok(Ending::Well);
        }
        say(&format!("{path} is not what {} says; `halflight ledger` writes it", self.figures.figures.display()));
        Ok(Ending::Differs)
    }
}

impl Measure {
    /// A row that cannot be measured is told of in a line; of rows that were named that is an error.
    fn act(&self) -> anyhow::Result<Ending> {
        anyhow::ensure!(self.rounds > 0, "--rounds 0: expected at least 1");
        let rows = chosen(&self.rows)?;
        let terms = Terms { cache: self.cache.path()?, quality: self.how_good.quality()?, rounds: self.rounds };
        let mut store = Store::open(&self.figures.figures)?;
        for row in rows {
            match measure(row, &terms, &mut store) {
                Ok(count) => say(&format!("{}: {count} figures", row.id)),
                Err(error) if self.rows.is_empty() && !row.needs.is_empty() => say(&format!("{}: {error}", row.id)),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(Ending::Well)
    }
}
