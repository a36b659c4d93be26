//! What is to be done about a scene: cells to run, and references that they lack a score against.

use crate::forecast::{Expected, Forecast, ReferenceWork};
use crate::plan::{Group, Plan, Stage, State};
use crate::score::{self, Judgement};
use halflight_references::{Quality, ReferenceStore, Request};
use halflight_results::{Cell, Key, Store};
use halflight_scenes::{Frame, Scene};
use std::collections::HashMap;

/// A cell with its group.
pub(crate) type Planned<'p> = (&'p Group, &'p Cell);

/// What is to be done about one scene.
pub(crate) struct Todo<'p> {
    pub(crate) scene: &'p Scene,
    pub(crate) frames: &'p [Frame],
    /// Cells to run, those of a group in a row.
    pub(crate) cells: Vec<Planned<'p>>,
    /// Cells whose times are to be taken, those of a group in a row.
    pub(crate) untimed: Vec<Planned<'p>>,
    /// Cells that are skipped, with the reason.
    pub(crate) skipped: Vec<(&'p Cell, String)>,
    pub(crate) cached: usize,
    pub(crate) judgements: Vec<Judgement>,
}

impl<'p> Todo<'p> {
    /// Of every scene of a plan.
    pub(crate) fn all(plan: &'p Plan, store: &Store, quality: &Quality) -> Vec<Self> {
        let of_scene = |scene: usize| plan.groups.iter().filter(move |group| group.scene == scene);
        (0..plan.scenes.len()).map(|scene| Self::new(plan, scene, of_scene(scene), store, quality)).collect()
    }

    /// Of these groups, all on the scene of this index.
    pub(crate) fn new(
        plan: &'p Plan,
        index: usize,
        groups: impl Iterator<Item = &'p Group>,
        store: &Store,
        quality: &Quality,
    ) -> Self {
        let Stage { scene, frames } = &plan.scenes[index];
        let (cells, untimed, skipped, judgements) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut todo = Self { scene, frames, cells, untimed, skipped, cached: 0, judgements };
        for (group, cell) in groups.flat_map(|group| group.cells.iter().map(move |cell| (group, cell))) {
            let state = group.state(cell, store);
            if matches!(state, State::Run | State::Time) && cell.timed_on.is_some() {
                todo.untimed.push((group, cell));
            }
            match state {
                State::Run => todo.cells.push((group, cell)),
                State::Time | State::Cached => todo.cached += 1,
                State::Skip(why) => {
                    todo.skipped.push((cell, why));
                    continue;
                }
            }
            todo.judge(group, cell, plan.seed, store, quality);
        }
        todo
    }

    pub(crate) fn is_work(&self) -> bool {
        !self.cells.is_empty() || !self.untimed.is_empty() || !self.judgements.is_empty()
    }

    /// Every cell that is to be run or timed, once.
    pub(crate) fn work(&self) -> impl Iterator<Item = Planned<'p>> + '_ {
        let not_timed = self.cells.iter().filter(|(_, cell)| cell.timed_on.is_none());
        not_timed.chain(&self.untimed).copied()
    }

    /// The references among those that are lacking that are not in the cache, by their keys.
    pub(crate) fn to_make(&self, references: &ReferenceStore) -> impl Iterator<Item = (Key, ReferenceWork)> {
        let missing = self.judgements.iter().filter(|j| !references.path(j.key.as_str()).exists());
        missing.map(|judgement| (judgement.key.clone(), self.to_be_made(judgement)))
    }

    fn to_be_made(&self, judgement: &Judgement) -> ReferenceWork {
        ReferenceWork {
            scene_hash: self.scene.content.to_string(),
            reference: judgement.reference.id(),
            quantity: judgement.quantity.to_string(),
            receivers: self.frames[judgement.frame].receivers.len(),
        }
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

/// What is still to be done about a plan.
pub(crate) struct Left<'p> {
    pub(crate) cells: Vec<Planned<'p>>,
    /// References that are not in the cache.
    pub(crate) references: HashMap<Key, ReferenceWork>,
}

impl<'p> Left<'p> {
    pub(crate) fn new(plan: &'p Plan, store: &Store, references: &ReferenceStore, quality: &Quality) -> Self {
        Self::of(&Todo::all(plan, store, quality), references)
    }

    pub(crate) fn of(scenes: &[Todo<'p>], references: &ReferenceStore) -> Self {
        Self {
            cells: scenes.iter().flat_map(Todo::work).collect(),
            references: scenes.iter().flat_map(|todo| todo.to_make(references)).collect(),
        }
    }

    pub(crate) fn done(&mut self, cell: &Cell) {
        self.cells.retain(|(_, left)| !std::ptr::eq(*left, cell));
    }

    pub(crate) fn expected(&self, forecast: &Forecast) -> Expected {
        forecast.sum(self.cells.iter().copied(), self.references.values())
    }
}

/// A reference's key as results write it.
pub(crate) fn reference_key(key: &str) -> Key {
    Key::try_from(key.to_owned()).unwrap_or_else(|_| Key::of_bytes(key.as_bytes()))
}
