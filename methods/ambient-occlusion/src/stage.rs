//! What there is to be seen at a time: the elements of all that casts, and the light, whatever computes with them.

use std::sync::Arc;

use halflight_contract::{Footprint, Job, Meter, Params, Result, counted, timed};
use halflight_light::{LightOf, SceneLight, ShLight};
use halflight_scenes::{Frame, Pose, Receivers, Revision};

use crate::forest::{Forest, Tree};
use crate::sites::sites;
use crate::{ELEMENTS, INFO, OPENING, ORDER, PASSES};

/// Elements and light of a scene, carried along with its frames.
pub(crate) struct Stage {
    params: Params,
    light: Arc<SceneLight>,
    /// The light now.
    pub(crate) lit: ShLight,
    casters: Vec<Caster>,
    pub(crate) forest: Forest,
}

/// An object that casts.
struct Caster {
    object: usize,
    tree: Tree,
    /// What its elements are fitted to.
    revision: Option<Revision>,
}

impl Stage {
    /// Derives the light and orders the elements of all that casts.
    pub(crate) fn derive(job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Self> {
        let light = job.derive(&LightOf { order: job.params.int(ORDER.name) }, meter)?;
        let most = job.params.int(ELEMENTS.name);
        let mut forest = Forest::default();
        let mut plant = |(object, shape)| {
            let tree = forest.plant(&sites(shape, Pose::IDENTITY, most), most);
            Caster { object, tree, revision: None }
        };
        let casting = job.scene.objects.iter().enumerate().filter(|(_, object)| object.casts);
        let casters = casting.map(|(i, object)| plant((i, &*object.shape))).collect();
        Ok(Stage { params: job.params.clone(), lit: light.still.clone(), light, casters, forest })
    }

    /// Takes parameters that differ in what `update` reads.
    pub(crate) fn retune(&mut self, params: &Params) -> Result<()> {
        params.retune(&mut self.params, INFO.params)
    }

    /// Follows what moves: the trees that did.
    pub(crate) fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Vec<Tree> {
        let most = self.params.int(ELEMENTS.name);
        let mut moved = Vec::new();
        meter.begin("fit elements");
        for caster in &mut self.casters {
            let posed = &frame.objects[caster.object];
            if caster.revision != Some(posed.revision) {
                self.forest.fit(caster.tree.clone(), &sites(&posed.shape, posed.pose, most));
                caster.revision = Some(posed.revision);
                moved.push(caster.tree.clone());
            }
        }
        meter.end();
        if self.turns() {
            self.lit = timed(meter, "turn light", |_| self.light.at(frame.time).into_owned());
        }
        moved
    }

    /// Whether light moves.
    pub(crate) fn turns(&self) -> bool {
        !self.light.turning.is_empty()
    }

    /// The share of its distance up to which a group's radius may go.
    pub(crate) fn opening(&self) -> f32 {
        self.params.float(OPENING.name) as f32
    }

    /// Passes among the elements themselves.
    pub(crate) fn own_passes(&self) -> usize {
        self.params.int(PASSES.name) - 1
    }

    /// The trees of all that casts.
    #[cfg(feature = "gpu")]
    pub(crate) fn trees(&self) -> impl Iterator<Item = &Tree> {
        self.casters.iter().map(|caster| &caster.tree)
    }

    /// Tells what was done.
    pub(crate) fn report(&self, receivers: &Receivers, summed: u64, meter: &mut dyn Meter) {
        let valid = receivers.valid.iter().filter(|valid| **valid).count() as u64;
        let elements = self.forest.elements() as u64;
        counted(meter, &[("receivers", valid), ("elements", elements), ("shadows summed", summed)]);
    }

    /// Memory held.
    pub(crate) fn footprint(&self) -> Footprint {
        Footprint::default().host("elements", self.forest.bytes()).host("light (shared)", self.light.bytes())
    }
}
