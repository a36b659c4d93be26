//! `halflight budget`.

use super::{CacheDir, Ending, HowGood, Out, say};
use crate::plan::{method, quantity, single};
use crate::probe::Question;
use crate::settings::Setting;
use anyhow::Context;
use clap::Args;
use halflight_metrics::Difference;
use halflight_reports::BudgetStep;

#[derive(Args)]
pub(super) struct Budget {
    /// A shipped scene's name, or the path of a scene file
    #[arg(long)]
    scene: String,
    /// The method to walk to
    #[arg(long)]
    method: String,
    /// Value of a parameter, repeatable: order=4
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// Which light: direct, indirect-N by up to N bounces, total
    #[arg(long, default_value = "direct")]
    quantity: String,
    /// The frame
    #[arg(long, default_value_t = 0)]
    frame: usize,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print a JSON array of the steps rather than a table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    out: Out,
    #[command(flatten)]
    how_good: HowGood,
    #[command(flatten)]
    cache: CacheDir,
}

impl Budget {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let method = method(&self.method)?;
        let params = single(method, &self.set)?;
        let (quality, quantity) = (self.how_good.quality()?, quantity(&self.quantity)?);
        let scene = halflight_scenes::find(&self.scene)?;
        let question = Question { scene: &scene, frame: self.frame, quantity, seed: self.seed };
        let budget = crate::budget(&question, method, &params, &quality, &self.cache.path()?)?;
        let dir = &self.out.out;
        std::fs::create_dir_all(dir).with_context(|| dir.display().to_string())?;
        let page = dir.join(format!("budget-{}-{}.html", scene.name, method.info().id.replace('/', "-")));
        budget.write(&page)?;
        if self.json {
            let rows: Vec<_> = budget.steps.iter().map(json).collect();
            say(&serde_json::to_string_pretty(&rows)?);
            return Ok(Ending::Well);
        }
        say(&format!("{}, {}", budget.title, budget.settings));
        let columns = ["RMSE from truth", "RMSE of the step", "bias of the step", "noise"];
        say(&format!("{:28} {:>24} {:>24} {:>22} {:>9}", "step", columns[0], columns[1], columns[2], columns[3]));
        budget.steps.iter().for_each(|step| say(&row(step)));
        budget.left_out.iter().for_each(|why| say(&format!("left out: {why}")));
        say(&format!("page: {}", page.display()));
        Ok(Ending::Well)
    }
}

fn row(step: &BudgetStep) -> String {
    let rmse = |d: &Option<Difference>| match d {
        None => "–".to_owned(),
        Some(d) if d.resolved => plus_minus(format!("{:.5}", d.rmse), d.rmse_error),
        Some(d) => format!("not resolved, < {:.5}", d.rmse_bound),
    };
    let (bias, noise) = step.change.map_or(("–".to_owned(), "–".to_owned()), |d| {
        (plus_minus(format!("{:+.5}", d.bias), d.bias_error), format!("{:.5}", d.noise))
    });
    format!("{:28} {:>24} {:>24} {bias:>22} {noise:>9}", step.name, rmse(&step.from_truth), rmse(&step.change))
}

/// A value with its standard error, if it has one.
fn plus_minus(value: String, error: f64) -> String {
    if error > 0.0 { format!("{value} ± {error:.5}") } else { value }
}

fn json(step: &BudgetStep) -> serde_json::Value {
    let figures = |d: &Option<Difference>| {
        d.map(|d| {
            serde_json::json!({
                "rmse": d.rmse, "rmse_error": d.rmse_error, "rmse_bound": d.rmse_bound, "bias": d.bias,
                "bias_error": d.bias_error, "noise": d.noise, "resolved": d.resolved, "receivers": d.receivers,
            })
        })
    };
    serde_json::json!({
        "step": step.name, "about": step.about, "from_truth": figures(&step.from_truth), "change": figures(&step.change),
    })
}
