//! `halflight gate`.

use super::{CacheDir, Ending, HowGood, Out, Pick, say};
use crate::gate::{Baselines, Comparison, Finding, Observed, SUITE, Verdict, compare, count, observe};
use crate::plan::{Plan, Terms};
use crate::run::Options;
use clap::Args;
use halflight_results::Store;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Gate {
    #[command(flatten)]
    judged: Judged,
    /// Fail on improvements too: the baselines are to be blessed with them
    #[arg(long)]
    strict: bool,
}

/// What is measured, and the baselines that it is held against. Without any selection, the `gate` suite; a selection is held
/// against its part of that suite's baselines.
#[derive(Args)]
pub(super) struct Judged {
    #[command(flatten)]
    pick: Pick,
    #[command(flatten)]
    out: Out,
    #[command(flatten)]
    cache: CacheDir,
    #[command(flatten)]
    how_good: HowGood,
    /// Count instructions, too, where there is valgrind: about 3 s a method
    #[arg(long)]
    instructions: bool,
    /// Folder of baselines, one file a suite
    #[arg(long, value_name = "DIR", default_value = "reports/baselines")]
    baselines: PathBuf,
}

/// What was measured, with where its baselines lie.
pub(super) struct Measured {
    pub(super) observed: Observed,
    pub(super) path: PathBuf,
    /// Whether it is a part of what the baselines know.
    pub(super) partial: bool,
}

impl Judged {
    /// Runs what is not in the results yet, and measures all of it.
    pub(super) fn measure(&self) -> anyhow::Result<Measured> {
        let mut selection = self.pick.selection();
        let partial = selection.suite.is_none() && !selection.names_nothing();
        let suite = selection.suite.clone().unwrap_or(SUITE.to_owned());
        if !partial {
            selection.suite = Some(suite.clone());
        }
        let (entries, quality) = (selection.entries()?, self.how_good.quality()?);
        let terms = Terms { seed: self.pick.seed, timed_on: crate::environment().class() };
        let plan = Plan::new(&entries, &terms)?;
        let mut store = Store::open(&self.out.out)?;
        store.warnings().iter().for_each(|warning| eprintln!("halflight: {warning}"));
        crate::run(&plan, &mut store, &Options { quality, ..Options::new(self.cache.path()?) })?;
        let mut observed = observe(&plan, &entries, &store, &quality);
        if self.instructions {
            match count()? {
                Some(instructions) => observed.counted(instructions),
                None => say("instructions are not counted: there is no valgrind"),
            }
        }
        Ok(Measured { observed, path: Baselines::path(&self.baselines, &suite), partial })
    }
}

impl Gate {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let Measured { observed, path, partial } = self.judged.measure()?;
        let bless = "`halflight bless` makes them";
        let expected = Baselines::read(&path)?;
        let expected = expected.ok_or_else(|| anyhow::anyhow!("{}: no baselines; {bless}", path.display()))?;
        let comparison = compare(&expected, &observed, partial);
        let [before, now] = [&expected, &observed.measured].map(|known| &known.instructions.with);
        if !now.is_empty() && before != now {
            say(&format!("instructions are not compared: counted with {now}, the baselines with {before}"));
        }
        let plan = format!("halflight plan{}", self.judged.pick.words());
        comparison.findings.iter().for_each(|finding| say(&told(finding, &observed, &plan, self.strict)));
        let passes = comparison.passes(self.strict);
        say(&summary(&comparison, &observed, passes));
        Ok(if passes { Ending::Well } else { Ending::Differs })
    }
}

/// One line: what differs, and how to see it again; where that is nothing that was planned, `plan` says what is.
fn told(finding: &Finding, observed: &Observed, plan: &str, strict: bool) -> String {
    let kind = match finding.verdict {
        Verdict::Improves if !strict => "better",
        _ => "FAILS",
    };
    let known = observed.commands.get(&finding.subject).cloned();
    let again = known.or_else(|| by_name(&finding.subject)).unwrap_or_else(|| plan.to_owned());
    format!("{kind}: {}: {} [{again}]", finding.subject, finding.told)
}

/// The command that makes what only the baselines know: `scene · method name=value … · quantity` or a reference's.
fn by_name(subject: &str) -> Option<String> {
    let [scene, what, quantity, ..] = subject.split(" · ").collect::<Vec<_>>()[..] else { return None };
    let quantity = if quantity == "direct" { String::new() } else { format!(" --quantity {quantity}") };
    let mut words = what.split(' ');
    Some(match words.next().filter(|id| id.contains('/')) {
        Some(method) => {
            let set: String = words.map(|set| format!(" --set {set}")).collect();
            format!("halflight run --scene {scene}{quantity} --method {method}{set}")
        }
        None => format!("halflight refs build --scene {scene}{quantity} --reference {what}"),
    })
}

fn summary(comparison: &Comparison, observed: &Observed, passes: bool) -> String {
    let count = |verdict| comparison.findings.iter().filter(|finding| finding.verdict == verdict).count();
    format!(
        "gate {}: {} cells and {} references, {} checks ({} of them statistical); {} fail, {} are better than they were",
        if passes { "passed" } else { "FAILED" },
        observed.measured.cells.len(),
        observed.measured.references.len(),
        comparison.checks,
        comparison.statistical,
        count(Verdict::Fails),
        count(Verdict::Improves)
    )
}
