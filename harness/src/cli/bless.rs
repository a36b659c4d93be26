//! `halflight bless`.

use super::gate::{Judged, Measured};
use super::{Ending, say};
use crate::gate::{Baselines, changes};
use anyhow::ensure;
use clap::Args;

#[derive(Args)]
pub(super) struct Bless {
    #[command(flatten)]
    judged: Judged,
}

impl Bless {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let Measured { observed, path, partial } = self.judged.measure()?;
        observed.faults.iter().for_each(|(subject, why)| say(&format!("{subject}: {why}")));
        ensure!(observed.faults.is_empty(), "nothing blessed: expected pictures and references without a fault");
        ensure!(!observed.measured.cells.is_empty(), "nothing blessed: expected at least one cell, found none");
        let old = Baselines::read(&path)?;
        let mut new = observed.measured;
        if let Some(old) = &old {
            new.keep(old, partial);
        }
        let changes = changes(&old.clone().unwrap_or_default(), &new);
        changes.iter().for_each(|line| say(line));
        if old.as_ref() != Some(&new) {
            new.write(&path)?;
        }
        say(&format!("{}: {} cells, {} changes", path.display(), new.cells.len(), changes.len()));
        Ok(Ending::Well)
    }
}
