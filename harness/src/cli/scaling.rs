//! `halflight scaling`.

use super::run::Run;
use super::{Ending, say};
use crate::scaling;
use clap::Args;
use halflight_reports::Scaling as Series;

#[derive(Args)]
pub(super) struct Scaling {
    #[command(flatten)]
    run: Run,
}

impl Scaling {
    pub(super) fn act(&self, threads: &[usize]) -> anyhow::Result<Ending> {
        let (ending, store) = self.run.carry_out("scaling", threads)?;
        store.iter().flat_map(scaling::of).for_each(|series| say(&told(&series)));
        Ok(ending)
    }
}

/// One line: what grows with what, and how.
fn told(series: &Series) -> String {
    let Series { scene, over, cell, points, fit } = series;
    let Some(fit) = fit else { return String::new() };
    let (exponent, low, high) = (fit.exponent, fit.low, fit.high);
    format!(
        "{scene} · {}: shade time ~ {over}^{exponent:.2} ({low:.2} to {high:.2}), {} points, R² {:.4}, lack of fit p {:.2}",
        cell.method,
        points.len(),
        fit.r_squared,
        fit.lack_of_fit
    )
}
