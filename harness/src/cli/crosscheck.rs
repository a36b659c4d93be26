//! `halflight crosscheck`.

use super::{CacheDir, Ending, Out, report, say};
use crate::crosscheck::cross_check;
use clap::Args;
use halflight_results::{CrossCheck, Store};
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Check {
    /// Folders of `halflight export` in which the other renderer has left its answer
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    #[command(flatten)]
    out: Out,
    #[command(flatten)]
    cache: CacheDir,
}

impl Check {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let mut store = Store::open(&self.out.out)?;
        let mut all_agree = true;
        for folder in &self.folders {
            let check = cross_check(folder, &mut store, &self.cache.path()?)?;
            all_agree &= check.agrees;
            say(&verdict(&check));
        }
        report::write(&store, &self.out.out.join("report.html"))?;
        Ok(if all_agree { Ending::Well } else { Ending::Differs })
    }
}

fn verdict(check: &CrossCheck) -> String {
    let [ours, theirs] = check.samples;
    let share = |sum: f64| sum / (3.0 * check.level);
    format!(
        "{} {}: {} with {}; {} receivers, {ours} and {theirs} samples, largest |z| {}, p of it {:.2}, truth's excess {:+.4}% ± {:.4}%, \
         p of it {:.2}",
        check.scene,
        check.quantity,
        if check.agrees { "agrees" } else { "DIFFERS" },
        check.program,
        check.receivers,
        check.largest.map_or("∞".to_owned(), |largest| format!("{largest:.2}")),
        check.family_p,
        100.0 * share(check.bias.iter().sum()),
        // Channels share their samples: at most so much.
        100.0 * share(check.bias_error.iter().sum()),
        check.bias_p,
    )
}
