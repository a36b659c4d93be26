//! `halflight refs prune`.

use super::super::{CacheDir, Ending, HowGood, say};
use crate::plan::{Plan, Terms};
use crate::refs::{needed, prune, store};
use crate::suite::Suite;
use clap::Args;
use std::collections::HashSet;

#[derive(Args)]
pub(super) struct Prune {
    /// Clear away what could be used, too, but for what --suite needs
    #[arg(long)]
    all: bool,
    /// With --all, keep what this suite needs, repeatable: a shipped one's name, or the path of a TOML file
    #[arg(long, requires = "all")]
    suite: Vec<String>,
    /// Say what would be cleared away, and leave it
    #[arg(long)]
    dry_run: bool,
    /// Seed of the references that --suite needs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    how_good: HowGood,
    #[command(flatten)]
    cache: CacheDir,
}

impl Prune {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let keep = if self.all { Some(self.needed()?) } else { None };
        let pruned = prune(&store(&self.cache.path()?), keep.as_ref(), self.dry_run)?;
        for p in &pruned {
            let name = p.entry.path.file_name().unwrap_or_default().to_string_lossy();
            say(&format!("{name}: {}, {}", p.why.told(), size(p.entry.bytes)));
        }
        let bytes = pruned.iter().map(|p| p.entry.bytes).sum();
        let done = if self.dry_run { "would be cleared away" } else { "cleared away" };
        say(&format!("{} files, {} {done}", pruned.len(), size(bytes)));
        Ok(Ending::Well)
    }

    /// Keys of what the suites need.
    fn needed(&self) -> anyhow::Result<HashSet<String>> {
        let quality = self.how_good.quality()?;
        let mut keys = HashSet::new();
        for suite in &self.suite {
            let terms = Terms { seed: self.seed, timed_on: String::new() };
            let plan = Plan::new(&Suite::find(suite)?.entries, &terms)?;
            keys.extend(needed(&plan, &quality, false).iter().map(|need| need.request().key()));
        }
        Ok(keys)
    }
}

/// Bytes for people.
pub(super) fn size(bytes: u64) -> String {
    match bytes {
        0..10_000 => format!("{bytes} B"),
        10_000..10_000_000 => format!("{:.0} kB", bytes as f64 / 1e3),
        _ => format!("{:.0} MB", bytes as f64 / 1e6),
    }
}
