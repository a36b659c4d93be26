//! Carrying out a plan: the cells that are not in the store, then the scores that are not. Every result is in the store as
//! soon as it is there; what fails is a line too, and the rest goes on.

use crate::Error;
use crate::execute::{Runner, Shaded, Task};
use crate::plan::{Group, Plan, Stage, State};
use crate::progress::Progress;
use crate::recorder::Recorder;
use crate::score::{self, Judgement, With};
use halflight_contract::{Cache, Support};
use halflight_references::{Quality, ReferenceStore, Request};
use halflight_results::{Cell, Environment, Failure, Key, Record, Run, Skip, Store, StoreError};
use halflight_scenes::{Frame, Scene};
use std::path::PathBuf;

/// How a plan is carried out; none of it is part of a cell's key.
#[derive(Clone, Debug)]
pub struct Options {
    /// Folder of derived data and references.
    pub cache: PathBuf,
    /// Timed evaluations a cell, at least 1.
    pub repeats: usize,
    /// How good references are to be.
    pub quality: Quality,
    /// Whether progress is shown on standard error.
    pub show_progress: bool,
}

impl Options {
    /// Five repeats, references of the default quality, progress shown.
    pub fn new(cache: impl Into<PathBuf>) -> Self {
        Self { cache: cache.into(), repeats: 5, quality: Quality::default(), show_progress: true }
    }
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Cells that were run.
    pub ran: usize,
    /// Cells whose result was in the store.
    pub cached: usize,
    /// Cells that their method does not serve.
    pub skipped: usize,
    /// Cells that failed.
    pub failed: usize,
    /// Scores that were added.
    pub scored: usize,
    /// References that were made.
    pub references_made: usize,
    /// References that could not be made, and scores that could not be taken.
    pub unjudged: usize,
    /// Lines that were added to the store.
    pub lines: usize,
}

/// Carries out a plan.
///
/// # Errors
/// The store or the cache cannot be written. Nothing else stops a run: a failing cell is a failure line and a count.
pub fn run(plan: &Plan, store: &mut Store, options: &Options) -> Result<Summary, Error> {
    let scenes: Vec<Todo> = (0..plan.scenes.len()).map(|scene| Todo::new(plan, scene, store, options)).collect();
    let steps = scenes.iter().map(|todo| todo.cells.len() + todo.judgements.len()).sum();
    let references = ReferenceStore::open(options.cache.join("references"))?;
    let progress = if options.show_progress { Progress::new(steps) } else { Progress::silent() };
    let environment = crate::environment();
    let mut running = Running { plan, store, options, references, environment, progress, summary: Summary::default() };
    for todo in &scenes {
        running.scene(todo)?;
    }
    Ok(running.summary)
}

/// What is to be done about one scene.
struct Todo<'p> {
    scene: &'p Scene,
    frames: &'p [Frame],
    /// Cells to run, those of a group in a row.
    cells: Vec<(&'p Group, &'p Cell)>,
    /// Cells that are skipped, with the reason.
    skipped: Vec<(&'p Cell, String)>,
    cached: usize,
    judgements: Vec<Judgement>,
}

impl<'p> Todo<'p> {
    fn new(plan: &'p Plan, index: usize, store: &Store, options: &Options) -> Self {
        let Stage { scene, frames } = &plan.scenes[index];
        let (cells, skipped, judgements) = (Vec::new(), Vec::new(), Vec::new());
        let mut todo = Self { scene, frames, cells, skipped, cached: 0, judgements };
        for (group, cell) in plan.cells().filter(|(group, _)| group.scene == index) {
            match group.state(cell, store) {
                State::Run => todo.cells.push((group, cell)),
                State::Cached => todo.cached += 1,
                State::Skip(why) => {
                    todo.skipped.push((cell, why));
                    continue;
                }
            }
            todo.judge(group, cell, plan.seed, store, &options.quality);
        }
        todo
    }

    /// Notes the references that a cell lacks a score against.
    fn judge(&mut self, group: &Group, cell: &Cell, seed: u64, store: &Store, quality: &Quality) {
        let frame = cell.frame as usize;
        let quantity = group.quantity;
        for reference in &group.references {
            let same = |j: &Judgement| j.frame == frame && j.quantity == quantity && j.reference == *reference;
            let known = self.judgements.iter().position(same);
            let key = match known {
                Some(known) => self.judgements[known].key.clone(),
                None => {
                    let (scene, frame) = (self.scene, &self.frames[frame]);
                    reference_key(&Request { reference, quantity, scene, frame, quality, seed }.key())
                }
            };
            if score::is_scored(&cell.key(), &key, store) {
                continue;
            }
            match known {
                Some(known) => self.judgements[known].cells.push(cell.key()),
                None => {
                    let (reference, cells) = (reference.clone(), vec![cell.key()]);
                    self.judgements.push(Judgement { frame, reference, quantity, key, cells });
                }
            }
        }
    }
}

struct Running<'r> {
    plan: &'r Plan,
    store: &'r mut Store,
    options: &'r Options,
    references: ReferenceStore,
    environment: Environment,
    progress: Progress,
    summary: Summary,
}

