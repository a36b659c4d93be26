//! Baked blockers on the device: the CPU accumulates them once, shaders go on from there.

use halflight_contract::{Job, Meter, Params, Result};
use halflight_gpu::{Gpu, Part, Resident};
use halflight_scenes::Receivers;
use halflight_sh::coefficients;

use crate::bake::Bake;
use crate::stage::Stage;
use crate::{Accumulator, params};

/// What shaders read of blockers that never move.
pub(super) struct Baked<A> {
    bake: Bake,
    accumulator: A,
    sums: Resident,
}

/// Bytes of a receiver: how many circles, and what they sum up to.
pub(super) fn bytes_each(order: usize) -> u64 {
    4 * (1 + coefficients(order) as u64)
}

impl<A: Accumulator> Baked<A> {
    /// Takes the blockers that never move out of a stage, if they are to be baked.
    pub(super) fn take(job: &Job<'_, '_>, stage: &mut Stage<'_>) -> Option<Self> {
        let accumulator = A::new(job.params);
        let sums = Resident::new("baked blockers");
        Bake::take::<A>(job, stage).map(|bake| Baked { bake, accumulator, sums })
    }

    pub(super) fn retune(&mut self, params: &Params) {
        self.accumulator = A::new(params);
        self.bake.clear();
    }

    /// Takes receivers where they are now.
    pub(super) fn move_to(&mut self, receivers: &Receivers) {
        self.bake.move_to(receivers);
    }

    /// Accumulates at receivers that lack their blockers, and uploads for `valid` ones in their order if there was one, or if they
    /// lie in another order than before.
    pub(super) fn upload(
        &mut self,
        gpu: &Gpu,
        params: &Params,
        receivers: &Receivers,
        (valid, moved): (&[u32], bool),
        meter: &mut dyn Meter,
    ) -> Result<()> {
        let order = params::accumulated_order(params);
        if !self.bake.fill(&self.accumulator, (params::gather(params), order), receivers, meter) && !moved {
            return Ok(());
        }
        let mut words = Vec::with_capacity(valid.len() * bytes_each(order) as usize / 4);
        for &receiver in valid {
            let (circles, sums) = self.bake.at(receiver as usize);
            words.push(circles);
            words.extend(sums.iter().map(|value| value.to_bits()));
        }
        words.resize(words.len().max(bytes_each(order) as usize / 4), 0); // no buffer ends before its first receiver
        Ok(self.sums.upload(gpu, meter, &words)?)
    }

    pub(super) fn part(&self, first: u64, receivers: u64, order: usize) -> Part<'_> {
        self.sums.part(first * bytes_each(order), receivers * bytes_each(order))
    }

    pub(super) fn host_bytes(&self) -> usize {
        self.bake.bytes()
    }

    pub(super) fn device_bytes(&self) -> u64 {
        self.sums.bytes()
    }
}
