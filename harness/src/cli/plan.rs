//! `halflight plan`.

use super::{Ending, Out, Pick, say};
use crate::forecast::{Expected, Forecast, duration};
use crate::plan::State;
use crate::{DEFAULT_SUITE, Options, priority};
use clap::Args;
use halflight_contract::Support;
use halflight_results::{Cell, Store};
use std::time::Duration;

#[derive(Args)]
pub(super) struct Plan {
    #[command(flatten)]
    pick: Pick,
    #[command(flatten)]
    out: Out,
}

impl Plan {
    pub(super) fn act(&self, threads: &[usize]) -> anyhow::Result<Ending> {
        tell(&self.pick, DEFAULT_SUITE, threads, &self.out, Options::REPEATS, None)
    }
}

/// Prints every cell with what would be done about it and how long that may take; with a budget in the order in which it is
/// spent.
pub(super) fn tell(
    pick: &Pick,
    suite: &str,
    threads: &[usize],
    out: &Out,
    repeats: usize,
    budget: Option<Duration>,
) -> anyhow::Result<Ending> {
    let environment = crate::environment::environment();
    let plan = pick.plan(suite, threads)?;
    let store = Store::open(&out.out)?;
    let forecast = Forecast::new(&store, &environment, repeats);
    let groups = if budget.is_some() { priority::order(&plan, &store) } else { plan.groups.iter().collect() };
    let (mut counts, mut expected) = ([0; 4], Expected::default());
    for group in groups {
        let runs = |cell: &&Cell| matches!(group.state(cell, &store), State::Run | State::Time);
        let more = forecast.sum(group.cells.iter().filter(runs));
        let over = budget.is_some_and(|budget| expected.seconds + more.seconds > budget.as_secs_f64());
        if !over {
            expected = expected + more;
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
            say(&format!("{} · {} · {}{frame}: {what}", group.label(&plan), group.backend, group.quantity));
        }
    }
    let left_out = if counts[3] > 0 { format!(", {} left out", counts[3]) } else { String::new() };
    // Nothing to tell while nothing is known.
    let time = if expected.seconds > 0.0 { format!("; {expected}, by earlier runs") } else { String::new() };
    say(&format!("{} to run, {} cached, {} skipped{left_out}{time}", counts[0], counts[1], counts[2]));
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
