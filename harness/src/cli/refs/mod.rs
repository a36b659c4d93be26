//! `halflight refs`.

mod build;
mod check;
mod list;
mod prune;

use super::{CacheDir, Ending, HowGood, Pick};
use crate::plan::{Plan, Terms};
use crate::refs::{Need, needed};
use clap::{Args, Subcommand};
use halflight_references::Quality;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Refs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// Make the references that a suite or selection needs; goes on with those that were broken off
    Build(build::Build),
    /// Say what there is of the references that a suite or selection needs; one that is not there is an error
    Check(check::Check),
    /// List what is kept, and where it comes from
    List(list::List),
    /// Clear away what no run can use any more
    Prune(prune::Prune),
}

impl Refs {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        match &self.action {
            Action::Build(build) => build.act(),
            Action::Check(check) => check.act(),
            Action::List(list) => list.act(),
            Action::Prune(prune) => prune.act(),
        }
    }
}

/// References that are needed. Those named by --reference are needed whether or not a method has pictures of the quantity.
#[derive(Args)]
struct Wanted {
    #[command(flatten)]
    pick: Pick,
    #[command(flatten)]
    how_good: HowGood,
    #[command(flatten)]
    cache: CacheDir,
}

/// A plan whose references are needed.
struct Planned {
    plan: Plan,
    quality: Quality,
    whatever: bool,
    cache: PathBuf,
}

impl Wanted {
    fn plan(&self) -> anyhow::Result<Planned> {
        let quality = self.how_good.quality()?;
        // Nothing is timed.
        let terms = Terms { seed: self.pick.seed, timed_on: String::new() };
        let plan = Plan::new(&self.pick.selection().entries()?, &terms)?;
        Ok(Planned { plan, quality, whatever: !self.pick.reference.is_empty(), cache: self.cache.path()? })
    }
}

impl Planned {
    fn needs(&self) -> Vec<Need<'_>> {
        needed(&self.plan, &self.quality, self.whatever)
    }
}
