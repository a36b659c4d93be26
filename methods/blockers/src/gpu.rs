//! Direct light under sphere blockers on a graphics processor: [`crate::DirectLight`] with a thread for each receiver.
//!
//! What a frame needs is uploaded in `update` (blockers, and receivers if they are others than before), computed in `evaluate` and stays
//! on the device until `read`. A method gives its part as WGSL ([`Accumulator::SHADER`]).
//!
//! Cuts are made on the CPU in `update` (again in `evaluate` if a parameter that they depend on has changed) and uploaded as a list of
//! spheres a cluster; receivers lie cluster by cluster, so that the threads of a group walk one list, or two.

mod baked;
mod cuts;
mod lamps;
mod shader;
mod work;

use std::sync::Arc;

use halflight_contract::{Error, Flow, Footprint, Job, Meter, Output, Params, Prepared, Quantity, Result, timed};
use halflight_gpu::{Gpu, Pass, Pipeline, Resident, Revision};
use halflight_proxies::SelfShadow;
use halflight_scenes::{Frame, Receivers, Sphere};
use halflight_sh::{coefficients, wgsl};

use crate::direct::report;
use crate::stage::Stage;
use crate::{Accumulator, Tally, Work, params};
use baked::{Baked, bytes_each};
use cuts::Cuts;
use lamps::Lamps;
pub use shader::{Needs, Text, source};

/// A receiver as the shader sees it: position and cluster, geometric normal, normal and albedo, each padded.
type Seer = [[f32; 4]; 4];

/// The only pass.
const PASS: &str = "accumulate and shade";

/// What the shader counts, as it numbers them.
const COUNTERS: usize = 8;

/// The receivers' revision, and what clusters were made for.
type Order = (Revision, Option<(Revision, usize)>);

/// A [`Prepared`] for direct light by an [`Accumulator::SHADER`].
pub struct GpuDirectLight<'s, A> {
    gpu: Arc<Gpu>,
    params: Params,
    stage: Stage<'s>,
    text: Text,
    needs: Needs,
    pipeline: Arc<Pipeline>,
    settings: Resident,
    receivers: Resident,
    spheres: Resident,
    tables: Resident,
    results: Resident,
    counters: Resident,
    cuts: Option<Cuts>,
    baked: Option<Baked<A>>,
    lamps: Option<Lamps>,
    /// What receivers on the device lie in the order of.
    placed: Option<Order>,
    /// The receivers' numbers by their place on the device, of how many.
    valid: Vec<u32>,
    count: usize,
    quantity: Quantity,
}

