//! Ambient occlusion on a graphics processor: a thread a receiver.
//!
//! `prepare` orders the elements on the cores, as for [`crate::cpu`], and compiles. `update` uploads elements that moved and has them cast
//! on each other; `evaluate` shades; results stay on the device until `read`. Each file under `wgsl` tells which function is its twin.

use std::sync::Arc;

use halflight_contract::{Error, Flow, Footprint, Job, Meter, Output, Params, Prepared, Quantity, Result, timed};
use halflight_gpu::{Gpu, Part, Pass, Resident};
use halflight_scenes::{Frame, Receivers};

use crate::INFO;
use crate::forest::Tree;
use crate::stage::Stage;
use shaders::{Pipelines, Shaders};

mod shaders;
#[cfg(test)]
mod tests;
mod work;

/// A receiver as the shader sees it: position, normal and albedo, each padded.
type Receiver = [[f32; 4]; 3];
/// What the shaders count: nodes summed, those of them that face the point, walks that did not come to their end.
type Counted = [u64; 3];

/// Ambient occlusion made ready for a scene.
pub(crate) struct Occlusion {
    gpu: Arc<Gpu>,
    stage: Stage,
    pipelines: Pipelines,
    /// Whether elements are on the device as they are now and as parameters ask.
    cast: bool,
    forest: Resident,
    places: Resident,
    normals: Resident,
    casting: Resident,
    /// Nodes by height, each level from a multiple of 64 on.
    levels: Resident,
    /// Where a level begins, and its length.
    level: Vec<[u64; 2]>,
    light: Resident,
    receivers: Resident,
    results: Resident,
    counters: Resident,
    /// The receivers' numbers by their place on the device, of how many.
    valid: Vec<u32>,
    count: usize,
}

