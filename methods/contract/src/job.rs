//! The job: what `prepare` is given.

use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::sync::Arc;

use halflight_scenes::Scene;

use crate::derived::{Charge, SlotKey};
use crate::{Backend, Cache, Derived, Meter, Params, Result};

/// A scene, parameters, a seed, a backend and the cache of derived data.
///
/// It is not `Sync`, so that nobody derives inside a parallel loop and waits for himself.
pub struct Job<'s, 'c> {
    /// The scene to prepare for.
    pub scene: &'s Scene,
    /// The method's parameters, complete and in range.
    pub params: &'c Params,
    /// Seed of everything random.
    pub seed: u64,
    /// Backend to run on.
    pub backend: Backend,
    cache: &'c Cache,
    /// Nanoseconds that calls of `derive` on this job took, nested ones included.
    pub(crate) deriving: Cell<u64>,
    /// What each recipe that is being made has derived so far, the innermost last.
    pub(crate) recipes: RefCell<Vec<Vec<Charge>>>,
    /// What the meter was charged for.
    pub(crate) charged: RefCell<HashSet<SlotKey>>,
}

impl<'s, 'c> Job<'s, 'c> {
    /// Puts a job together.
    pub fn new(scene: &'s Scene, params: &'c Params, seed: u64, backend: Backend, cache: &'c Cache) -> Self {
        Job {
            scene,
            params,
            seed,
            backend,
            cache,
            deriving: Cell::default(),
            recipes: RefCell::default(),
            charged: RefCell::default(),
        }
    }

    /// Derived data, made on first need and shared from then on. Its build time goes to the meter's `derived`, also when
    /// it was made earlier, but once a job.
    pub fn derive<D: Derived>(&self, recipe: &D, meter: &mut dyn Meter) -> Result<Arc<D::Value>> {
        self.cache.derive(recipe, self, meter)
    }
}
