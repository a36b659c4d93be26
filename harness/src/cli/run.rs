//! `halflight run`.

use super::{CacheDir, Ending, HowGood, Out, Pick, say};
use crate::plan::{Plan, Terms};
use crate::run::{Options, Summary};
use clap::{Args, FromArgMatches};
use halflight_results::Store;

#[derive(Args)]
pub(super) struct Run {
    #[command(flatten)]
    pick: Pick,
    #[command(flatten)]
    out: Out,
    #[command(flatten)]
    cache: CacheDir,
    #[command(flatten)]
    how_good: HowGood,
    /// Timed evaluations of each cell that is run, after one to warm up
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
}

impl Run {
    /// The command as it is without arguments.
    pub(super) fn plain() -> anyhow::Result<Self> {
        let command = Self::augment_args(clap::Command::new("run"));
        Ok(Self::from_arg_matches(&command.try_get_matches_from(["run"])?)?)
    }

    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let quality = self.how_good.quality()?;
        let terms = Terms { seed: self.pick.seed, timed_on: crate::environment::environment().class() };
        let plan = Plan::new(&self.pick.selection().entries()?, &terms)?;
        let mut store = Store::open(&self.out.out)?;
        store.warnings().iter().for_each(|warning| eprintln!("halflight: {warning}"));
        let options = Options { repeats: self.repeats.into(), quality, ..Options::new(self.cache.path()?) };
        let summary = crate::run(&plan, &mut store, &options)?;

        let report = self.out.out.join("report.html");
        // An unchanged store has the report that it had.
        if summary.lines > 0 || !report.exists() {
            super::report::write(&store, &report)?;
        }
        say(&told(&summary));
        say(&format!("report: {}", report.display()));
        Ok(if summary.failed + summary.unjudged > 0 { Ending::Differs } else { Ending::Well })
    }
}

fn told(s: &Summary) -> String {
    let mut line = format!(
        "{} cells run, {} cached, {} skipped, {} failed; {} references made, {} scores added",
        s.ran, s.cached, s.skipped, s.failed, s.references_made, s.scored
    );
    if s.unjudged > 0 {
        line += &format!("; {} references or scores FAILED", s.unjudged);
    }
    line
}