impl Occlusion {
    /// Opens the device, derives the light, orders the elements of all that casts, compiles.
    pub(crate) fn prepare(job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Self> {
        let gpu = timed(meter, "open device", |_| Gpu::shared(job.backend))?;
        Self::with_shaders(gpu, Stage::derive(job, meter)?, Shaders::new, meter)
    }

    /// The same with other shaders, by the light's order.
    fn with_shaders(
        gpu: Arc<Gpu>,
        stage: Stage,
        shaders: impl FnOnce(usize) -> Shaders,
        meter: &mut dyn Meter,
    ) -> Result<Self> {
        let shaders = shaders(stage.lit.order);
        let pipelines = timed(meter, "compile shaders", |_| shaders.compile(&gpu))?;
        let mut occlusion = Occlusion {
            gpu,
            stage,
            pipelines,
            cast: false,
            forest: Resident::new("forest"),
            places: Resident::new("places"),
            normals: Resident::new("normals"),
            casting: Resident::new("casting"),
            levels: Resident::new("levels"),
            level: Vec::new(),
            light: Resident::new("light"),
            receivers: Resident::new("receivers"),
            results: Resident::new("results"),
            counters: Resident::new("counters"),
            valid: Vec::new(),
            count: 0,
        };
        timed(meter, "upload forest", |meter| occlusion.plant(meter))?;
        Ok(occlusion)
    }

    /// Uploads what never changes, and makes room for what does.
    fn plant(&mut self, meter: &mut dyn Meter) -> Result<()> {
        let mut nodes = Vec::new();
        for level in self.stage.forest.levels() {
            self.level.push([nodes.len() as u64, level.len() as u64]);
            nodes.extend(level);
            nodes.resize(nodes.len().next_multiple_of(64), 0);
        }
        self.levels.upload(&self.gpu, meter, &nodes)?;
        self.forest.upload(&self.gpu, meter, &self.stage.forest.topology())?;
        let bytes = 16 * self.stage.forest.nodes() as u64;
        for buffer in [&mut self.places, &mut self.normals, &mut self.casting] {
            buffer.reserve(&self.gpu, bytes)?;
        }
        Ok(())
    }

    /// Uploads the elements of trees.
    fn fit(&self, trees: &[Tree], meter: &mut dyn Meter) -> Result<()> {
        let forest = &self.stage.forest;
        for nodes in joined(trees) {
            self.places.write(&self.gpu, meter, nodes.start, &forest.places(nodes.clone(), self.stage.opening()))?;
            self.normals.write(&self.gpu, meter, nodes.start, &forest.normals(nodes))?;
        }
        Ok(())
    }

    /// Uploads receivers that are not there yet.
    fn place(&mut self, receivers: &Receivers, meter: &mut dyn Meter) -> Result<()> {
        let valid = &mut self.valid;
        self.count = receivers.len();
        Ok(self.receivers.sync(&self.gpu, receivers.revision, meter, || {
            *valid = (0..receivers.len() as u32).filter(|&i| receivers.valid[i as usize]).collect();
            valid.iter().map(|&i| receiver(receivers, i as usize)).collect()
        })?)
    }

    /// Has elements cast as far as they are accessible: themselves first, then level by level the groups that they form.
    fn cast(&mut self, meter: &mut dyn Meter) -> Result<()> {
        let Some((&elements, groups)) = self.level.split_first() else { return Ok(()) };
        self.counters.upload(&self.gpu, meter, &Counted::default())?;
        let level = |[first, count]: [u64; 2]| self.levels.part(4 * first, 4 * count);
        let (forest, casting) = (self.forest.whole(), self.casting.whole());
        let among =
            [forest, self.places.whole(), self.normals.whole(), self.counters.whole(), level(elements), casting];
        let upward: Vec<[Part<'_>; 3]> = groups.iter().map(|&group| [forest, level(group), casting]).collect();
        let pass = |name, pipeline, buffers, [_, threads]: [u64; 2]| Pass { name, pipeline, buffers, threads };
        let elements = pass("elements", &self.pipelines.elements, &among, elements);
        let groups = groups.iter().zip(&upward);
        let groups = groups.map(|(&group, buffers)| pass("groups", &self.pipelines.groups, buffers, group));
        let passes: Vec<Pass<'_>> = [elements].into_iter().chain(groups).collect();
        let counted = self.run(&passes, meter)?;
        self.tell_elements(counted, meter);
        Ok(())
    }

    /// Shades all receivers, as many at a time as a binding holds; counts the nodes that were summed.
    fn shade(&mut self, meter: &mut dyn Meter) -> Result<Counted> {
        let (count, each, wanted) = (self.valid.len() as u64, size_of::<Receiver>() as u64, 12);
        self.counters.upload(&self.gpu, meter, &Counted::default())?;
        self.results.reserve(&self.gpu, wanted * count)?;
        let casters = if self.stage.own_passes() > 0 { &self.casting } else { &self.normals };
        let parts: Vec<_> = self.gpu.parts(count, each).collect();
        let buffers = parts.iter().map(|part| {
            [
                self.forest.whole(),
                self.places.whole(),
                casters.whole(),
                self.counters.whole(),
                self.light.whole(),
                self.receivers.items(part.clone(), each),
                self.results.items(part.clone(), wanted),
            ]
        });
        let buffers: Vec<_> = buffers.collect();
        let passes = parts.iter().zip(&buffers).map(|(part, buffers)| Pass {
            name: "receivers",
            pipeline: &self.pipelines.receivers,
            buffers,
            threads: part.end - part.start,
        });
        self.run(&passes.collect::<Vec<_>>(), meter)
    }

    fn run(&self, passes: &[Pass<'_>], meter: &mut dyn Meter) -> Result<Counted> {
        let counted: Vec<Counted> = self.gpu.run_and_read(passes, &self.counters, 1, meter)?;
        let [.., unfinished] = counted[0];
        match unfinished {
            0 => Ok(counted[0]),
            _ => Err(Error::Device(format!(
                "{}: {unfinished} walks over {} elements and groups were ended on the way (lavapipe ends loops after 65 535 rounds): \
                 expected fewer elements, or groups opened later",
                self.gpu.adapter().name,
                self.stage.forest.nodes()
            ))),
        }
    }
}

fn receiver(receivers: &Receivers, i: usize) -> Receiver {
    [receivers.position[i], receivers.normal[i], receivers.albedo[i]].map(|vector| vector.extend(0.0).to_array())
}

/// Neighbours as one.
fn joined(trees: &[Tree]) -> Vec<Tree> {
    let mut all: Vec<Tree> = Vec::new();
    for tree in trees {
        match all.last_mut() {
            Some(before) if before.end == tree.start => before.end = tree.end,
            _ => all.push(tree.clone()),
        }
    }
    all
}

impl Prepared for Occlusion {
    fn footprint(&self) -> Footprint {
        let Occlusion { forest, places, normals, casting, levels, light, receivers, results, counters, .. } = self;
        let buffers = [
            ("elements", [forest, places, normals, casting, levels].map(Resident::bytes).iter().sum()),
            ("light", light.bytes()),
            ("receivers", receivers.bytes()),
            ("result", results.bytes()),
            ("counters", counters.bytes()),
        ];
        let footprint = self.stage.footprint().host("receivers", size_of_val(self.valid.as_slice()));
        buffers.into_iter().fold(footprint, |sum, (purpose, bytes)| sum.device(purpose, bytes))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        self.stage.retune(params)?;
        self.cast = false;
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        let mut moved = self.stage.update(frame, meter);
        if !self.cast {
            moved = self.stage.trees().cloned().collect();
        }
        // Set again only once all of it is done.
        self.cast = false;
        timed(meter, "upload", |meter| {
            self.fit(&moved, meter)?;
            if self.stage.turns() || self.light.bytes() == 0 {
                self.light.upload(&self.gpu, meter, &self.stage.lit.rgb.concat())?;
            }
            self.place(&frame.receivers, meter)
        })?;
        if !moved.is_empty() && self.stage.own_passes() > 0 {
            timed(meter, "passes among elements", |meter| self.cast(meter))?;
        }
        self.cast = true;
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        if quantity != Quantity::Direct {
            return Err(Error::Unsupported { method: INFO.id, what: quantity.to_string() });
        }
        let receivers = frame.receivers.as_ref();
        if meter.progress("receivers", 0, receivers.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        self.place(receivers, meter)?;
        let counted = timed(meter, "occlude and shade", |meter| self.shade(meter))?;
        self.tell_receivers(counted, meter);
        self.stage.report(receivers, counted[0], meter);
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()> {
        let values: Vec<f32> = self.gpu.download(&self.results, 3 * self.valid.len(), meter)?;
        let mut all = vec![0.0; 3 * self.count];
        for (&receiver, rgb) in self.valid.iter().zip(values.chunks_exact(3)) {
            all[3 * receiver as usize..][..3].copy_from_slice(rgb);
        }
        out.fill(Quantity::Direct, &all)
    }
}
