//! Estimating a reference at every receiver of a frame.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use halflight_contract::{Backend, Cache, Flow, Job, Meter, Params, Quantity, timed};
use halflight_light::LightOf;
use halflight_scenes::{Frame, Light, Rgb};
use rayon::prelude::*;

use crate::emission::{Emission, Lights};
use crate::emitters::Emitters;
use crate::receiver::Receiver;
use crate::sampling::mix;
use crate::traced::Traced;
use crate::transport::{
    Distant, Emitted, MeanVisibility, Moments, Paths, Plan, Scratch, ShVisibility, Term, Transport,
};
use crate::unoccluded::Unoccluded;
use crate::visibility::{Blockers, Visibility};
use crate::{Error, Quality, Request, Result};

/// Outgoing radiance at a frame's receivers with its uncertainty; invalid receivers hold zeros.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Outgoing radiance.
    pub mean: Vec<Rgb>,
    /// Variance of the mean, a channel: what the spread of the batches says, and what one ray among so many weighs.
    /// Unbiased but for the latter, which overstates it by an eighth at the default quality and by 1% from 1024 samples on.
    pub variance: Vec<Rgb>,
    /// Samples taken, 0 at invalid receivers.
    pub samples: Vec<u32>,
    /// Independent batches that the variance was estimated from; its degrees of freedom are one less.
    pub batches: u32,
}

impl Estimate {
    /// Standard error of the mean, a channel.
    pub fn standard_error(&self) -> Vec<Rgb> {
        self.variance.iter().map(|variance| Rgb::from_array(variance.to_array().map(f32::sqrt))).collect()
    }

    /// The first so many receivers of it, or all.
    pub(crate) fn truncate(&mut self, receivers: usize) {
        self.mean.truncate(receivers);
        self.variance.truncate(receivers);
        self.samples.truncate(receivers);
    }
}

/// Receivers between two reports of progress: as many as take this long, at first so many.
const SLAB_TIME: Duration = Duration::from_millis(500);
const FIRST_SLAB: usize = 256;

/// Enough to tell how many samples are needed, not to be reported. Short batches err on the safe side.
const PILOT: Plan = Plan { batches: 16, per_batch: 4 };

/// Receivers that the mean light of emitting objects is taken over.
const LEVEL_RECEIVERS: usize = 256;

/// Estimates a reference at a frame's receivers on all cores. The same seed gives the same bits on any number of threads.
///
/// How many samples a receiver needs, and the share of its light that is visible (for the control variate), is decided by a
/// small pilot whose samples are then dropped: stopping when the samples at hand look good enough would favour those that look
/// better than they are, and bias both the mean and its variance. In deep shadow a mean may be slightly below 0.
///
/// The meter gets the span `references`, counters of samples, rays and receivers that missed the target, and progress.
///
/// # Errors
/// As [`Request::check`], derived data that cannot be made, or [`halflight_contract::Error::Cancelled`].
pub fn estimate(request: &Request<'_>, cache: &Cache, meter: &mut dyn Meter) -> Result<Estimate> {
    let sampler = Sampler::new(request, cache, meter)?;
    sampler.all(request.frame, Estimate::default(), &mut |_, _| Ok(()), meter)
}

