//! Ambient occlusion on the cores: 16 points side by side.

use halflight_contract::{Error, Flow, Footprint, Job, Meter, Output, Params, Prepared, Quantity, Result, timed};
use halflight_light::ShLight;
use halflight_scenes::{Frame, Receivers, Rgb};
use halflight_sh::{Batch, Block, LANES, clamped_cosine, coefficients};
use rayon::prelude::*;

use crate::INFO;
use crate::forest::accessibility;
use crate::lanes::Points;
use crate::stage::Stage;

/// Receivers that one task handles.
const CHUNK: usize = 16 * LANES;

/// Ambient occlusion made ready for a scene.
pub(crate) struct Occlusion {
    stage: Stage,
    /// Whether elements cast as they are now and as parameters ask.
    cast: bool,
    result: Vec<f32>,
}

impl Occlusion {
    /// Derives the light and orders the elements of all that casts.
    pub(crate) fn prepare(job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Self> {
        Ok(Occlusion { stage: Stage::derive(job, meter)?, cast: false, result: Vec::new() })
    }

    /// Shades the receivers from `first` on, and counts the nodes that were summed.
    fn chunk(&self, receivers: &Receivers, first: usize, out: &mut [f32]) -> u64 {
        let mut irradiance = Irradiance::new(&self.stage.lit);
        let valid: Vec<usize> = (first..first + out.len() / 3).filter(|&i| receivers.valid[i]).collect();
        let mut summed = 0;
        for group in valid.chunks(LANES) {
            let points = Points::new(group.iter().map(|&i| (receivers.position[i], receivers.normal[i])));
            let (shadow, terms) = self.stage.forest.shadow(&points, self.stage.opening());
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
        self.stage.footprint().host("result", size_of_val(self.result.as_slice()))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        self.stage.retune(params)?;
        self.cast = false;
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        let moved = self.stage.update(frame, meter);
        if !moved.is_empty() || !self.cast {
            let (passes, opening) = (self.stage.own_passes(), self.stage.opening());
            timed(meter, "passes among elements", |_| self.stage.forest.cast(passes, opening));
            self.cast = true;
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
        self.stage.report(receivers, summed, meter);
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        out.fill(Quantity::Direct, &self.result)
    }
}
