//! The phases: topology once, elements and their own accessibility a frame, then receivers.

use std::sync::Arc;

use halflight_contract::{
    Error, Flow, Footprint, Job, Meter, Output, Params, Prepared, Quantity, Result, counted, timed,
};
use halflight_light::{LightOf, SceneLight, ShLight};
use halflight_scenes::{Frame, Pose, Receivers, Revision, Rgb};
use halflight_sh::{Batch, Block, LANES, clamped_cosine, coefficients};
use rayon::prelude::*;

use crate::forest::{Forest, Tree, accessibility};
use crate::lanes::Points;
use crate::sites::sites;
use crate::{ELEMENTS, INFO, OPENING, ORDER, PASSES};

/// Receivers that one task handles.
const CHUNK: usize = 16 * LANES;

/// An object that casts.
struct Caster {
    object: usize,
    tree: Tree,
    /// What its elements are fitted to.
    revision: Option<Revision>,
}

/// Ambient occlusion made ready for a scene.
pub(crate) struct Occlusion {
    params: Params,
    light: Arc<SceneLight>,
    /// The light now.
    lit: ShLight,
    casters: Vec<Caster>,
    forest: Forest,
    /// Whether elements cast as they are now and as parameters ask.
    cast: bool,
    result: Vec<f32>,
}

impl Occlusion {
    /// Derives the light and orders the elements of all that casts.
    pub(crate) fn prepare(job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Self> {
        let light = job.derive(&LightOf { order: job.params.int(ORDER.name) }, meter)?;
        let most = job.params.int(ELEMENTS.name);
        let mut forest = Forest::default();
        let mut plant = |(object, shape)| {
            let tree = forest.plant(&sites(shape, Pose::IDENTITY, most), most);
            Caster { object, tree, revision: None }
        };
        let casting = job.scene.objects.iter().enumerate().filter(|(_, object)| object.casts);
        let casters = casting.map(|(i, object)| plant((i, &*object.shape))).collect();
        Ok(Occlusion {
            params: job.params.clone(),
            lit: light.still.clone(),
            light,
            casters,
            forest,
            cast: false,
            result: Vec::new(),
        })
    }

    fn opening(&self) -> f32 {
        self.params.float(OPENING.name) as f32
    }

    /// Shades the receivers from `first` on, and counts the nodes that were summed.
    fn chunk(&self, receivers: &Receivers, first: usize, out: &mut [f32]) -> u64 {
        let mut irradiance = Irradiance::new(&self.lit);
        let valid: Vec<usize> = (first..first + out.len() / 3).filter(|&i| receivers.valid[i]).collect();
        let mut summed = 0;
        for group in valid.chunks(LANES) {
            let points = Points::new(group.iter().map(|&i| (receivers.position[i], receivers.normal[i])));
            let (shadow, terms) = self.forest.shadow(&points, self.opening());
            let light = irradiance.at(&points);
            for (lane, &i) in group.iter().enumerate() {
                let light = Rgb::from_array([0, 1, 2].map(|channel| light[channel].0[lane]));
                let radiance = receivers.albedo[i] * light * accessibility(shadow[lane]);
                out[3 * (i - first)..][..3].copy_from_slice(&radiance.to_array());
                summed += u64::from(terms[lane]);
            }
        }
        summed
    }
}

/// Irradiance over π of light in SH at 16 normals.
struct Irradiance<'a> {
    light: &'a ShLight,
    batch: Batch,
    cosine: Vec<Block<f32>>,
    weights: Vec<Block<f32>>,
}

impl<'a> Irradiance<'a> {
    fn new(light: &'a ShLight) -> Self {
        let cosine = clamped_cosine(light.order).iter().map(|&value| Block::splat(value as f32)).collect();
        let weights = vec![Block::ZERO; coefficients(light.order)];
        Irradiance { light, batch: Batch::new(light.order), cosine, weights }
    }

    fn at(&mut self, points: &Points) -> [Block<f32>; 3] {
        self.batch.rotate_zonal(&self.cosine, &[points.normal.map(Block)], &mut self.weights);
        [0, 1, 2].map(|channel| self.batch.dot(&self.light.rgb[channel], &self.weights))
    }
}

impl Prepared for Occlusion {
    fn footprint(&self) -> Footprint {
        Footprint::default()
            .host("elements", self.forest.bytes())
            .host("light (shared)", self.light.bytes())
            .host("result", size_of_val(self.result.as_slice()))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        params.retune(&mut self.params, INFO.params)?;
        self.cast = false;
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        let most = self.params.int(ELEMENTS.name);
        meter.begin("fit elements");
        for caster in &mut self.casters {
            let posed = &frame.objects[caster.object];
            if caster.revision != Some(posed.revision) {
                self.forest.fit(caster.tree.clone(), &sites(&posed.shape, posed.pose, most));
                caster.revision = Some(posed.revision);
                self.cast = false;
            }
        }
        meter.end();
        if !self.cast {
            let (passes, opening) = (self.params.int(PASSES.name) - 1, self.opening());
            timed(meter, "passes among elements", |_| self.forest.cast(passes, opening));
            self.cast = true;
        }
        if !self.light.turning.is_empty() {
            self.lit = timed(meter, "turn light", |_| self.light.at(frame.time).into_owned());
        }
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        if quantity != Quantity::Direct {
            return Err(Error::Unsupported { method: INFO.id, what: quantity.to_string() });
        }
        let receivers = frame.receivers.as_ref();
        self.result.clear();
        self.result.resize(3 * receivers.len(), 0.0);
        if meter.progress("receivers", 0, receivers.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        let mut result = std::mem::take(&mut self.result);
        let chunks = result.par_chunks_mut(3 * CHUNK).enumerate();
        let summed = timed(meter, "occlude and shade", |_| {
            chunks.map(|(chunk, out)| self.chunk(receivers, chunk * CHUNK, out)).sum()
        });
        self.result = result;
        let valid = receivers.valid.iter().filter(|valid| **valid).count() as u64;
        let elements = self.forest.elements() as u64;
        counted(meter, &[("receivers", valid), ("elements", elements), ("shadows summed", summed)]);
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        out.fill(Quantity::Direct, &self.result)
    }
}