impl<'s, A: Accumulator> GpuDirectLight<'s, A> {
    /// Opens the device, derives sphere sets and light, compiles.
    pub fn prepare(job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Self> {
        Self::with_source(job, meter, Box::new(source::<A>))
    }

    /// The same with another text than [`source`], by the order of accumulation.
    pub fn with_source(job: &Job<'s, '_>, meter: &mut dyn Meter, text: Text) -> Result<Self> {
        let gpu = timed(meter, "open device", |_| Gpu::shared(job.backend))?;
        let mut stage = Stage::derive(job, meter)?;
        let baked = Baked::take(job, &mut stage);
        let (cuts, lamps) = (Cuts::new::<A>(job.scene, &stage, job.params), Lamps::new(&stage));
        let needs = Needs { cuts: cuts.is_some(), baked: baked.is_some(), lamps: lamps.as_ref().map(Lamps::kind) };
        let pipeline = timed(meter, "compile shader", |_| compile(&gpu, &text, job.params, needs))?;
        Ok(GpuDirectLight {
            gpu,
            params: job.params.clone(),
            stage,
            text,
            pipeline,
            settings: Resident::new("settings"),
            receivers: Resident::new("receivers"),
            spheres: Resident::new("spheres"),
            tables: Resident::new("tables"),
            results: Resident::new("results"),
            counters: Resident::new("counters"),
            cuts,
            baked,
            lamps,
            needs,
            placed: None,
            valid: Vec::new(),
            count: 0,
            quantity: Quantity::Direct,
        })
    }

    /// Uploads what is seen, if that on the device is not the same: spheres or cuts of them.
    fn show(&mut self, receivers: &Receivers, meter: &mut dyn Meter) -> Result<()> {
        let (gpu, stage, spheres) = (&self.gpu, &self.stage, &mut self.spheres);
        match &mut self.cuts {
            Some(cuts) => cuts.upload(gpu, stage, receivers, &self.params, spheres, meter),
            None => Ok(spheres.sync(gpu, stage.posed, meter, || words(&stage.spheres.spheres))?),
        }
    }

    /// Uploads receivers that are not there yet, those of a cluster together, and what is baked of them.
    fn place(&mut self, receivers: &Receivers, meter: &mut dyn Meter) -> Result<()> {
        let order = Some((receivers.revision, self.cuts.as_ref().and_then(Cuts::made_for)));
        let moved = self.placed != order;
        if moved {
            self.upload_receivers(receivers, meter)?;
            self.placed = order;
        }
        match &mut self.baked {
            Some(baked) => baked.upload(&self.gpu, &self.params, receivers, (&self.valid, moved), meter),
            None => Ok(()),
        }
    }

    fn upload_receivers(&mut self, receivers: &Receivers, meter: &mut dyn Meter) -> Result<()> {
        let members: Vec<(u32, u32)> = match &self.cuts {
            Some(cuts) => cuts.members().collect(),
            None => (0..receivers.len() as u32).filter(|&i| receivers.valid[i as usize]).map(|i| (i, 0)).collect(),
        };
        let seers: Vec<Seer> = members.iter().map(|&(i, cluster)| seer(receivers, i as usize, cluster)).collect();
        self.placed = None;
        self.receivers.upload(&self.gpu, meter, &seers)?;
        self.count = receivers.len();
        self.valid = members.into_iter().map(|(receiver, _)| receiver).collect();
        Ok(())
    }

    /// What the shader reads as `Settings`.
    fn settings(&self) -> Vec<u32> {
        let fine = coefficients(params::accumulated_order(&self.params));
        let order = self.stage.order;
        let self_shadow = match params::gather(&self.params).self_shadow {
            SelfShadow::Continuous => 0,
            SelfShadow::Paper => 1,
            SelfShadow::Off => 2,
        };
        let wanted = match self.quantity {
            Quantity::Visibility { .. } => self.quantity.channels() as u32,
            _ => 0,
        };
        let guard = u32::from(self.params.flag(params::GUARD.name));
        let least = params::gather(&self.params).min_sin_angle.to_bits();
        let spheres = self.stage.spheres.spheres.len() as u32;
        let ratios = u32::from(self.cuts.as_ref().is_some_and(Cuts::scales));
        let mut words = vec![spheres, self_shadow, guard, order as u32, wanted, least, ratios, 0];
        words.extend(A::shader_settings(&self.params).map(f32::to_bits));
        let mut vector = |values: &[f32]| {
            let padded = values.iter().copied().chain(std::iter::repeat(0.0));
            words.extend(padded.take(fine).map(f32::to_bits));
        };
        let window = self.stage.visibility_window(&self.params);
        vector(&window.unwrap_or_else(|| vec![1.0; coefficients(order)]));
        self.stage.windowed_light().iter().for_each(|channel| vector(channel));
        words
    }

    /// Runs the shader over all receivers, as many at a time as a binding holds, and returns what it counted.
    fn shade(&self, meter: &mut dyn Meter) -> Result<[u64; COUNTERS]> {
        let (each, wanted) = (size_of::<Seer>() as u64, 4 * self.quantity.channels() as u64);
        let order = params::accumulated_order(&self.params);
        let baked = self.baked.as_ref().map_or(0, |_| bytes_each(order));
        // Parts begin at multiples of 256 bytes.
        let most = (self.gpu.max_binding() / each.max(wanted).max(baked)) & !63;
        let count = self.valid.len() as u64;
        let part = |first: u64| {
            let threads = most.min(count - first);
            let mut buffers = vec![
                self.settings.whole(),
                self.receivers.part(first * each, threads * each),
                self.spheres.whole(),
                self.tables.whole(),
                self.results.part(first * wanted, threads * wanted),
                self.counters.whole(),
            ];
            buffers.extend(self.cuts.iter().flat_map(Cuts::buffers));
            buffers.extend(self.baked.iter().map(|baked| baked.part(first, threads, order)));
            buffers.extend(self.lamps.iter().flat_map(Lamps::buffers));
            (threads, buffers)
        };
        let parts: Vec<_> = (0..count).step_by(most as usize).map(part).collect();
        let pass = |(threads, buffers)| Pass { name: PASS, pipeline: &self.pipeline, buffers, threads };
        let passes: Vec<_> = parts.iter().map(|(threads, buffers)| pass((*threads, buffers.as_slice()))).collect();
        let words: Vec<[u32; 2]> = self.gpu.run_and_read(&passes, &self.counters, COUNTERS, meter)?;
        Ok(std::array::from_fn(|i| u64::from(words[i][0]) | u64::from(words[i][1]) << 32))
    }

    /// What is on the device; a pass reads or writes all of it.
    fn device_bytes(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let buffers = [
            ("settings", &self.settings),
            ("receivers", &self.receivers),
            ("spheres", &self.spheres),
            ("tables", &self.tables),
            ("result", &self.results),
            ("counters", &self.counters),
        ];
        (buffers.into_iter().map(|(purpose, buffer)| (purpose, buffer.bytes())))
            .chain(self.cuts.iter().flat_map(Cuts::device_bytes))
            .chain(self.baked.iter().map(|baked| ("baked blockers", baked.device_bytes())))
            .chain(self.lamps.iter().flat_map(Lamps::bytes))
    }

    fn report(&self, receivers: &Receivers, counted: [u64; COUNTERS], meter: &mut dyn Meter) -> Result<()> {
        let [accumulated, too_small, additions, products, squares, guarded, kept, ended] = counted;
        if ended > 0 {
            let name = &self.gpu.adapter().name;
            let longest = self.cuts.as_ref().map_or(self.stage.spheres.spheres.len() as u64, Cuts::longest);
            return Err(Error::Device(format!(
                "{name}: {ended} receivers before up to {longest} spheres were ended on the way (lavapipe ends loops after 65 535 rounds): \
                 expected fewer spheres"
            )));
        }
        let looked_at = match &self.cuts {
            Some(cuts) => cuts.looked_at,
            None => self.valid.len() as u64 * self.stage.spheres.spheres.len() as u64,
        };
        let tally = Tally { accumulated, too_small, removed: looked_at - accumulated - too_small };
        let work = Work { additions, products, squares, guarded, kept };
        report(meter, receivers, &tally, &work);
        let (order, shaded) = (params::accumulated_order(&self.params), self.quantity == Quantity::Direct);
        let operations = work::operations(order, self.valid.len() as u64, shaded, &tally, &work);
        meter.work(PASS, operations, self.device_bytes().map(|(_, bytes)| bytes).sum());
        self.cuts.iter().for_each(|cuts| cuts.report(meter));
        Ok(())
    }
}

fn compile(gpu: &Gpu, text: &Text, params: &Params, needs: Needs) -> Result<Arc<Pipeline>> {
    let order = params::accumulated_order(params);
    Ok(gpu.pipeline(PASS, &text(order, needs), &needs.buffers())?)
}

fn seer(receivers: &Receivers, i: usize, cluster: u32) -> Seer {
    let vectors = [receivers.position[i], receivers.geometric_normal[i], receivers.normal[i], receivers.albedo[i]];
    let mut seer = vectors.map(|vector| vector.extend(0.0).to_array());
    seer[0][3] = f32::from_bits(cluster);
    seer
}

/// Spheres as shaders see them.
fn words(spheres: &[Sphere]) -> Vec<[f32; 4]> {
    spheres.iter().map(|sphere| sphere.center.extend(sphere.radius).to_array()).collect()
}

impl<A: Accumulator> Prepared for GpuDirectLight<'_, A> {
    fn footprint(&self) -> Footprint {
        let host = (self.cuts.iter().flat_map(Cuts::host_bytes))
            .chain(self.baked.iter().map(|baked| ("baked blockers", baked.host_bytes())));
        let footprint = self.stage.footprint().host("receivers", size_of_val(self.valid.as_slice()));
        let footprint = host.fold(footprint, |sum, (purpose, bytes)| sum.host(purpose, bytes));
        self.device_bytes().fold(footprint, |sum, (purpose, bytes)| sum.device(purpose, bytes))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        params.retune(&mut self.params, A::PARAMS)?;
        self.cuts.iter_mut().for_each(|cuts| cuts.retune::<A>(params));
        self.baked.iter_mut().for_each(|baked| baked.retune(params));
        self.pipeline = compile(&self.gpu, &self.text, &self.params, self.needs)?;
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        self.stage.update(frame, meter);
        if let Some(cuts) = &mut self.cuts {
            cuts.update(&self.stage.spheres, &frame.receivers, &self.params, meter);
        }
        self.baked.iter_mut().for_each(|baked| baked.move_to(&frame.receivers));
        timed(meter, "upload", |meter| {
            self.place(&frame.receivers, meter)?;
            self.show(&frame.receivers, meter)
        })
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        let receivers = frame.receivers.as_ref();
        self.quantity = quantity;
        if meter.progress("receivers", 0, receivers.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        // Parameters may have changed since the update.
        self.show(receivers, meter)?;
        self.place(receivers, meter)?;
        let order = params::accumulated_order(&self.params);
        self.tables.sync(&self.gpu, Revision(order as u64), meter, || wgsl::tables(order))?;
        self.settings.upload(&self.gpu, meter, &self.settings())?;
        if let Some(lamps) = &mut self.lamps {
            lamps.upload(&self.gpu, &self.stage, order, meter)?;
        }
        self.counters.upload(&self.gpu, meter, &[0u32; 2 * COUNTERS])?;
        self.results.reserve(&self.gpu, 4 * (self.valid.len() * quantity.channels()) as u64)?;
        let counted = timed(meter, PASS, |meter| self.shade(meter))?;
        self.report(receivers, counted, meter)
    }

    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()> {
        let channels = self.quantity.channels();
        let values: Vec<f32> = self.gpu.download(&self.results, self.valid.len() * channels, meter)?;
        let mut all = vec![0.0; self.count * channels];
        for (&receiver, values) in self.valid.iter().zip(values.chunks_exact(channels)) {
            all[receiver as usize * channels..][..channels].copy_from_slice(values);
        }
        out.fill(self.quantity, &all)
    }
}
