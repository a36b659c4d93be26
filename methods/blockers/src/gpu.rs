//! Direct light under sphere blockers on a graphics processor: [`crate::DirectLight`] with a thread for each receiver.
//!
//! What a frame needs is uploaded in `update` (blockers, and receivers if they are others than before), computed in `evaluate` and stays
//! on the device until `read`. A method gives its part as WGSL ([`Accumulator::SHADER`]).

use std::sync::Arc;

use halflight_contract::{Error, Flow, Footprint, Job, Meter, Output, Params, Prepared, Quantity, Result, timed};
use halflight_gpu::{Access, Gpu, Pass, Pipeline, Resident, Revision};
use halflight_proxies::SelfShadow;
use halflight_scenes::{Frame, Receivers};
use halflight_sh::{coefficients, wgsl};

use crate::direct::report;
use crate::stage::Stage;
use crate::{Accumulator, Tally, Work, params};

/// A receiver as the shader sees it: position, geometric normal, normal and albedo, each padded.
type Seer = [[f32; 4]; 4];

/// The whole shader of a method at an order of accumulation.
///
/// # Panics
/// If the method has none.
pub fn source<A: Accumulator>(order: usize) -> String {
    let own = A::SHADER.expect("only methods with a shader are supported");
    [&wgsl::algebra(order), include_str!("direct.wgsl"), own].join("\n")
}

/// A shader's text by the order of accumulation.
pub type Text = Box<dyn Fn(usize) -> String + Send>;

/// A [`Prepared`] for direct light by an [`Accumulator::SHADER`].
pub struct GpuDirectLight<'s, A> {
    gpu: Arc<Gpu>,
    params: Params,
    stage: Stage<'s>,
    text: Text,
    pipeline: Arc<Pipeline>,
    settings: Resident,
    receivers: Resident,
    spheres: Resident,
    tables: Resident,
    results: Resident,
    counters: Resident,
    /// The receivers' numbers by their place on the device, of how many.
    valid: Vec<u32>,
    count: usize,
    quantity: Quantity,
    method: std::marker::PhantomData<fn() -> A>,
}

impl<'s, A: Accumulator> GpuDirectLight<'s, A> {
    /// Opens the device, derives sphere sets and light, compiles.
    pub fn prepare(job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Self> {
        Self::with_source(job, meter, Box::new(source::<A>))
    }

    /// The same with another text than [`source`], by the order of accumulation.
    pub fn with_source(job: &Job<'s, '_>, meter: &mut dyn Meter, text: Text) -> Result<Self> {
        let gpu = timed(meter, "open device", |_| Gpu::shared(job.backend))?;
        let stage = Stage::derive(job, meter)?;
        let pipeline = timed(meter, "compile shader", |_| compile(&gpu, &text, job.params))?;
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
            valid: Vec::new(),
            count: 0,
            quantity: Quantity::Direct,
            method: std::marker::PhantomData,
        })
    }

    /// Uploads receivers that are not there yet.
    fn place(&mut self, receivers: &Receivers, meter: &mut dyn Meter) -> Result<()> {
        let valid = &mut self.valid;
        self.count = receivers.len();
        Ok(self.receivers.sync(&self.gpu, receivers.revision, meter, || {
            *valid = (0..receivers.len() as u32).filter(|&i| receivers.valid[i as usize]).collect();
            valid.iter().map(|&i| seer(receivers, i as usize)).collect()
        })?)
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
        let mut words = vec![spheres, self_shadow, guard, order as u32, wanted, least, 0, 0];
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

    /// Runs the shader over all receivers, as many at a time as a binding holds.
    fn shade(&self, meter: &mut dyn Meter) -> Result<()> {
        let (each, wanted) = (size_of::<Seer>() as u64, 4 * self.quantity.channels() as u64);
        // Parts begin at multiples of 256 bytes.
        let most = (self.gpu.max_binding() / each.max(wanted)) & !63;
        let count = self.valid.len() as u64;
        for first in (0..count).step_by(most as usize) {
            let threads = most.min(count - first);
            let buffers = [
                self.settings.whole(),
                self.receivers.part(first * each, threads * each),
                self.spheres.whole(),
                self.tables.whole(),
                self.results.part(first * wanted, threads * wanted),
                self.counters.whole(),
            ];
            let pass = Pass { name: "accumulate and shade", pipeline: &self.pipeline, buffers: &buffers, threads };
            self.gpu.run(&[pass], meter)?;
        }
        Ok(())
    }

    fn report(&self, receivers: &Receivers, meter: &mut dyn Meter) -> Result<()> {
        let words: Vec<[u32; 2]> = self.gpu.download(&self.counters, 6, meter)?;
        let [accumulated, too_small, additions, products, squares, guarded] =
            std::array::from_fn(|i| u64::from(words[i][0]) | u64::from(words[i][1]) << 32);
        let looked_at = self.valid.len() as u64 * self.stage.spheres.spheres.len() as u64;
        let tally = Tally { accumulated, too_small, removed: looked_at - accumulated - too_small };
        report(meter, receivers, &tally, &Work { additions, products, squares, guarded, kept: 0 });
        Ok(())
    }
}

fn compile(gpu: &Gpu, text: &Text, params: &Params) -> Result<Arc<Pipeline>> {
    use Access::{Read, Write};
    let order = params::accumulated_order(params);
    Ok(gpu.pipeline("accumulate and shade", &text(order), &[Read, Read, Read, Read, Write, Write])?)
}

fn seer(receivers: &Receivers, i: usize) -> Seer {
    [receivers.position[i], receivers.geometric_normal[i], receivers.normal[i], receivers.albedo[i]]
        .map(|vector| vector.extend(0.0).to_array())
}

impl<A: Accumulator> Prepared for GpuDirectLight<'_, A> {
    fn footprint(&self) -> Footprint {
        let buffers = [
            ("settings", &self.settings),
            ("receivers", &self.receivers),
            ("spheres", &self.spheres),
            ("tables", &self.tables),
            ("result", &self.results),
            ("counters", &self.counters),
        ];
        let footprint = self.stage.footprint().host("receivers", size_of_val(self.valid.as_slice()));
        buffers.iter().fold(footprint, |sum, (purpose, buffer)| sum.device(purpose, buffer.bytes()))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        params.retune(&mut self.params, A::PARAMS)?;
        self.pipeline = compile(&self.gpu, &self.text, &self.params)?;
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        self.stage.update(frame, meter);
        timed(meter, "upload", |meter| {
            let spheres = self.stage.spheres.spheres.iter();
            let values: Vec<[f32; 4]> = spheres.map(|s| s.center.extend(s.radius).to_array()).collect();
            self.spheres.upload(&self.gpu, meter, &values)?;
            self.place(&frame.receivers, meter)
        })
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        let receivers = frame.receivers.as_ref();
        self.quantity = quantity;
        if meter.progress("receivers", 0, receivers.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        self.place(receivers, meter)?;
        let order = params::accumulated_order(&self.params);
        self.tables.sync(&self.gpu, Revision(order as u64), meter, || wgsl::tables(order))?;
        self.settings.upload(&self.gpu, meter, &self.settings())?;
        self.counters.upload(&self.gpu, meter, &[0u32; 12])?;
        self.results.reserve(&self.gpu, 4 * (self.valid.len() * quantity.channels()) as u64)?;
        timed(meter, "accumulate and shade", |meter| self.shade(meter))?;
        self.report(receivers, meter)
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
