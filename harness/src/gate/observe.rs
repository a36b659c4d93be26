//! Measuring what a store holds of a plan.

use super::baselines::{coarse, rounded};
use super::pace::{Paces, Ratio};
use super::{Baselines, CellBaseline, Instructions, PACE, ReferenceBaseline, ScoreBaseline};
use crate::plan::{Group, Plan, Stage, State};
use crate::score::view;
use crate::suite::Entry;
use crate::todo::reference_key;
use halflight_contract::Params;
use halflight_metrics::{Fingerprint, VERSION, difference, fingerprint};
use halflight_references::{Quality, Reference, Request};
use halflight_results::{Cell, Key, Picture, Record, ReferencePicture, Run, Score, Store};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// What was measured, and what could not be.
#[derive(Clone, Debug, Default)]
pub struct Observed {
    /// What was measured, as it would be blessed.
    pub measured: Baselines,
    /// Shading times relative to [`super::PACE`], with their intervals.
    pub ratios: BTreeMap<String, Ratio>,
    /// What could not be measured, by cell or reference, and why.
    pub faults: Vec<(String, String)>,
    /// Cells that their method does not serve, and why.
    pub skipped: BTreeMap<String, String>,
    /// Commands that make a cell or a reference again.
    pub commands: BTreeMap<String, String>,
}

impl Observed {
    /// Takes in instructions that were counted.
    pub fn counted(&mut self, instructions: Instructions) {
        for method in instructions.counts.keys() {
            self.commands.insert(format!("instructions of {method}"), Instructions::command(method));
        }
        self.measured.instructions = instructions;
    }
}

/// Measures what the store holds of a plan that these entries ask for, with references of this quality.
pub fn observe(plan: &Plan, entries: &[Entry], store: &Store, quality: &Quality) -> Observed {
    let observed = Observed { measured: Baselines::new(), ..Observed::default() };
    let (judges, paces) = (HashMap::new(), Paces::default());
    let timings = BTreeMap::new();
    let mut observing = Observing { plan, entries, store, quality, judges, paces, timings, observed };
    plan.cells().for_each(|(group, cell)| observing.cell(group, cell));
    let mut observed = observing.observed;
    observed.ratios = observing.paces.ratios();
    for (method, command) in observing.timings {
        observed.commands.insert(method, command);
    }
    let ratios = observed.ratios.iter().map(|(method, ratio)| (method.clone(), (100.0 * ratio.ratio).round() / 100.0));
    observed.measured.paces = ratios.collect();
    observed
}

struct Observing<'o> {
    plan: &'o Plan,
    entries: &'o [Entry],
    store: &'o Store,
    quality: &'o Quality,
    /// References by their images, with their fingerprints.
    judges: HashMap<Key, Result<(ReferencePicture, Fingerprint), String>>,
    paces: Paces,
    /// Commands that time a method beside the pace, by method with its settings.
    timings: BTreeMap<String, String>,
    observed: Observed,
}

impl Observing<'_> {
    fn cell(&mut self, group: &Group, cell: &Cell) {
        let stage = &self.plan.scenes[group.scene];
        let set = settings(group);
        let method =
            format!("{}{}", group.method.info().id, set.iter().map(|set| format!(" {set}")).collect::<String>());
        let place = Place { stage, group, frame: cell.frame };
        let label = place.label(&method);
        let command = place.command(self.entries, self.plan.seed);
        let set: String = set.iter().map(|set| format!(" --set {set}")).collect();
        let run = format!("halflight run{command} --method {}{set}", group.method.info().id);
        // Results that are there already would not be timed again; with its settings, the pace would be another.
        let paced = format!("halflight run{command} --method {PACE} --out timed-again && {run} --out timed-again");
        self.timings.entry(method.clone()).or_insert(paced);
        if self.observed.commands.insert(label.clone(), run).is_some() {
            self.fault(&label, "two cells have this name: expected scenes of different names".into());
            return;
        }
        match self.measured(&place, cell, &method, &label) {
            Ok(Some(measured)) => drop(self.observed.measured.cells.insert(label, measured)),
            Ok(None) => {}
            Err(why) => self.fault(&label, why),
        }
    }

    fn fault(&mut self, label: &str, why: String) {
        self.observed.faults.push((label.to_owned(), why));
    }

    /// Measures one cell; `None` if its method does not serve it.
    fn measured(
        &mut self,
        place: &Place,
        cell: &Cell,
        method: &str,
        label: &str,
    ) -> Result<Option<CellBaseline>, String> {
        let Place { group, .. } = place;
        if let State::Skip(why) = group.state(cell, self.store) {
            self.observed.skipped.insert(label.to_owned(), why);
            return Ok(None);
        }
        let run = run_of(cell, self.store)?;
        let image = run.image.as_ref().ok_or("expected a picture, found a run without")?;
        let picture = self.store.read_picture(image).map_err(|e| e.to_string())?;
        let print = printed(&picture, &vec![Default::default(); picture.radiance.len()])?;
        if group.references.is_empty() {
            return Err("no reference judges it, expected one at least".into());
        }
        let mut errors = BTreeMap::new();
        for reference in &group.references {
            match self.judged(place, &picture, cell, reference) {
                Ok(score) => drop(errors.insert(place.label(&reference.id()), score)),
                Err(why) => self.fault(label, format!("against {reference}: {why}")),
            }
        }
        if let Some(times) = self.store.times(&cell.key()) {
            self.paces.add(&place.label(""), method, times);
        }
        Ok(Some(CellBaseline {
            receivers: print.receivers,
            level: rounded(print.level),
            blocks: print.blocks.iter().map(|block| block.map(|block| block.mean.map(rounded))).collect(),
            errors,
            memory: memory(run),
            work: run.counters.clone(),
        }))
    }

    /// The errors of a picture against one reference, which is measured too.
    fn judged(
        &mut self,
        place: &Place,
        picture: &Picture,
        cell: &Cell,
        reference: &Reference,
    ) -> Result<ScoreBaseline, String> {
        let (group, frame) = (place.group, &place.stage.frames[cell.frame as usize]);
        let (quantity, scene, seed) = (group.quantity, &place.stage.scene, self.plan.seed);
        let key = Request { reference, quantity, scene, frame, quality: self.quality, seed }.key();
        let score: Option<&Score> = self.store.score(&cell.key(), &reference_key(&key), VERSION);
        let image = &score.ok_or("the reference is missing: expected a score in the store")?.reference_image;
        let store = self.store;
        let judge = self.judges.entry(image.clone()).or_insert_with(|| {
            let judge = store.read_reference(image).map_err(|e| e.to_string())?;
            let print = printed(&judge.picture(), &judge.variance)?;
            Ok((judge, print))
        });
        let (judge, print) = judge.as_ref().map_err(Clone::clone)?;
        let known = known(key, print);
        let label = place.label(&reference.id());
        let zeros = vec![Default::default(); picture.radiance.len()];
        let apart = difference(&view(picture), &zeros, &view(&judge.picture()), &judge.variance);
        let apart = apart.map_err(|e| e.to_string())?;
        let command = place.command(self.entries, self.plan.seed);
        let command = format!("halflight refs build{command} --reference {reference}");
        self.observed.commands.insert(label.clone(), command);
        let before = self.observed.measured.references.insert(label.clone(), known.clone());
        if before.is_some_and(|before| before != known) {
            self.fault(&label, "two pictures bear its name: expected all cells to be scored against one".into());
        }
        Ok(ScoreBaseline {
            rmse: rounded(apart.rmse),
            rmse_error: coarse(apart.rmse_error),
            bias: rounded(apart.bias),
            bias_error: coarse(apart.bias_error),
            effective: coarse(apart.effective),
        })
    }
}

