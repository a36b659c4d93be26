//! `halflight plan`.

use super::{CacheDir, Ending, HowGood, Out, Pick, say};
use crate::forecast::{Expected, Forecast, duration};
use crate::plan::{Plan as Work, State};
use crate::todo::Todo;
use crate::{DEFAULT_SUITE, Options, priority, refs};
use clap::Args;
use halflight_contract::Support;
use halflight_references::{Quality, ReferenceStore};
use halflight_results::Store;
use std::collections::HashMap;
use std::time::Duration;

#[derive(Args)]
pub(super) struct Plan {
    #[command(flatten)]
    pick: Pick,
    #[command(flatten)]
    out: Out,
    #[command(flatten)]
    cache: CacheDir,
    #[command(flatten)]
    how_good: HowGood,
}

impl Plan {
    pub(super) fn act(&self, threads: &[usize]) -> anyhow::Result<Ending> {
        let plan = self.pick.plan(DEFAULT_SUITE, threads)?;
        let references = refs::store(&self.cache.path()?);
        tell(&plan, &self.out, &references, &self.how_good.quality()?, Options::REPEATS, None)
    }
}

/// Prints every cell with what would be done about it and how long that may take; with a budget in the order in which it is
/// spent.
pub(super) fn tell(
    plan: &Work,
    out: &Out,
    references: &ReferenceStore,
    quality: &Quality,
    repeats: usize,
    budget: Option<Duration>,
) -> anyhow::Result<Ending> {
    let environment = crate::environment::environment();
    let store = Store::open(&out.out)?;
    let forecast = Forecast::new(&store, &environment, repeats);
    let groups = if budget.is_some() { priority::order(plan, &store) } else { plan.groups.iter().collect() };
    let (mut counts, mut taken, mut made) = ([0; 4], Vec::new(), HashMap::new());
    let mut expected = Expected::default();
    for group in groups {
        let todo = Todo::new(plan, group.scene, std::iter::once(group), &store, quality);
        let more: Vec<_> = todo.to_make(references).filter(|(key, _)| !made.contains_key(key)).collect();
        // Under a budget every group is prepared by itself.
        let alone = forecast.sum(todo.work(), more.iter().map(|(_, work)| work));
        let over = budget.is_some_and(|budget| expected.seconds + alone.seconds > budget.as_secs_f64());
        if !over {
            expected = expected + alone;
            taken.extend(todo.work());
            made.extend(more);
        }
        for cell in &group.cells {
            let frame = if group.cells.len() > 1 { format!(" frame {}", cell.frame) } else { String::new() };
            let (kind, what) = match group.state(cell, &store) {
                State::Run | State::Time if over => (3, "left out, over the budget".to_owned()),
                State::Run => (0, run(group, forecast.seconds(cell))),
                State::Time => (0, "time: the picture is in the store".to_owned()),
                State::Cached => (1, "cached: the result is in the store".to_owned()),
                State::Skip(why) => (2, format!("skip: {why}")),
            };
            counts[kind] += 1;
            say(&format!("{} · {} · {}{frame}: {what}", group.label(plan), cell.backend, group.quantity));
        }
    }
    if budget.is_none() {
        expected = forecast.sum(taken, made.values());
    }
    let left_out = if counts[3] > 0 { format!(", {} left out", counts[3]) } else { String::new() };
    let to_make = if made.is_empty() { String::new() } else { format!("; {} references to make", made.len()) };
    // Nothing to tell while nothing is known.
    let time = if expected.seconds > 0.0 { format!("; {expected}, by earlier runs") } else { String::new() };
    say(&format!("{} to run, {} cached, {} skipped{left_out}{to_make}{time}", counts[0], counts[1], counts[2]));
    Ok(Ending::Well)
}

fn run(group: &crate::plan::Group, seconds: Option<f64>) -> String {
    let references: Vec<String> = group.references.iter().map(|r| r.id()).collect();
    let against = if references.is_empty() { "nothing".to_owned() } else { references.join(", ") };
    let time = seconds.map_or(String::new(), |seconds| format!("; about {}", duration(seconds)));
    match &group.support {
        Support::Approximate(why) => format!("run, approximately ({why}), against {against}{time}"),
        _ => format!("run, against {against}{time}"),
    }
}
