//! `halflight run`.

use super::{CacheDir, Ending, HowGood, Out, Pick, say};
use crate::DEFAULT_SUITE;
use crate::run::{Options, Summary};
use clap::{Args, FromArgMatches};
use halflight_results::Store;
use std::time::Duration;

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
    /// Timed evaluations of each cell, after one to warm up, in turns with the other cells of its scene
    #[arg(long, value_name = "N", default_value_t = Options::REPEATS as u16, value_parser = clap::value_parser!(u16).range(1..))]
    repeats: u16,
    /// Print every cell and what would be done about it, as `plan` does, and do nothing
    #[arg(long)]
    dry_run: bool,
    /// Time to spend, such as 90s, 10m, 1.5h. First every method on every scene at the setting nearest its defaults, then in
    /// turns the settings farthest from those that are done; one that by earlier runs would take too long is left out, and
    /// the one at hand when the time is over is finished
    #[arg(long, value_name = "TIME", value_parser = budget)]
    budget: Option<Duration>,
}

impl Run {
    /// The command as it is without arguments.
    pub(super) fn plain() -> anyhow::Result<Self> {
        let command = Self::augment_args(clap::Command::new("run"));
        Ok(Self::from_arg_matches(&command.try_get_matches_from(["run"])?)?)
    }

    pub(super) fn act(&self, threads: &[usize]) -> anyhow::Result<Ending> {
        Ok(self.carry_out(DEFAULT_SUITE, threads)?.0)
    }

    /// What is asked for, this suite if nothing is.
    pub(super) fn plan(&self, suite: &str, threads: &[usize]) -> Result<crate::Plan, crate::Error> {
        self.pick.plan(suite, threads)
    }

    /// What is asked for, as on the command line, this suite if nothing is.
    pub(super) fn words(&self, suite: &str) -> String {
        let suite = if self.pick.selection().names_nothing() { format!(" --suite {suite}") } else { String::new() };
        suite + &self.pick.words()
    }

    /// The name of the adapter that takes part and what is known of it; none where none does.
    pub(super) fn adapter(&self) -> Result<Option<(String, String)>, crate::Error> {
        if self.pick.backend == crate::Where::Cpu {
            return Ok(None);
        }
        Ok(crate::processor(self.pick.adapter.as_deref())?.ok().map(|processor| (processor.device, processor.about)))
    }

    /// Runs what is asked for, this suite if nothing is; with the results, if it was no dry run.
    pub(super) fn carry_out(&self, suite: &str, threads: &[usize]) -> anyhow::Result<(Ending, Option<Store>)> {
        if self.dry_run {
            let references = crate::refs::store(&self.cache.path()?);
            let (repeats, quality) = (self.repeats.into(), self.how_good.quality()?);
            let plan = self.pick.plan(suite, threads)?;
            let told = super::plan::tell(&plan, &self.out, &references, &quality, repeats, self.budget)?;
            return Ok((told, None));
        }
        let quality = self.how_good.quality()?;
        let plan = self.pick.plan(suite, threads)?;
        let mut store = Store::open(&self.out.out)?;
        store.warnings().iter().for_each(|warning| eprintln!("halflight: {warning}"));
        let (repeats, budget) = (self.repeats.into(), self.budget);
        let options = Options { repeats, budget, quality, ..Options::new(self.cache.path()?) };
        let summary = crate::run(&plan, &mut store, &options)?;

        let report = self.out.out.join("report.html");
        // Others may have added lines since.
        store.refresh()?;
        // An unchanged store has the report that it had.
        if summary.lines > 0 || !report.exists() {
            super::report::write(&store, &report)?;
        }
        say(&told(&summary));
        say(&format!("report: {}", report.display()));
        let ending = if summary.failed + summary.unjudged > 0 { Ending::Differs } else { Ending::Well };
        Ok((ending, Some(store)))
    }
}

/// Reads a time such as `90s`, `10m`, `1.5h`.
fn budget(text: &str) -> Result<Duration, String> {
    let expected = || "expected a number of seconds, minutes or hours, such as 90s, 10m, 1.5h".to_owned();
    let unit = [("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let (number, seconds) =
        unit.iter().find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds))).ok_or_else(expected)?;
    let number: f64 = number.parse().map_err(|_| expected())?;
    Duration::try_from_secs_f64(number * seconds).map_err(|_| expected())
}

fn told(s: &Summary) -> String {
    let mut line = format!(
        "{} cells run, {} cached, {} skipped, {} failed; {} references made, {} scores added",
        s.ran, s.cached, s.skipped, s.failed, s.references_made, s.scored
    );
    if s.timed > s.ran {
        line += &format!("; {} cells timed", s.timed);
    }
    if s.left_out > 0 {
        line += &format!("; {} cells left out, over the budget", s.left_out);
    }
    if s.unjudged > 0 {
        line += &format!("; {} references or scores FAILED", s.unjudged);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_have_a_unit() {
        for (text, seconds) in [("90s", 90.0), ("10m", 600.0), ("1.5h", 5400.0), ("0s", 0.0)] {
            assert_eq!(budget(text), Ok(Duration::from_secs_f64(seconds)));
        }
        for bad in ["10", "m", "-1s", "NaNs", "infh", "ten m", ""] {
            assert!(budget(bad).unwrap_err().contains("10m"), "{bad}");
        }
    }
}
