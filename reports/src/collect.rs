//! From the store to a report's data.

use crate::labels::{Labels, SceneNames};
use crate::{Absent, CrossCheck, Reference, Report, Row, Scene, calibration};
use halflight_results::{Cell, Key, Picture, Record, Run, Score, Store};
use std::collections::BTreeMap;

/// Assembles a report from everything in the store: the latest outcome of every cell, in the order of first appearance.
///
/// A picture that is missing or damaged is left out with a warning in the report; it does not stop the rest.
pub fn build(store: &Store, title: &str) -> Report {
    assemble(store, title, true)
}

/// As [`build`], without reading any picture.
pub fn outline(store: &Store, title: &str) -> Report {
    assemble(store, title, false)
}

fn assemble(store: &Store, title: &str, pictures: bool) -> Report {
    let cells = || store.outcomes().filter_map(Record::cell);
    let mut collector = Collector {
        store,
        pictures,
        labels: Labels::of(cells()),
        names: SceneNames::of(cells()),
        report: Report { warnings: store.warnings().to_vec(), ..Report::empty(title) },
    };
    for record in store.outcomes() {
        match record {
            Record::Run(run) => collector.run(run),
            Record::Skip(skip) => {
                let absent = collector.absent(&skip.cell, &skip.reason);
                collector.report.skips.push(absent);
            }
            Record::Failure(failure) => {
                let absent = collector.absent(&failure.cell, &failure.error);
                collector.report.failures.push(absent);
            }
            Record::Times(_)
            | Record::Score(_)
            | Record::Reference(_)
            | Record::CrossCheck(_)
            | Record::Measured(_) => {}
        }
    }
    for record in store.cross_checks() {
        let check = CrossCheck {
            record: record.clone(),
            ours: collector.picture(&record.ours),
            theirs: collector.picture(&record.theirs),
            receiver_p: collector.picture(&record.receiver_p),
        };
        collector.report.cross_checks.push(check);
    }
    let mut report = collector.report;
    report.warnings.extend(calibration::warning(report.scenes.iter().flat_map(|scene| &scene.rows)));
    for scene in &mut report.scenes {
        scene.rows.sort_by_key(|row| row.label);
        // A stable sort: `truth` first, the others as they came.
        scene.references.sort_by_key(|reference| reference.id != "truth");
    }
    report
}

struct Collector<'a> {
    store: &'a Store,
    pictures: bool,
    labels: Labels,
    names: SceneNames,
    report: Report,
}

impl Collector<'_> {
    fn run(&mut self, run: &Run) {
        if !self.report.environments.contains(&run.environment) {
            self.report.environments.push(run.environment.clone());
        }
        let label = self.label(&run.cell);
        let scores = newest(self.store.scores(&run.cell.key()));
        let picture = run.image.as_ref().and_then(|image| self.picture(image));
        // Whatever a store says: the cores' times are no processor's that they stand for.
        let times = self.store.times(&run.cell.key()).filter(|_| !run.cell.is_software()).cloned();
        let scene = self.scene(&run.cell);
        for score in &scores {
            self.reference(scene, score);
        }
        self.report.scenes[scene].rows.push(Row { label, run: run.clone(), picture, times, scores });
    }

    fn absent(&mut self, cell: &Cell, why: &str) -> Absent {
        Absent { cell: cell.clone(), scene: self.names.name(cell), label: self.label(cell), why: why.to_owned() }
    }

    fn label(&mut self, cell: &Cell) -> usize {
        let label = self.labels.label(cell);
        let known = self.report.labels.iter().position(|l| *l == label);
        known.unwrap_or_else(|| {
            self.report.labels.push(label);
            self.report.methods.push(cell.method.clone());
            self.report.settings.push(self.labels.setting(cell));
            self.report.labels.len() - 1
        })
    }

    fn scene(&mut self, cell: &Cell) -> usize {
        let name = self.names.name(cell);
        let known = self.report.scenes.iter().position(|s| s.name == name);
        known.unwrap_or_else(|| {
            self.report.scenes.push(Scene { name, references: Vec::new(), rows: Vec::new() });
            self.report.scenes.len() - 1
        })
    }

    fn reference(&mut self, scene: usize, score: &Score) {
        let section = &self.report.scenes[scene];
        if section.references.iter().all(|r| r.id != score.reference) {
            let picture = self.picture(&score.reference_image);
            let reference = Reference { id: score.reference.clone(), picture };
            self.report.scenes[scene].references.push(reference);
        }
        let section = &self.report.scenes[scene];
        let others = section.rows.iter().filter_map(|row| row.score(&score.reference));
        if others.into_iter().any(|other| other.reference_image != score.reference_image) {
            let warning = format!(
                "scene {}: its runs were scored against different pictures of the reference `{}`: their errors are not \
                 strictly comparable; score them again",
                section.name, score.reference
            );
            self.warn(warning);
        }
    }

    fn picture(&mut self, image: &Key) -> Option<Picture> {
        if !self.pictures {
            return None;
        }
        match self.store.read_picture(image) {
            Ok(picture) => Some(picture),
            Err(error) => {
                self.warn(format!("picture left out: {error}"));
                None
            }
        }
    }

    fn warn(&mut self, warning: String) {
        if !self.report.warnings.contains(&warning) {
            self.report.warnings.push(warning);
        }
    }
}

/// One score a reference: of the newest metrics, and of those the latest.
fn newest(scores: Vec<&Score>) -> Vec<Score> {
    let mut best: BTreeMap<&str, &Score> = BTreeMap::new();
    for score in scores {
        let held = best.entry(&score.reference).or_insert(score);
        if score.metrics >= held.metrics {
            *held = score;
        }
    }
    best.into_values().cloned().collect()
}
