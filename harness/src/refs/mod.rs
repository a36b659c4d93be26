//! References by themselves: which a plan needs, made, checked and cleared away without running anything.

mod build;
mod check;
mod prune;

pub use build::{Built, build};
pub use check::{Checked, Retake, check, require};
pub use prune::{Pruned, Reason, prune};

use crate::plan::{Plan, Stage};
use halflight_contract::{Quantity, Support};
use halflight_references::{Quality, Reference, ReferenceStore, Request};
use halflight_scenes::Frame;
use std::collections::HashSet;
use std::path::Path;

/// A reference that a plan needs.
pub struct Need<'p> {
    /// The scene.
    pub stage: &'p Stage,
    /// Its frame.
    pub frame: &'p Frame,
    /// Which light.
    pub quantity: Quantity,
    /// Which reference.
    pub reference: Reference,
    /// How good it is to be.
    pub quality: &'p Quality,
    /// Seed of everything random.
    pub seed: u64,
}

impl Need<'_> {
    /// The request that it answers.
    pub fn request(&self) -> Request<'_> {
        let Need { quantity, frame, quality, seed, .. } = *self;
        Request { reference: &self.reference, quantity, scene: &self.stage.scene, frame, quality, seed }
    }

    /// `scene · reference · quantity`, with the frame where there are several.
    pub fn label(&self) -> String {
        let frame = if self.stage.frames.len() > 1 { format!(" · frame {}", self.frame.index) } else { String::new() };
        format!("{} · {} · {}{frame}", self.stage.scene.name, self.reference, self.quantity)
    }
}

/// Every reference that a plan's pictures are scored against, each once, scene by scene. `whatever` counts those as well
/// that no method of the plan has a picture for.
pub fn needed<'p>(plan: &'p Plan, quality: &'p Quality, whatever: bool) -> Vec<Need<'p>> {
    let mut keys = HashSet::new();
    let mut needs = Vec::new();
    for group in plan.groups.iter().filter(|group| whatever || !matches!(group.support, Support::Skip(_))) {
        let stage = &plan.scenes[group.scene];
        for frame in stage.frames.iter().filter(|frame| !group.empty.contains(&(frame.index as u32))) {
            for reference in &group.references {
                let (quantity, reference, seed) = (group.quantity, reference.clone(), plan.seed);
                let need = Need { stage, frame, quantity, reference, quality, seed };
                if keys.insert(need.request().key()) {
                    needs.push(need);
                }
            }
        }
    }
    needs
}

/// The store of references of a cache folder, for reading.
pub fn store(cache: &Path) -> ReferenceStore {
    ReferenceStore::at(cache.join("references"))
}
