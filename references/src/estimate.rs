//! Estimating a reference at every receiver of a frame.

use glam::DVec3;
use halflight_contract::{Backend, Cache, Flow, Job, Meter, Params, timed};
use halflight_light::LightOf;
use halflight_scenes::{Frame, Rgb, Scene};
use rayon::prelude::*;

use crate::emission::{Emission, Lights};
use crate::integrand::{Control, Integrand, Moments, Plan, Scratch};
use crate::receiver::Receiver;
use crate::sampling::mix;
use crate::unoccluded::Unoccluded;
use crate::visibility::Visibility;
use crate::{Error, Quality, Reference, Result};

/// Outgoing radiance at a frame's receivers with its uncertainty; invalid receivers hold zeros.
#[derive(Clone, Debug, PartialEq)]
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
}

/// Receivers between two reports of progress.
const SLAB: usize = 1024;

/// Enough to tell how many samples are needed, not to be reported. Short batches err on the safe side.
const PILOT: Plan = Plan { batches: 16, per_batch: 4 };

/// Estimates a reference at a frame's receivers on all cores. The same seed gives the same bits on any number of threads.
///
/// How many samples a receiver needs, and the share of its light that is visible (for the control variate), is decided by a
/// small pilot whose samples are then dropped: stopping when the samples at hand look good enough would favour those that look
/// better than they are, and bias both the mean and its variance. In deep shadow a mean may be slightly below 0.
///
/// The meter gets the span `references`, counters of samples, rays and receivers that missed the target, and progress.
///
/// # Errors
/// A quality out of range, derived data that cannot be made, or [`halflight_contract::Error::Cancelled`].
pub fn estimate(
    reference: &Reference,
    scene: &Scene,
    frame: &Frame,
    quality: &Quality,
    seed: u64,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<Estimate> {
    quality.check()?;
    let lights = Lights::new(&scene.lights);
    let sampler = Sampler {
        target: f64::from(quality.standard_error) * lights.level(),
        integrand: integrand(reference, scene, frame, lights, seed, cache, meter)?,
        quality,
        // References of one seed must not share their errors: they are subtracted from one another.
        seed: reference.id().bytes().fold(seed, |seed, byte| mix(seed, u64::from(byte))),
    };
    timed(meter, "references", |meter| sampler.all(frame, meter))
}

fn integrand(
    reference: &Reference,
    scene: &Scene,
    frame: &Frame,
    lights: Lights,
    seed: u64,
    cache: &Cache,
    meter: &mut dyn Meter,
) -> Result<Integrand> {
    let params = Params::default();
    let job = Job::new(scene, &params, seed, Backend::Cpu, cache);
    let (emission, unoccluded) = match reference {
        Reference::ShLight { order } => {
            let light = job.derive(&LightOf { order: *order }, meter)?;
            (Emission::Harmonics(light.clone()), Unoccluded::Harmonics(light))
        }
        _ => (Emission::Lights(lights), Unoccluded::of(&scene.lights)),
    };
    let visibility = match reference {
        Reference::SphereProxies { count, rule } => {
            let sets = halflight_proxies::sphere_sets(&job, *count, meter)?;
            let spheres = halflight_proxies::blockers(scene, frame, &sets).spheres;
            Visibility::Spheres { spheres, rule: *rule }
        }
        _ => Visibility::traced(scene, frame),
    };
    Ok(Integrand { emission, visibility, unoccluded })
}

struct Sampler<'q> {
    integrand: Integrand,
    quality: &'q Quality,
    /// Absolute standard error for albedo 1.
    target: f64,
    seed: u64,
}

impl Sampler<'_> {
    fn all(&self, frame: &Frame, meter: &mut dyn Meter) -> Result<Estimate> {
        let count = frame.receivers.len();
        let mut result = Estimate {
            mean: Vec::with_capacity(count),
            variance: Vec::with_capacity(count),
            samples: Vec::with_capacity(count),
            batches: self.quality.batches,
        };
        let (mut rays, mut missed) = (0, 0);
        for first in (0..count).step_by(SLAB) {
            if meter.progress("reference", first as u64, count as u64) == Flow::Cancel {
                return Err(Error::Contract(halflight_contract::Error::Cancelled));
            }
            // Collected in order, so that nothing depends on which thread was first.
            let slab: Vec<(Moments, u32)> = (first..count.min(first + SLAB))
                .into_par_iter()
                .map_init(Scratch::default, |scratch, index| self.one(frame, index, scratch))
                .collect();
            for (index, (moments, samples)) in (first..).zip(slab) {
                let albedo = frame.receivers.albedo[index].as_dvec3();
                result.mean.push((albedo * moments.mean).as_vec3());
                result.variance.push((albedo * albedo * moments.variance).as_vec3());
                result.samples.push(samples);
                rays += moments.rays;
                missed += u64::from(rms_error(&moments) > self.target);
            }
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
        self.integrand.sample(&receiver, PILOT, mix(seed, 0), scratch);
        let known = self.integrand.unoccluded(receiver.normal, scratch);
        let control = Control { share: scratch.share(), known };
        let pilot = scratch.moments(control);

        let plan = Plan { batches: self.quality.batches, per_batch: self.per_batch(self.needed(&pilot)) };
        self.integrand.sample(&receiver, plan, mix(seed, 1), scratch);
        let moments = scratch.moments(control);
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
