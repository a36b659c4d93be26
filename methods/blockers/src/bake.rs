//! What blockers that never move leave, kept for receivers that stay where they are (Ren 2006, §7: static blockers are "baked in").

use glam::Vec3;
use halflight_contract::{Job, Meter, counted, timed};
use halflight_proxies::blockers;
use halflight_scenes::{Receivers, Sphere};
use halflight_sh::{LANES, coefficients};
use rayon::prelude::*;

use crate::stage::Stage;
use crate::{Accumulator, Blockers, Gather, Tally, params};

/// Receivers that one task handles.
const CHUNK: usize = 256;

/// Sums, or whatever a method accumulates, of still blockers at each receiver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bake {
    /// The blockers that never move.
    pub(crate) spheres: Vec<Sphere>,
    /// Position and normal of each receiver; none if it is not valid.
    places: Vec<Option<[Vec3; 2]>>,
    /// Receivers that are not baked where they are.
    missing: Vec<usize>,
    /// Circles a receiver.
    counts: Vec<u32>,
    /// As many coefficients a receiver.
    sums: Vec<f32>,
}

impl Bake {
    /// Takes the blockers that never move out of a stage, if they are to be baked.
    pub(crate) fn take<A: Accumulator>(job: &Job<'_, '_>, stage: &mut Stage<'_>) -> Option<Self> {
        params::bakes(job.params, A::PARAMS).then(|| {
            let mut still = stage.proxies.clone();
            for ((object, moving), still) in job.scene.objects.iter().zip(&mut stage.proxies).zip(&mut still) {
                *(if object.rests() { moving } else { still }) = None;
            }
            Bake { spheres: blockers(job.scene, &job.scene.frame(0), &still).spheres, ..Bake::default() }
        })
    }

    /// Forgets what was accumulated.
    pub(crate) fn clear(&mut self) {
        self.missing = (0..self.places.len()).filter(|&receiver| self.places[receiver].is_some()).collect();
        self.counts.clear();
        self.sums.clear();
    }

    /// Takes receivers where they are now: those that have moved lack their blockers.
    pub(crate) fn move_to(&mut self, receivers: &Receivers) {
        let place = |receiver: usize| [receivers.position[receiver], receivers.geometric_normal[receiver]];
        let places: Vec<_> = (0..receivers.len()).map(|i| receivers.valid[i].then(|| place(i))).collect();
        if places.len() != self.places.len() {
            self.places = places;
            self.clear();
            return;
        }
        let moved = |&receiver: &usize| places[receiver].is_some() && places[receiver] != self.places[receiver];
        self.missing.extend((0..places.len()).filter(moved));
        self.missing.sort_unstable();
        self.missing.dedup();
        self.places = places;
    }

    /// Accumulates the blockers at receivers that lack them, in this order, and returns whether there was one.
    pub(crate) fn fill<A: Accumulator>(
        &mut self,
        accumulator: &A,
        (gather, order): (Gather, usize),
        receivers: &Receivers,
        meter: &mut dyn Meter,
    ) -> bool {
        if self.missing.is_empty() {
            return false;
        }
        let baked: Vec<_> = timed(meter, "bake blockers", |_| {
            let chunks = self.missing.par_chunks(CHUNK);
            chunks
                .flat_map_iter(|numbers| accumulated(accumulator, gather, receivers, numbers, &self.spheres))
                .collect()
        });
        let circles = baked.iter().map(|(count, _)| u64::from(*count)).sum();
        counted(meter, &[("receivers baked", baked.len() as u64), ("blockers baked", circles)]);
        let size = coefficients(order);
        self.counts.resize(self.places.len(), 0);
        self.sums.resize(self.places.len() * size, 0.0);
        for (receiver, (count, sums)) in self.missing.drain(..).zip(baked) {
            self.counts[receiver] = count;
            self.sums[receiver * size..][..size].copy_from_slice(&sums);
        }
        true
    }

    /// Circles baked at a receiver, and what was accumulated of them.
    pub(crate) fn at(&self, receiver: usize) -> (u32, &[f32]) {
        let size = self.sums.len() / self.counts.len();
        (self.counts[receiver], &self.sums[receiver * size..][..size])
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let receivers = size_of_val(self.places.as_slice()) + size_of_val(self.counts.as_slice());
        receivers + size_of_val(self.sums.as_slice()) + size_of_val(self.spheres.as_slice())
    }
}

/// What is accumulated of spheres at receivers, and of how many circles.
fn accumulated<A: Accumulator>(
    accumulator: &A,
    gather: Gather,
    receivers: &Receivers,
    numbers: &[usize],
    spheres: &[Sphere],
) -> Vec<(u32, Vec<f32>)> {
    let (mut state, mut baked) = (accumulator.state(), Vec::with_capacity(numbers.len()));
    let mut tally = Tally::default();
    for group in numbers.chunks(LANES) {
        accumulator.begin(&mut state);
        let blockers = Blockers { spheres, ratios: &[] };
        let counts = gather.circles(receivers, group, blockers, &mut tally, |circles| {
            accumulator.block(&mut state, circles);
        });
        let sums = accumulator.kept(&mut state).unwrap_or_default();
        let lane = |lane| (counts[lane], sums.iter().map(|block| block.0[lane]).collect());
        baked.extend((0..group.len()).map(lane));
    }
    baked
}
