//! `halflight score`.

use super::{Ending, Out, say};
use anyhow::ensure;
use clap::Args;
use halflight_results::Store;

#[derive(Args)]
pub(super) struct Score {
    #[command(flatten)]
    out: Out,
}

impl Score {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let mut store = Store::open(&self.out.out)?;
        ensure!(store.path().exists(), "{}: expected the results of a run", store.path().display());
        let rescored = crate::rescore(&mut store)?;
        rescored.failed.iter().for_each(|failed| eprintln!("halflight: {failed}"));
        let (added, present, failed) = (rescored.added, rescored.present, rescored.failed.len());
        say(&format!("{added} scores added, {present} present, {failed} failed"));
        if added > 0 {
            super::report::write(&store, &self.out.out.join("report.html"))?;
        }
        Ok(if failed > 0 { Ending::Differs } else { Ending::Well })
    }
}
