//! Carrying out a plan: the cells that are not in the store, then the scores that are not. Every result is in the store as
//! soon as it is there; what fails is a line too, and the rest goes on.
//!
//! Several processes on one store share the work: each claims the cell or reference that it is about to make, and leaves
//! what another has claimed for last.

mod timing;

use crate::Error;
use crate::calibrate::Calibrator;
use crate::execute::{Runner, Shaded, Task};
use crate::forecast::Forecast;
use crate::plan::{Group, Plan, State};
use crate::priority;
use crate::progress::Progress;
use crate::recorder::Recorder;
use crate::score::{self, Judgement, With};
use crate::todo::{Left, Todo};
use halflight_contract::{Cache, Support};
use halflight_references::{Quality, ReferenceStore};
use halflight_results::{Cell, Environment, Failure, Key, Record, ReferenceMade, Run, Skip, Store, StoreError};
use halflight_scenes::Frame;
use rayon::ThreadPool;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

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
    /// Wall time to spend; none for all of the plan. With a budget, the settings that say most come first, and one is not
    /// begun where the time that it may take, by what the store tells, is more than is left.
    pub budget: Option<Duration>,
}

impl Options {
    /// Timed evaluations a cell where nothing else is said: the fewest whose median has an interval of 95%.
    pub const REPEATS: usize = 6;

    /// Six repeats, references of the default quality, progress shown, no budget.
    pub fn new(cache: impl Into<PathBuf>) -> Self {
        Self {
            cache: cache.into(),
            repeats: Self::REPEATS,
            quality: Quality::default(),
            show_progress: true,
            budget: None,
        }
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
    /// Cells whose times were taken.
    pub timed: usize,
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
    /// Cells that were left out since the budget did not allow for them.
    pub left_out: usize,
}

/// Carries out a plan.
///
/// # Errors
/// The store or the cache cannot be written. Nothing else stops a run: a failing cell is a failure line and a count.
pub fn run(plan: &Plan, store: &mut Store, options: &Options) -> Result<Summary, Error> {
    let started = Instant::now();
    let scenes = Todo::all(plan, store, &options.quality);
    let steps = scenes.iter().map(|todo| todo.cells.len() + todo.untimed.len() + todo.judgements.len()).sum();
    let references = ReferenceStore::open(options.cache.join("references"))?;
    let progress = if options.show_progress { Progress::new(steps) } else { Progress::silent() };
    let environment = crate::environment();
    let forecast = Forecast::new(store, &environment, options.repeats);
    let left = Left::of(&scenes, &references);
    let (pools, calibrator) = (timing::pools(plan)?, Calibrator::new());
    let summary = Summary::default();
    let mut running = Running {
        plan,
        store,
        options,
        references,
        environment,
        progress,
        forecast,
        left,
        summary,
        pools: &pools,
        calibrator: &calibrator,
    };
    running.tell_expected();
    match options.budget {
        None => scenes.iter().try_for_each(|todo| running.scene(todo))?,
        Some(budget) => running.within(budget, started)?,
    }
    Ok(running.summary)
}

struct Running<'r> {
    plan: &'r Plan,
    store: &'r mut Store,
    options: &'r Options,
    references: ReferenceStore,
    environment: Environment,
    progress: Progress,
    forecast: Forecast,
    left: Left<'r>,
    summary: Summary,
    /// For groups that are timed on other threads than all else is done on.
    pools: &'r BTreeMap<usize, ThreadPool>,
    calibrator: &'r Calibrator,
}