/// A scene's frame, and what is computed there.
struct Place<'p> {
    stage: &'p Stage,
    group: &'p Group,
    frame: u32,
}

impl Place<'_> {
    /// `scene · what · quantity`, with the frame where there are several.
    fn label(&self, what: &str) -> String {
        let frame = if self.stage.frames.len() > 1 { format!(" · frame {}", self.frame) } else { String::new() };
        format!("{} · {what} · {}{frame}", self.stage.scene.name, self.group.quantity)
    }

    /// The part of a command line that picks it.
    fn command(&self, entries: &[Entry], seed: u64) -> String {
        let name = &self.stage.scene.name;
        let mut asked = entries.iter().flat_map(|entry| &entry.scenes);
        let is_asked = |asked: &&String| {
            let (path, factor) = asked.split_at(asked.rfind('@').unwrap_or(asked.len()));
            Path::new(path).file_stem().is_some_and(|stem| format!("{}{factor}", stem.display()) == *name)
        };
        let scene = asked.find(is_asked);
        let mut command = format!(" --scene {}", scene.unwrap_or(name));
        if self.group.quantity != halflight_contract::Quantity::Direct {
            command += &format!(" --quantity {}", self.group.quantity);
        }
        if seed != 1 {
            command += &format!(" --seed {seed}");
        }
        command
    }
}

/// The parameters that are not at their default, `name=value`.
fn settings(group: &Group) -> Vec<String> {
    let defaults = Params::defaults(group.method.info().params);
    let changed = group.params.iter().zip(defaults.iter()).filter(|(value, default)| value != default);
    changed.map(|((name, value), _)| format!("{name}={value}")).collect()
}

fn run_of<'s>(cell: &Cell, store: &'s Store) -> Result<&'s Run, String> {
    match store.outcome(&cell.key()) {
        Some(Record::Run(run)) => Ok(run),
        Some(Record::Failure(failure)) => Err(format!("expected a picture, found a failure: {}", failure.error)),
        _ => Err("expected a picture, found no run in the store".into()),
    }
}

/// The fingerprint of what has light in it: black agrees with black and tells nothing.
fn printed(picture: &Picture, variance: &[glam::Vec3]) -> Result<Fingerprint, String> {
    let print = fingerprint(&view(picture), variance).map_err(|e| e.to_string())?;
    if print.level > 0.0 { Ok(print) } else { Err("black at every receiver, expected light".into()) }
}

fn known(key: String, print: &Fingerprint) -> ReferenceBaseline {
    let blocks = print
        .blocks
        .iter()
        .map(|block| block.map(|block| (block.mean.map(rounded), block.error.map(coarse), coarse(block.effective))));
    ReferenceBaseline { key, receivers: print.receivers, level: rounded(print.level), blocks: blocks.collect() }
}

fn memory(run: &Run) -> BTreeMap<String, u64> {
    let mut memory = BTreeMap::new();
    for held in &run.footprint {
        for (purpose, bytes) in
            [(held.purpose.clone(), held.host_bytes), (format!("{} (device)", held.purpose), held.device_bytes)]
        {
            if bytes > 0 {
                *memory.entry(purpose).or_default() += bytes;
            }
        }
    }
    memory
}
