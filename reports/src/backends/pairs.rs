//! The same cell on the processor and on a graphics processor.

use crate::{Absent, Report, Row};
use halflight_metrics::{Apart, apart};
use halflight_results::{Cell, Key, Layout, Picture, Record, Run, Store};
use std::collections::HashMap;

/// What became of a cell on one backend.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Outcome<'r> {
    Run(&'r Row),
    Skipped(&'r Absent),
    Failed(&'r Absent),
    /// The results have no such cell.
    Missing,
}

impl<'r> Outcome<'r> {
    pub(crate) fn row(self) -> Option<&'r Row> {
        if let Outcome::Run(row) = self { Some(row) } else { None }
    }

    fn cell(self) -> Option<&'r Cell> {
        match self {
            Outcome::Run(row) => Some(&row.run.cell),
            Outcome::Skipped(absent) | Outcome::Failed(absent) => Some(&absent.cell),
            Outcome::Missing => None,
        }
    }

    fn label(self) -> Option<usize> {
        match self {
            Outcome::Run(row) => Some(row.label),
            Outcome::Skipped(absent) | Outcome::Failed(absent) => Some(absent.label),
            Outcome::Missing => None,
        }
    }

    /// The threads of a run that was timed.
    fn threads(self) -> Option<usize> {
        self.row().filter(|row| row.times.is_some()).map(|row| row.run.environment.threads)
    }
}

/// A cell on both backends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<'r> {
    pub(crate) cpu: Outcome<'r>,
    pub(crate) gpu: Outcome<'r>,
}

impl Pair<'_> {
    /// Its label: of the processor's cell, where there is one.
    pub(crate) fn label(&self) -> usize {
        self.cpu.label().or(self.gpu.label()).expect("a pair has a cell")
    }

    /// The graphics processor, without what introduces it.
    pub(crate) fn adapter(&self) -> &str {
        let backend = self.gpu.cell().map_or("", |cell| &cell.backend);
        backend.strip_prefix("gpu: ").unwrap_or(backend)
    }

    /// Whether the graphics processor is one in software.
    pub(crate) fn is_software(&self) -> bool {
        self.gpu.cell().is_some_and(Cell::is_software)
    }

    /// How far the graphics processor's picture is from the processor's; none where one of them is not there, an error where they
    /// cannot be compared.
    pub(crate) fn apart(&self) -> Option<Result<Apart, String>> {
        let (Some(gpu), Some(cpu)) = (&self.gpu.row()?.picture, &self.cpu.row()?.picture) else {
            return Some(Err("a picture is missing or damaged".into()));
        };
        Some(of_pictures(gpu, cpu))
    }
}

/// The pairs of a scene, in the order of its rows; none where nothing of it was meant for a graphics processor.
pub(crate) fn pairs<'r>(report: &'r Report, scene: &str) -> Vec<Pair<'r>> {
    let rows = report.scenes.iter().filter(|s| s.name == scene).flat_map(|s| &s.rows).map(Outcome::Run);
    let absent = |list: &'r [Absent]| list.iter().filter(move |absent| absent.scene == scene);
    let absent = absent(&report.failures).map(Outcome::Failed).chain(absent(&report.skips).map(Outcome::Skipped));
    let cells = rows.chain(absent).filter_map(|outcome| Some((outcome.cell()?.anywhere(), outcome)));
    let is_gpu = |outcome: &Outcome<'_>| outcome.cell().is_some_and(Cell::is_gpu);
    let (gpu, cpu): (Vec<_>, Vec<_>) = cells.partition(|(_, outcome)| is_gpu(outcome));
    if gpu.is_empty() {
        return Vec::new();
    }
    let mut seen: Vec<&Cell> = Vec::new();
    let mut pairs = Vec::new();
    for (work, _) in cpu.iter().chain(&gpu) {
        if seen.contains(&work) {
            continue;
        }
        let of = |all: &[(Cell, Outcome<'r>)]| -> Vec<Outcome<'r>> {
            all.iter().filter(|(other, _)| other == work).map(|(_, outcome)| *outcome).collect()
        };
        pairs.extend(matched(&of(&cpu), of(&gpu)));
        seen.push(work);
    }
    // What neither serves is told where skips are told.
    pairs.retain(|pair| [pair.cpu, pair.gpu].iter().any(|o| !matches!(o, Outcome::Skipped(_) | Outcome::Missing)));
    pairs
}

/// The same work wherever it ran: each of the graphics processors' with the processor's cell of as many threads, or of most.
fn matched<'r>(cpu: &[Outcome<'r>], mut gpu: Vec<Outcome<'r>>) -> Vec<Pair<'r>> {
    // A cell that was skipped for want of an adapter is of no interest once there was one.
    let real = |outcome: &Outcome<'_>| outcome.cell().is_some_and(|cell| cell.backend != "gpu");
    if gpu.iter().any(real) {
        gpu.retain(real);
    }
    if gpu.is_empty() {
        gpu.push(Outcome::Missing);
    }
    let pair = |gpu: Outcome<'r>| {
        let like = cpu.iter().filter(|c| gpu.threads().is_some() && c.threads() == gpu.threads());
        let cpu = like.chain(cpu.iter().max_by_key(|c| (c.row().is_some(), c.threads()))).next();
        Pair { cpu: cpu.copied().unwrap_or(Outcome::Missing), gpu }
    };
    gpu.into_iter().map(pair).collect()
}

fn of_pictures(gpu: &Picture, cpu: &Picture) -> Result<Apart, String> {
    apart(&view(gpu), &view(cpu)).map_err(|error| error.to_string())
}

/// A picture as the metrics see it.
fn view(picture: &Picture) -> halflight_metrics::Picture<'_> {
    let layout = match picture.layout {
        Layout::Image { width, height } => halflight_metrics::Layout::Image { width, height },
        Layout::List(_) => halflight_metrics::Layout::List,
    };
    halflight_metrics::Picture { radiance: &picture.radiance, valid: &picture.valid, layout }
}

/// A run on a graphics processor, held against the same on the processor.
#[derive(Clone, Debug, PartialEq)]
pub struct Twins {
    /// The cell on the graphics processor.
    pub gpu: Key,
    /// The same on the processor.
    pub cpu: Key,
    /// How far the first picture is from the second, or why they cannot be compared.
    pub apart: Result<Apart, String>,
}

/// Every run on a graphics processor in a store whose twin ran on the processor too.
pub fn twins(store: &Store) -> Vec<Twins> {
    let runs = || {
        store.outcomes().filter_map(|record| match record {
            Record::Run(run) => Some(&**run),
            _ => None,
        })
    };
    let picture = |run: &Run| match &run.image {
        Some(image) => store.read_picture(image).map_err(|error| error.to_string()),
        None => Err("expected a run with a picture".to_owned()),
    };
    // Of equals the first: they differ in where they were timed.
    let mut cpus: HashMap<Key, &Run> = HashMap::new();
    for run in runs().filter(|run| !run.cell.is_gpu()) {
        cpus.entry(run.cell.anywhere().key()).or_insert(run);
    }
    let twins = runs().filter(|run| run.cell.is_gpu()).filter_map(|gpu| {
        let cpu = cpus.get(&gpu.cell.anywhere().key())?;
        let apart = picture(gpu).and_then(|gpu| of_pictures(&gpu, &picture(cpu)?));
        Some(Twins { gpu: gpu.cell.key(), cpu: cpu.cell.key(), apart })
    });
    twins.collect()
}