impl<'r> Running<'r> {
    /// Runs what says most until the time is over.
    fn within(&mut self, budget: Duration, started: Instant) -> Result<(), StoreError> {
        let (plan, options) = (self.plan, self.options);
        for group in priority::order(plan, self.store) {
            let todo = Todo::new(plan, group.scene, std::iter::once(group), self.store, &options.quality);
            // What has run by now tells of the rest.
            self.forecast = Forecast::new(self.store, &self.environment, options.repeats);
            let references: Vec<_> = todo.to_make(&self.references).collect();
            let references = references.iter().map(|(_, work)| work);
            let expected = self.forecast.sum(todo.work(), references).seconds;
            let over = started.elapsed().as_secs_f64() + expected > budget.as_secs_f64();
            if over && todo.is_work() {
                self.summary.cached += todo.cached;
                self.summary.left_out += todo.cells.len();
                self.progress.note(&format!("{}: left out, over the budget", group.label(plan)));
            } else {
                self.scene(&todo)?;
            }
        }
        Ok(())
    }

    fn scene(&mut self, todo: &Todo<'r>) -> Result<(), StoreError> {
        self.store.refresh()?;
        self.summary.cached += todo.cached;
        for (cell, reason) in &todo.skipped {
            self.skip(cell, reason)?;
        }
        // Of this scene alone: its derived data are let go when it is done. What is costly lies in the folder.
        let cache = Cache::in_folder(&self.options.cache.join("derived"));
        let elsewhere = self.cells(todo, &todo.cells, &cache, false)?;
        self.cells(todo, &elsewhere, &cache, true)?;
        self.times(todo, &cache)?;
        let (references, quality) = (self.references.clone(), &self.options.quality);
        let with = With { references: &references, quality, seed: self.plan.seed, cache: &cache };
        let mut elsewhere = Vec::new();
        for judgement in &todo.judgements {
            match self.store.try_claim(&judgement.key)? {
                Some(_claim) => self.judge(todo, judgement, &with)?,
                None => elsewhere.push(judgement),
            }
        }
        for judgement in elsewhere {
            let _claim = self.store.claim(&judgement.key)?;
            self.judge(todo, judgement, &with)?;
        }
        Ok(())
    }

    fn skip(&mut self, cell: &Cell, reason: &str) -> Result<(), StoreError> {
        self.summary.skipped += 1;
        let record = Record::Skip(Skip { cell: cell.clone(), reason: reason.to_owned() });
        if self.store.outcome(&cell.key()) == Some(&record) { Ok(()) } else { self.append(record) }
    }

