//! `halflight figure`.

use super::{CacheDir, Ending, HowGood, say};
use crate::figures::{chosen, figures};
use crate::ledger::Terms;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Figure {
    /// Ids such as shexp/fig7, or shexp/* for all of a paper; a list of all if not given
    ids: Vec<String>,
    /// Where pages go: DIR/ID/index.html
    #[arg(long, value_name = "DIR", default_value = "halflight-out/figures")]
    out: PathBuf,
    /// Rounds of every timing
    #[arg(long, value_name = "N", default_value_t = 7)]
    rounds: usize,
    #[command(flatten)]
    how_good: HowGood,
    #[command(flatten)]
    cache: CacheDir,
}

impl Figure {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        if self.ids.is_empty() {
            figures().for_each(|figure| say(&format!("{:16} {:32} {}", figure.id, figure.place, figure.shows)));
            return Ok(Ending::Well);
        }
        anyhow::ensure!(self.rounds > 0, "--rounds 0: expected at least 1");
        let figures = chosen(&self.ids)?;
        let terms = Terms { cache: self.cache.path()?, quality: self.how_good.quality()?, rounds: self.rounds };
        for figure in figures {
            say(&figure.make(&terms, &self.out)?.display().to_string());
        }
        Ok(Ending::Well)
    }
}