impl Running<'_> {
    fn scene(&mut self, todo: &Todo<'_>) -> Result<(), StoreError> {
        self.summary.cached += todo.cached;
        for (cell, reason) in &todo.skipped {
            self.skip(cell, reason)?;
        }
        // Of this scene alone: its derived data are let go when it is done. What is costly lies in the folder.
        let cache = Cache::in_folder(&self.options.cache.join("derived"));
        for cells in todo.cells.chunk_by(|(a, _), (b, _)| std::ptr::eq(*a, *b)) {
            self.group(todo, cells, &cache)?;
        }
        let (references, quality) = (self.references.clone(), &self.options.quality);
        let with = With { references: &references, quality, seed: self.plan.seed, cache: &cache };
        todo.judgements.iter().try_for_each(|judgement| self.judge(todo, judgement, &with))
    }

    fn skip(&mut self, cell: &Cell, reason: &str) -> Result<(), StoreError> {
        self.summary.skipped += 1;
        let record = Record::Skip(Skip { cell: cell.clone(), reason: reason.to_owned() });
        if self.store.outcome(&cell.key()) == Some(&record) { Ok(()) } else { self.append(record) }
    }

    /// Runs cells that share one `prepare`.
    fn group(&mut self, todo: &Todo<'_>, cells: &[(&Group, &Cell)], cache: &Cache) -> Result<(), StoreError> {
        let Some((group, _)) = cells.first() else { return Ok(()) };
        let mut runner = Runner::new(Task {
            scene: todo.scene,
            method: group.method,
            params: &group.params,
            quantity: group.quantity,
            backend: group.backend,
            seed: self.plan.seed,
            repeats: self.options.repeats,
            cache,
        });
        for (_, cell) in cells {
            let mut label = group.label(self.plan);
            if todo.frames.len() > 1 {
                label = format!("{label} frame {}", cell.frame);
            }
            let frame = &todo.frames[cell.frame as usize];
            self.progress.begin(&label);
            let shaded = runner.shade(frame, &mut |what, done, total| self.progress.within(&label, what, done, total));
            self.finish(group, cell, frame, shaded, &label)?;
        }
        Ok(())
    }

    fn finish(
        &mut self,
        group: &Group,
        cell: &Cell,
        frame: &Frame,
        shaded: Result<Shaded, String>,
        label: &str,
    ) -> Result<(), StoreError> {
        let shaded = match shaded {
            Ok(shaded) => shaded,
            Err(error) => {
                self.summary.failed += 1;
                self.progress.end(label, &format!("FAILED: {error}"));
                return self.append(Record::Failure(Failure { cell: cell.clone(), error }));
            }
        };
        let run = Run {
            cell: cell.clone(),
            receivers: frame.receivers.valid.iter().filter(|valid| **valid).count(),
            image: Some(score::write(self.store, &frame.receivers, shaded.radiance)?),
            approximate: match &group.support {
                Support::Approximate(why) => Some(why.clone()),
                _ => None,
            },
            phases: shaded.recorded.phases,
            derived: shaded.recorded.derived,
            counters: shaded.recorded.counters,
            footprint: shaded.footprint,
            environment: self.environment.clone(),
        };
        self.append(Record::Run(Box::new(run)))?;
        self.summary.ran += 1;
        self.progress.end(label, "run");
        Ok(())
    }

    /// Obtains a reference and scores the cells that wait for it.
    fn judge(&mut self, todo: &Todo<'_>, judgement: &Judgement, with: &With<'_>) -> Result<(), StoreError> {
        let label = format!("{} · {}", todo.scene.name, judgement.reference.id());
        self.progress.begin(&label);
        let cells = judgement.waiting(self.store);
        if cells.is_empty() {
            self.progress.pass();
            return Ok(());
        }
        let mut steps = |what: &str, done, total| self.progress.within(&label, what, done, total);
        let frame = &todo.frames[judgement.frame];
        let judge = match judgement.judge(todo.scene, frame, with, self.store, &mut Recorder::new(&mut steps)) {
            Ok(judge) => judge,
            Err(error) => {
                self.summary.unjudged += 1;
                self.progress.end(&label, &format!("FAILED: {error}"));
                return Ok(());
            }
        };
        self.summary.references_made += usize::from(judge.made);
        for cell in cells {
            match judgement.score(cell, self.store, &judge) {
                Ok(score) => {
                    self.summary.scored += 1;
                    self.append(Record::Score(score))?;
                }
                Err(error) => {
                    self.summary.unjudged += 1;
                    eprintln!("halflight: {label}: {error}");
                }
            }
        }
        self.progress.end(&label, if judge.made { "made" } else { "from the cache" });
        Ok(())
    }

    fn append(&mut self, record: Record) -> Result<(), StoreError> {
        self.summary.lines += 1;
        self.store.append(record)
    }
}

/// A reference's key as results write it.
pub(crate) fn reference_key(key: &str) -> Key {
    Key::try_from(key.to_owned()).unwrap_or_else(|_| Key::of_bytes(key.as_bytes()))
}
