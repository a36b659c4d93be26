//! `halflight pareto`.

use super::{Ending, Out, say};
use anyhow::ensure;
use clap::{Args, ValueEnum};
use halflight_reports::{Against, Front, Report};
use halflight_results::Store;

#[derive(Args)]
pub(super) struct Pareto {
    #[command(flatten)]
    out: Out,
    /// A scene by its name in the report, repeatable; all of them, and all together, if not given
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// What was computed; all that there is if not given
    #[arg(long, value_name = "QUANTITY")]
    quantity: Option<String>,
    /// What errors are weighed against; both if not given
    #[arg(long)]
    against: Option<Cost>,
    /// The setting that figures over scenes are relative to, as it is called here; the one with most scenes if not given
    #[arg(long, value_name = "SETTING")]
    base: Option<String>,
    /// Print dominated settings too, and by which
    #[arg(long)]
    all: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Cost {
    Time,
    Memory,
}

impl Pareto {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let store = Store::open(&self.out.out)?;
        ensure!(store.path().exists(), "{}: expected the results of a run", store.path().display());
        let report = halflight_reports::outline(&store, "");
        let scenes: Vec<&str> = report.scenes.iter().map(|scene| scene.name.as_str()).collect();
        for scene in &self.scene {
            ensure!(scenes.contains(&scene.as_str()), crate::Error::unknown("scene", scene, scenes));
        }
        if let Some(base) = self.base.as_ref().filter(|base| !report.labels.contains(base)) {
            return Err(crate::Error::unknown("setting", base, report.labels.iter().map(String::as_str)).into());
        }
        let against = match self.against {
            None => Against::ALL.to_vec(),
            Some(Cost::Time) => vec![Against::Time],
            Some(Cost::Memory) => vec![Against::Memory],
        };
        let wanted = |front: &Front| {
            let scene = |scene: &String| self.scene.is_empty() || self.scene.contains(scene);
            front.scene.as_ref().map_or(self.scene.is_empty(), scene)
                && self.quantity.as_ref().is_none_or(|quantity| *quantity == front.quantity)
        };
        let told = tell(&report, &against, self.base.as_deref(), self.all, wanted);
        ensure!(told > 0, "{}: expected scored runs of what is asked for, found none", store.path().display());
        Ok(Ending::Well)
    }
}

/// Prints fronts, and returns how many.
pub(super) fn tell(
    report: &Report,
    against: &[Against],
    base: Option<&str>,
    all: bool,
    wanted: impl Fn(&Front) -> bool,
) -> usize {
    let of = |against: &Against| [report.fronts_over_scenes(*against, base), report.fronts(*against)].concat();
    let fronts = against.iter().flat_map(of).filter(wanted);
    fronts.map(|front| front.text(report, all)).inspect(|text| say(text)).count()
}
