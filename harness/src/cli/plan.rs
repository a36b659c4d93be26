//! `halflight plan`.

use super::{Ending, Out, Pick, say};
use crate::plan::{Plan as Work, State, Terms};
use clap::Args;
use halflight_contract::Support;
use halflight_results::Store;

#[derive(Args)]
pub(super) struct Plan {
    #[command(flatten)]
    pick: Pick,
    #[command(flatten)]
    out: Out,
}

impl Plan {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let terms = Terms { seed: self.pick.seed, timed_on: crate::environment::environment().class() };
        let plan = Work::new(&self.pick.selection().entries()?, &terms)?;
        let store = Store::open(&self.out.out)?;
        let mut counts = [0; 3];
        for (group, cell) in plan.cells() {
            let frame = if group.cells.len() > 1 { format!(" frame {}", cell.frame) } else { String::new() };
            let (kind, what) = match group.state(cell, &store) {
                State::Run => (0, run(group)),
                State::Cached => (1, "cached: the result is in the store".to_owned()),
                State::Skip(why) => (2, format!("skip: {why}")),
            };
            counts[kind] += 1;
            say(&format!("{} · {} · {}{frame}: {what}", group.label(&plan), group.backend, group.quantity));
        }
        say(&format!("{} to run, {} cached, {} skipped", counts[0], counts[1], counts[2]));
        Ok(Ending::Well)
    }
}

fn run(group: &crate::plan::Group) -> String {
    let references: Vec<String> = group.references.iter().map(|r| r.id()).collect();
    let against = if references.is_empty() { "nothing".to_owned() } else { references.join(", ") };
    match &group.support {
        Support::Approximate(why) => format!("run, approximately ({why}), against {against}"),
        _ => format!("run, against {against}"),
    }
}