    fn task<'a>(&self, todo: &Todo<'a>, group: &'a Group, cache: &'a Cache) -> Task<'a> {
        let Group { method, ref params, quantity, backend, .. } = *group;
        Task { scene: todo.scene, method, params, quantity, backend, seed: self.plan.seed, cache }
    }

    /// Runs cells, and returns those that another process runs unless `waiting` for it.
    fn cells<'p>(
        &mut self,
        todo: &Todo<'_>,
        cells: &[(&'p Group, &'p Cell)],
        cache: &Cache,
        waiting: bool,
    ) -> Result<Vec<(&'p Group, &'p Cell)>, StoreError> {
        let mut elsewhere = Vec::new();
        for prepared in cells.chunk_by(|(a, _), (b, _)| a.preparation() == b.preparation()) {
            let Some((group, _)) = prepared.first() else { continue };
            let mut runner = Runner::new(self.task(todo, group, cache));
            elsewhere.extend(self.prepared(todo, prepared, &mut runner, waiting)?);
        }
        Ok(elsewhere)
    }

    /// As [`Running::cells`], of cells that share one `prepare`.
    fn prepared<'c, 'p: 'c>(
        &mut self,
        todo: &Todo<'_>,
        cells: &[(&'p Group, &'p Cell)],
        runner: &mut Runner<'c>,
        waiting: bool,
    ) -> Result<Vec<(&'p Group, &'p Cell)>, StoreError> {
        let mut elsewhere = Vec::new();
        for &(group, cell) in cells {
            let key = cell.key();
            let claim = if waiting { Some(self.store.claim(&key)?) } else { self.store.try_claim(&key)? };
            let Some(_claim) = claim else {
                elsewhere.push((group, cell));
                continue;
            };
            if cell.timed_on.is_none() {
                self.left.done(cell);
            }
            self.store.refresh()?;
            if group.state(cell, self.store) != State::Run {
                self.summary.cached += 1;
                self.progress.pass();
                continue;
            }
            let mut label = group.label(self.plan);
            if todo.frames.len() > 1 {
                label = format!("{label} frame {}", cell.frame);
            }
            let frame = &todo.frames[cell.frame as usize];
            let shown = self.with_time_left(&label);
            self.progress.begin(&shown);
            runner.tune(&group.params);
            let shaded =
                runner.shade(frame, &key, &mut |what, done, total| self.progress.within(&shown, what, done, total));
            self.finish(group, cell, frame, shaded, &label)?;
        }
        Ok(elsewhere)
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
            shared: shaded.shared,
            derived: shaded.recorded.derived,
            counters: shaded.recorded.counters,
            footprint: shaded.footprint,
            environment: Environment {
                threads: group.threads.unwrap_or(self.environment.threads),
                ..self.environment.clone()
            },
        };
        self.append(Record::Run(Box::new(run)))?;
        self.summary.ran += 1;
        self.progress.end(label, "run");
        Ok(())
    }

    /// Obtains a reference and scores the cells that wait for it.
    fn judge(&mut self, todo: &Todo<'_>, judgement: &Judgement, with: &With<'_>) -> Result<(), StoreError> {
        let label = format!("{} · {}", todo.scene.name, judgement.reference.id());
        self.left.references.remove(&judgement.key);
        let shown = self.with_time_left(&label);
        self.progress.begin(&shown);
        self.store.refresh()?;
        let cells: Vec<Key> = judgement.waiting(self.store).into_iter().cloned().collect();
        if cells.is_empty() {
            self.progress.pass();
            return Ok(());
        }
        let mut steps = |what: &str, done, total| self.progress.within(&shown, what, done, total);
        let frame = &todo.frames[judgement.frame];
        // Of one that was begun before, the time tells nothing.
        let begun = self.references.state(judgement.key.as_str()).is_some();
        let started = Instant::now();
        let judge = match judgement.judge(todo.scene, frame, with, self.store, &mut Recorder::new(&mut steps)) {
            Ok(judge) => judge,
            Err(error) => {
                self.summary.unjudged += 1;
                self.progress.end(&label, &format!("FAILED: {error}"));
                return Ok(());
            }
        };
        if judge.made && !begun {
            self.append(Record::Reference(ReferenceMade {
                scene: todo.scene.name.clone(),
                scene_hash: todo.scene.content.to_string(),
                frame: frame.index as u32,
                reference: judgement.reference.id(),
                reference_key: judgement.key.clone(),
                quantity: judgement.quantity.to_string(),
                receivers: frame.receivers.len(),
                nanoseconds: started.elapsed().as_nanos() as f64,
                environment: self.environment.clone(),
            }))?;
        }
        self.summary.references_made += usize::from(judge.made);
        for cell in cells {
            let Some(run) = self.store.run(&cell) else { continue };
            match score::score(run, &judgement.reference.id(), &judgement.key, self.store, &judge) {
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

    /// Says before the work how long it may take, where earlier runs tell.
    fn tell_expected(&self) {
        let expected = self.left.expected(&self.forecast);
        if expected.seconds > 0.0 {
            let references = match self.left.references.len() {
                0 => String::new(),
                count => format!(" and {count} references to make"),
            };
            let cells = self.left.cells.len();
            self.progress.note(&format!("{cells} cells to run{references}: {expected}, by earlier runs"));
        }
    }

    /// What is at hand, and how long the rest may take where earlier runs tell.
    fn with_time_left(&self, label: &str) -> String {
        let left = self.left.expected(&self.forecast);
        if left.seconds > 0.0 { format!("{label} · then {left}") } else { label.to_owned() }
    }

    fn append(&mut self, record: Record) -> Result<(), StoreError> {
        self.summary.lines += 1;
        self.store.append(record)
    }
}