/// What blocks the light of a reference.
pub(crate) fn visibility(
    request: &Request<'_>,
    traced: &Arc<Traced>,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<Visibility> {
    let params = Params::default();
    let job = Job::new(request.scene, &params, request.seed, Backend::Cpu, cache);
    let blockers = match request.reference.sphere_proxies() {
        Some((count, rule)) => {
            let proxies = halflight_proxies::proxies(&job, count, meter)?;
            let spheres = halflight_proxies::blockers(request.scene, request.frame, &proxies).spheres;
            Blockers::Spheres { spheres: Arc::new(spheres), rule }
        }
        None => Blockers::Traced(traced.clone()),
    };
    Ok(Visibility { blockers, upper_sky: request.reference.upper_sky() })
}

/// The distant light, and what it is with nothing in the way.
fn distant(request: &Request<'_>, cache: &Cache, meter: &mut dyn Meter) -> Result<(Arc<Emission>, Unoccluded)> {
    let params = Params::default();
    let job = Job::new(request.scene, &params, request.seed, Backend::Cpu, cache);
    Ok(match request.reference.sh_light() {
        Some(order) => {
            let light = Arc::new(job.derive(&LightOf { order }, meter)?.at(request.frame.time).into_owned());
            (Arc::new(Emission::Harmonics(light.clone())), Unoccluded::Harmonics(light))
        }
        None => {
            let lights = lights(request);
            (Arc::new(Emission::Lights(Lights::new(&lights))), Unoccluded::of(&lights))
        }
    })
}

/// The distant lights as they are at the frame's time.
fn lights(request: &Request<'_>) -> Vec<Light> {
    request.frame.lights().cloned().collect()
}

fn transport(
    request: &Request<'_>,
    traced: &Arc<Traced>,
    emitters: &Arc<Emitters>,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<Transport> {
    let reference = request.reference;
    let visibility = visibility(request, traced, cache, meter)?;
    let (emission, unoccluded) = distant(request, cache, meter)?;
    if let Some(order) = reference.sh_visibility() {
        return Ok(Transport::ShVisibility(Box::new(ShVisibility { order, emission, visibility, unoccluded })));
    }
    if reference.mean_visibility() {
        let keys = request.frame.lights().filter_map(|light| match light {
            Light::Key(key) => Some(*key),
            _ => None,
        });
        let keys = keys.collect();
        return Ok(Transport::Sum(vec![Box::new(MeanVisibility { emitters: emitters.clone(), keys, visibility })]));
    }
    let mut terms: Vec<Box<dyn Term>> = Vec::new();
    if matches!(request.quantity, Quantity::Direct | Quantity::Total) {
        if !request.scene.lights.is_empty() {
            terms.push(Box::new(Distant { emission: emission.clone(), visibility: visibility.clone(), unoccluded }));
        }
        if !emitters.is_empty() {
            terms.push(Box::new(Emitted { emitters: emitters.clone(), visibility }));
        }
    }
    let bounces = match request.quantity {
        Quantity::Indirect { bounces } => bounces,
        Quantity::Total => u8::MAX,
        _ => 0,
    };
    if bounces > 0 {
        terms.push(Box::new(Paths {
            traced: traced.clone(),
            emission,
            emitters: emitters.clone(),
            bounces,
            upper_sky: reference.upper_sky(),
            unoccluded: reference.unoccluded_indirect(),
        }));
    }
    Ok(Transport::Sum(terms))
}

/// The scene's mean level of light, by which errors are measured: `1/4π ∫ L dω` of the distant light, and what receivers get of
/// the objects that emit with nothing in the way; mean of the channels.
fn level(request: &Request<'_>, emitters: &Emitters) -> f64 {
    let receivers = &request.frame.receivers;
    let distant = Lights::new(&lights(request)).level();
    let valid: Vec<usize> = (0..receivers.len()).filter(|i| receivers.valid[*i]).collect();
    let some: Vec<usize> = valid.iter().step_by(valid.len().div_ceil(LEVEL_RECEIVERS).max(1)).copied().collect();
    let open = |i: &usize| emitters.open(receivers.position[*i], receivers.normal[*i]).element_sum() / 3.0;
    let emitted = if emitters.is_empty() { 0.0 } else { some.par_iter().map(open).collect::<Vec<_>>().iter().sum() };
    distant + emitted / some.len().max(1) as f64
}

/// All that receivers are sampled with.
pub(crate) struct Sampler<'q> {
    transport: Transport,
    quality: &'q Quality,
    /// What standard errors are relative to, radiance for albedo 1.
    pub(crate) level: f64,
    /// Absolute standard error for albedo 1.
    target: f64,
    seed: u64,
}

impl<'q> Sampler<'q> {
    /// Makes what a request needs before the first sample.
    pub(crate) fn new(request: &Request<'q>, cache: &Cache, meter: &mut dyn Meter) -> Result<Self> {
        request.check()?;
        if let Quantity::Visibility { .. } = request.quantity {
            return Err(request.not_served("visibility is no radiance, expected a call of `visibility`".into()));
        }
        let traced = Arc::new(Traced::new(request.scene, request.frame, request.reference));
        let emitters = Arc::new(Emitters::new(&traced));
        let level = level(request, &emitters);
        Ok(Sampler {
            transport: transport(request, &traced, &emitters, cache, meter)?,
            quality: request.quality,
            level,
            target: f64::from(request.quality.standard_error) * level,
            // References of one seed must not share their errors: they are subtracted from one another.
            seed: [request.reference.id(), request.quantity.to_string()]
                .iter()
                .flat_map(|id| id.bytes())
                .fold(request.seed, |seed, byte| mix(seed, u64::from(byte))),
        })
    }

    /// The estimate at every receiver, given what there is of it. Whatever is added is told at once, with the number of
    /// receivers before it.
    pub(crate) fn all(
        &self,
        frame: &Frame,
        begun: Estimate,
        keep: &mut dyn FnMut(&Estimate, usize) -> Result<()>,
        meter: &mut dyn Meter,
    ) -> Result<Estimate> {
        timed(meter, "references", |meter| self.onwards(frame, begun, keep, meter))
    }

    fn onwards(
        &self,
        frame: &Frame,
        begun: Estimate,
        keep: &mut dyn FnMut(&Estimate, usize) -> Result<()>,
        meter: &mut dyn Meter,
    ) -> Result<Estimate> {
        let count = frame.receivers.len();
        let mut result = Estimate { batches: self.quality.batches, ..begun };
        result.truncate(count);
        let (mut rays, mut missed, mut slab) = (0, 0, FIRST_SLAB);
        while result.mean.len() < count {
            let first = result.mean.len();
            if meter.progress("reference", first as u64, count as u64) == Flow::Cancel {
                return Err(Error::Contract(halflight_contract::Error::Cancelled));
            }
            let started = Instant::now();
            // Collected in order, so that nothing depends on which thread was first.
            let moments: Vec<(Moments, u32)> = (first..count.min(first + slab))
                .into_par_iter()
                .map_init(Scratch::default, |scratch, index| self.one(frame, index, scratch))
                .collect();
            for (index, (moments, samples)) in (first..).zip(moments) {
                let albedo = frame.receivers.albedo[index].as_dvec3();
                result.mean.push((albedo * moments.mean).as_vec3());
                result.variance.push((albedo * albedo * moments.variance).as_vec3());
                result.samples.push(samples);
                rays += moments.rays;
                missed += u64::from(rms_error(&moments) > self.target);
            }
            keep(&result, first)?;
            // Results do not depend on how many are taken at once.
            let pace = SLAB_TIME.as_secs_f64() / started.elapsed().as_secs_f64().max(1e-6);
            slab = ((slab as f64 * pace.clamp(0.25, 4.0)) as usize).clamp(16, 1 << 16);
        }
        meter.progress("reference", count as u64, count as u64);
        meter.count("reference samples", result.samples.iter().map(|s| u64::from(*s)).sum());
        meter.count("reference rays", rays);
        meter.count("reference receivers above the target error", missed);
        Ok(result)
    }

    /// Moments for albedo 1, and the samples that they rest on. Pilot rays are counted among the rays.
    fn one(&self, frame: &Frame, index: usize, scratch: &mut Scratch) -> (Moments, u32) {
        if !frame.receivers.valid[index] {
            return (Moments::default(), 0);
        }
        let receiver = Receiver::of(frame, index);
        let seed = mix(self.seed, index as u64);
        let (pilot, control) = self.transport.pilot(&receiver, PILOT, mix(seed, 0), scratch);
        let plan = Plan { batches: self.quality.batches, per_batch: self.per_batch(self.needed(&pilot)) };
        let moments = self.transport.estimate(&receiver, plan, mix(seed, 1), control, scratch);
        (Moments { rays: moments.rays + pilot.rays, ..moments }, plan.samples())
    }

    /// Samples that meet the target if the variance falls as their inverse.
    fn needed(&self, pilot: &Moments) -> u32 {
        let (least, most) = (self.quality.min_samples, self.quality.max_samples);
        if self.target <= 0.0 {
            return most;
        }
        let needed = f64::from(PILOT.samples()) * (rms_error(pilot) / self.target).powi(2);
        (needed.min(f64::from(most)) as u32).clamp(least, most)
    }

    /// Samples a batch: a power of two, at least one for each of two strategies.
    fn per_batch(&self, samples: u32) -> u32 {
        samples.div_ceil(self.quality.batches).next_power_of_two().max(2)
    }
}

/// Root of the channels' mean variance.
fn rms_error(moments: &Moments) -> f64 {
    (moments.variance.dot(DVec3::ONE) / 3.0).sqrt()
}
