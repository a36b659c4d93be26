//! `halflight list`.

use super::{CacheDir, Ending, Out, say};
use crate::forecast::Forecast;
use crate::plan::{Plan, State, Terms};
use crate::suite::{SHIPPED, Suite};
use crate::todo::Left;
use crate::{Options, refs};
use clap::{Args, ValueEnum};
use halflight_references::{Quality, Reference};
use halflight_results::Store;

#[derive(Args)]
pub(super) struct List {
    /// What to list
    kind: Kind,
    /// As a JSON array of objects with `id` and `about`
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    out: Out,
    #[command(flatten)]
    cache: CacheDir,
}

#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    Scenes,
    Methods,
    Parameters,
    References,
    Suites,
    Metrics,
    Columns,
}

#[derive(serde::Serialize)]
struct Entry {
    id: String,
    about: String,
}

/// The error measures by the names that result lines use.
const METRICS: [(&str, &str); 11] = [
    ("rmse", "root mean square error, radiance"),
    ("rmse_standard_error", "standard error of rmse by the reference's noise, radiance"),
    ("rel_mse", "relative mean square error, mean((x−r)²/(r²+0.01))"),
    ("mae", "mean absolute error, radiance"),
    ("bias", "mean signed error, radiance; negative is too dark"),
    ("max", "largest absolute error, radiance"),
    ("p99", "99th percentile of the absolute error, radiance"),
    ("ssim", "structural similarity of the displayed pictures, 1 for equal ones; images only"),
    ("flip", "FLIP of the displayed pictures, 0 for equal ones; images only"),
    ("level", "root mean square of the reference, radiance"),
    ("reference_standard_error", "root mean square of the reference's own standard error, radiance"),
];

impl List {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let entries = self.entries()?;
        if self.json {
            say(&serde_json::to_string_pretty(&entries)?);
            return Ok(Ending::Well);
        }
        let width = entries.iter().map(|entry| entry.id.chars().count()).max().unwrap_or(0);
        entries.iter().for_each(|entry| say(&format!("{:width$}  {}", entry.id, entry.about)));
        Ok(Ending::Well)
    }
}

impl List {
    fn entries(&self) -> anyhow::Result<Vec<Entry>> {
        let entry = |(id, about): (&str, &str)| Entry { id: id.to_owned(), about: about.to_owned() };
        Ok(match self.kind {
            Kind::Scenes => scenes(),
            Kind::Methods => {
                halflight_registry::methods().iter().map(|m| entry((m.info().id, m.info().about))).collect()
            }
            Kind::Parameters => halflight_registry::methods().iter().flat_map(|m| parameters(m.info())).collect(),
            Kind::References => Reference::all().iter().map(|kind| entry((kind.id, kind.about))).collect(),
            Kind::Suites => self.suites()?,
            Kind::Metrics => METRICS.map(entry).into(),
            Kind::Columns => crate::COLUMNS.map(entry).into(),
        })
    }
}

impl List {
    /// Suites with how many cells they have, and what of them is not in the results yet.
    fn suites(&self) -> anyhow::Result<Vec<Entry>> {
        let environment = crate::environment::environment();
        let terms = Terms { seed: 1, timed_on: environment.class() };
        let (store, quality) = (Store::open(&self.out.out)?, Quality::default());
        let references = refs::store(&self.cache.path()?);
        let forecast = Forecast::new(&store, &environment, Options::REPEATS);
        let entry = |name: &str| {
            let suite = Suite::find(name)?;
            let plan = Plan::new(&suite.entries, &terms)?;
            let left = Left::new(&plan, &store, &references, &quality);
            let served = plan.cells().filter(|(group, cell)| !matches!(group.state(cell, &store), State::Skip(_)));
            let (cells, to_run) = (served.count(), left.cells.len());
            let expected = left.expected(&forecast);
            let time = match (to_run + left.references.len(), expected.seconds > 0.0) {
                (0, _) => "all in the results".to_owned(),
                (_, true) => format!("{to_run} to run: {expected}"),
                (_, false) => format!("{to_run} to run, of unknown time"),
            };
            Ok(Entry { id: name.to_owned(), about: format!("{} ({cells} cells, {time})", suite.about) })
        };
        SHIPPED.iter().map(|(name, _)| entry(name)).collect()
    }
}

fn scenes() -> Vec<Entry> {
    halflight_scenes::shipped().into_iter().map(|(id, _, about)| Entry { id, about }).collect()
}

fn parameters(info: &'static halflight_contract::Info) -> impl Iterator<Item = Entry> {
    info.params.iter().map(|spec| Entry {
        id: format!("{} {}", info.id, spec.name),
        about: format!("{} ({}; default {})", spec.help, spec.kind, spec.default()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use halflight_metrics::{Layout, Picture, compare};

    #[test]
    fn every_measure_is_listed() {
        let (x, r, valid, layout) =
            ([Vec3::ONE; 400], [Vec3::ONE; 400], [true; 400], Layout::Image { width: 20, height: 20 });
        let picture = |radiance| Picture { radiance, valid: &valid, layout };
        let scores = compare(&picture(&x), &picture(&r), &[Vec3::ZERO; 400]).unwrap();
        let names: Vec<_> = scores.measures().map(|(name, _)| name).collect();
        assert_eq!(names, METRICS.map(|(name, _)| name));
    }
}
