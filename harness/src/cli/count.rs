//! `halflight count`: the work whose instructions the gate counts.

use super::{Ending, say};
use crate::gate::instructions;
use clap::Args;

#[derive(Args)]
pub(super) struct Count {
    /// The method, at its defaults
    #[arg(long)]
    method: String,
}

impl Count {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        say(&instructions::shade(&self.method)?);
        Ok(Ending::Well)
    }
}
