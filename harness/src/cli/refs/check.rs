//! `halflight refs check`.

use super::super::{Ending, say};
use super::Wanted;
use crate::refs::{Checked, Need, Retake, check, require, store};
use clap::Args;
use halflight_contract::Cache;
use halflight_references::{Achieved, State};
use serde::Serialize;

#[derive(Args)]
pub(super) struct Check {
    #[command(flatten)]
    wanted: Wanted,
    /// Also estimate some receivers of each again, with another seed, and test whether the two agree
    #[arg(long)]
    statistics: bool,
    /// Print a JSON array
    #[arg(long)]
    json: bool,
}

/// One reference and what there is of it.
#[derive(Serialize)]
struct Row {
    scene: String,
    frame: usize,
    reference: String,
    quantity: String,
    key: String,
    state: &'static str,
    done: Option<usize>,
    achieved: Option<Achieved>,
    /// Probability that chance alone tells the kept one and its retake so far apart.
    p: Option<f64>,
    agrees: Option<bool>,
    #[serde(skip)]
    line: String,
}

impl Check {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let planned = self.wanted.plan()?;
        let store = store(&planned.cache);
        let needs = planned.needs();
        let mut rows = Vec::with_capacity(needs.len());
        for need in &needs {
            let derived = Cache::in_folder(&planned.cache.join("derived"));
            let retake = if self.statistics { Retake::of(need, &store, &derived)? } else { None };
            let row = Row::of(need, &check(need, &store), retake.as_ref());
            if !self.json {
                say(&row.line);
            }
            rows.push(row);
        }
        if self.json {
            say(&serde_json::to_string_pretty(&rows)?);
        } else {
            let present = rows.iter().filter(|row| row.state == "present").count();
            say(&format!("{present} of {} references are there", rows.len()));
        }
        let wrong = rows.iter().filter(|row| row.agrees == Some(false)).count();
        if wrong > 0 {
            eprintln!("halflight: {wrong} of {} references differ from what is estimated now", rows.len());
        }
        match require(&needs, &store) {
            Err(error) => {
                eprintln!("halflight: {error}");
                Ok(Ending::Differs)
            }
            Ok(()) if wrong > 0 => Ok(Ending::Differs),
            Ok(()) => Ok(Ending::Well),
        }
    }
}

impl Row {
    fn of(need: &Need<'_>, checked: &Checked, retake: Option<&Retake>) -> Self {
        let (state, done) = match &checked.state {
            Some(State::Whole(_)) => ("present", None),
            Some(State::Begun { done, .. }) => ("begun", Some(*done)),
            Some(State::Damaged | State::Unplaced) => ("damaged", None),
            None => ("missing", None),
        };
        let achieved = checked.whole().and_then(|provenance| provenance.achieved);
        let mut line = format!("{}: {}", need.label(), checked.told());
        if let Some(achieved) = &achieved {
            line += &format!(
                ", standard error {:.2} % of the level {:.3}, {} of {} receivers above the target",
                100.0 * achieved.standard_error,
                achieved.level,
                achieved.above_target,
                achieved.sampled
            );
        }
        if let Some(retake) = retake {
            let verdict = if retake.passes() { "agrees with" } else { "DIFFERS from" };
            let receivers = retake.comparison.receivers;
            line += &format!(", {verdict} a retake of {receivers} receivers (p = {:.2})", retake.p());
        }
        Row {
            scene: need.stage.scene.name.clone(),
            frame: need.frame.index,
            reference: need.reference.id(),
            quantity: need.quantity.to_string(),
            key: checked.key.clone(),
            state,
            done,
            achieved,
            p: retake.map(Retake::p),
            agrees: retake.map(Retake::passes),
            line,
        }
    }
}
