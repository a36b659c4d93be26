//! Light that arrives at one receiver: terms that are sampled in independent batches, whose spread tells their error.

mod distant;
mod emitted;
mod mean_visibility;
mod moments;
mod paths;
mod sh_visibility;

use glam::{DVec3, Vec3};
use halflight_trace::Ray;

use crate::receiver::Receiver;

pub(crate) use distant::Distant;
pub(crate) use emitted::Emitted;
pub(crate) use mean_visibility::MeanVisibility;
pub(crate) use moments::{Batches, Control, Moments, Plan};
pub(crate) use paths::Paths;
pub(crate) use sh_visibility::{ShVisibility, Visibilities};

/// A part of the light that a receiver of albedo 1 reflects: `1/π ∫ L(ω) V(ω) max(0, n·ω) dω` over some of the `L`.
pub(crate) trait Term: Send + Sync {
    /// Adds to every batch of the plan; the same for the same seed.
    fn sample(&self, receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch);

    /// What [`Batch::open`](moments::Batch) estimates, exactly.
    fn known(&self, receiver: &Receiver, scratch: &mut Scratch) -> DVec3;
}

/// How a receiver's light is estimated.
pub(crate) enum Transport {
    /// The sum of independent terms.
    Sum(Vec<Box<dyn Term>>),
    /// A product of two estimates.
    ShVisibility(Box<ShVisibility>),
}

/// Memory that is used again from receiver to receiver.
#[derive(Default)]
pub(crate) struct Scratch {
    batches: Batches,
    bundle: Bundle,
    paths: paths::Front,
    visibilities: Visibilities,
    /// The last normal and what it reflects of the distant light with nothing in the way: neighbours on a plane share both.
    open: Option<(Vec3, DVec3)>,
}

/// Directions from one receiver and what each brings to its batch if nothing is in the way; [`Bundle::FULL`] are traced at once.
#[derive(Default)]
struct Bundle {
    directions: Vec<Vec3>,
    contributions: Vec<(u32, Vec3)>,
    blocked: Vec<bool>,
    rays: Vec<Ray>,
}

impl Bundle {
    const FULL: usize = 1024;
}

impl Transport {
    /// A first small estimate, which decides the share of the light that is known to be visible.
    pub(crate) fn pilot(
        &self,
        receiver: &Receiver,
        plan: Plan,
        seed: u64,
        scratch: &mut Scratch,
    ) -> (Moments, Control) {
        match self {
            Transport::Sum(terms) => {
                sample(terms, receiver, plan, seed, scratch);
                let known = terms.iter().map(|term| term.known(receiver, scratch)).sum();
                let control = Control { share: scratch.batches.share(), known };
                (scratch.batches.moments(control), control)
            }
            Transport::ShVisibility(product) => {
                (product.estimate(receiver, plan, seed, scratch), Control { share: 0.0, known: DVec3::ZERO })
            }
        }
    }

    /// The estimate proper, with samples that the control knows nothing of.
    pub(crate) fn estimate(
        &self,
        receiver: &Receiver,
        plan: Plan,
        seed: u64,
        control: Control,
        scratch: &mut Scratch,
    ) -> Moments {
        match self {
            Transport::Sum(terms) => {
                sample(terms, receiver, plan, seed, scratch);
                scratch.batches.moments(control)
            }
            Transport::ShVisibility(product) => product.estimate(receiver, plan, seed, scratch),
        }
    }
}

fn sample(terms: &[Box<dyn Term>], receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch) {
    scratch.batches.start(plan.batches);
    for (index, term) in (0..).zip(terms) {
        term.sample(receiver, plan, crate::sampling::mix(seed, index), scratch);
    }
}
