//! `halflight refs build`.

use super::super::{Ending, say};
use super::Wanted;
use clap::Args;

#[derive(Args)]
pub(super) struct Build {
    #[command(flatten)]
    wanted: Wanted,
}

impl Build {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let planned = self.wanted.plan()?;
        let built = crate::refs::build(&planned.needs(), &planned.cache, true)?;
        say(&format!("{} references made, {} were there, {} failed", built.made, built.there, built.failed));
        Ok(if built.failed > 0 { Ending::Differs } else { Ending::Well })
    }
}
