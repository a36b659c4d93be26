//! Shading of receivers, 16 side by side.

use halflight_contract::Quantity;
use halflight_scenes::{Receivers, Rgb};
use halflight_sh::{Batch, Block, LANES, clamped_cosine, coefficients, project_binary_bound};

use crate::bake::Bake;
use crate::lamps::{Glow, Lamp, Lobes, Seers, Shine};
use crate::seen::lanes;
use crate::{Accumulator, Blockers, Circles, Counts, Gather, Tally, Work};

/// Above this, light times visibility could overflow: the guard then acts even where it is switched off.
const OVERFLOW: f32 = 1e30;

/// What a task needs to shade receivers.
pub(crate) struct Shading<'a, A> {
    pub(crate) accumulator: &'a A,
    /// What is known of blockers that are not among those given.
    pub(crate) bake: Option<&'a Bake>,
    /// Of light and shading.
    pub(crate) batch: Batch,
    /// Of accumulation, of this order or a higher one.
    pub(crate) fine: Batch,
    pub(crate) gather: Gather,
    pub(crate) quantity: Quantity,
    pub(crate) guard: bool,
    /// A factor for each coefficient of visibility.
    pub(crate) visibility_window: Option<Vec<f32>>,
    /// A factor for each band of light.
    pub(crate) light_window: &'a [f32],
    /// Distant light, windowed.
    pub(crate) light: [Vec<f32>; 3],
    pub(crate) lamps: &'a [Lamp],
    pub(crate) lobes: Option<&'a Lobes>,
}

/// One task's scratch: vectors of 16 receivers, coefficient by coefficient unless said otherwise.
pub(crate) struct Scratch<S> {
    state: S,
    visibility: Vec<Block<f32>>,
    /// One receiver's.
    vector: Vec<f32>,
    /// `H` about z, the same in all lanes.
    cosine: Vec<Block<f32>>,
    /// `H(N)`.
    weights: Vec<Block<f32>>,
    /// `H(N) * g`.
    transfer: Vec<Block<f32>>,
    glow: Glow,
}

impl<A: Accumulator> Shading<'_, A> {
    /// Fills `out` for the receivers from `first` on, leaving invalid ones as they are.
    pub(crate) fn chunk(
        &self,
        receivers: &Receivers,
        first: usize,
        blockers: Blockers<'_>,
        scratch: &mut Scratch<A::State>,
        out: &mut [f32],
    ) -> (Tally, Work) {
        let channels = self.quantity.channels();
        let valid: Vec<usize> = (first..first + out.len() / channels).filter(|&i| receivers.valid[i]).collect();
        self.shade(receivers, &valid, blockers, scratch, |place, values| {
            out[(valid[place] - first) * channels..][..channels].copy_from_slice(values);
        })
    }

    /// Calls `write` with the place among the numbers and the values of each receiver.
    pub(crate) fn shade(
        &self,
        receivers: &Receivers,
        numbers: &[usize],
        blockers: Blockers<'_>,
        scratch: &mut Scratch<A::State>,
        mut write: impl FnMut(usize, &[f32]),
    ) -> (Tally, Work) {
        let channels = self.quantity.channels();
        let (mut tally, mut work) = Default::default();
        for (group, first) in numbers.chunks(LANES).zip((0..).step_by(LANES)) {
            self.visibility(receivers, group, blockers, scratch, &mut tally, &mut work);
            if let Quantity::Visibility { .. } = self.quantity {
                for lane in 0..group.len() {
                    take(lane, &scratch.visibility[..channels], &mut scratch.vector[..channels]);
                    write(first + lane, &scratch.vector[..channels]);
                }
            } else {
                let irradiance = self.irradiance(receivers, group, scratch);
                for (lane, &receiver) in group.iter().enumerate() {
                    let irradiance = Rgb::from_array(irradiance.map(|channel| channel.0[lane]));
                    write(first + lane, &(irradiance * receivers.albedo[receiver]).to_array());
                }
            }
        }
        (tally, work)
    }

    /// Room for a task.
    pub(crate) fn scratch(&self) -> Scratch<A::State> {
        let (order, fine) = (self.batch.order(), coefficients(self.fine.order()));
        let blocks = || vec![Block::ZERO; coefficients(order)];
        Scratch {
            state: self.accumulator.state(),
            visibility: vec![Block::ZERO; fine],
            vector: vec![0.0; fine],
            cosine: clamped_cosine(order).iter().map(|&value| Block::splat(value as f32)).collect(),
            weights: blocks(),
            transfer: blocks(),
            glow: Glow::new(self.batch),
        }
    }

    /// The visibilities of a group, guarded; those of the order, which come first, windowed.
    fn visibility(
        &self,
        receivers: &Receivers,
        group: &[usize],
        blockers: Blockers<'_>,
        scratch: &mut Scratch<A::State>,
        tally: &mut Tally,
        work: &mut Work,
    ) {
        let accumulator = self.accumulator;
        let Scratch { state, visibility, vector, .. } = scratch;
        accumulator.begin(state);
        let kept = self.resume(group, state);
        let accumulate = |circles: &Circles<'_>| accumulator.block(state, circles);
        let mut all = self.gather.circles(receivers, group, blockers, tally, accumulate);
        all.iter_mut().zip(kept).for_each(|(all, kept)| *all += kept);
        let counts = Counts { all: &all[..group.len()], kept: &kept[..group.len()] };
        accumulator.finish(state, &counts, visibility, work);
        work.kept += counts.kept.iter().map(|&count| u64::from(count)).sum::<u64>();
        let inside = self.fine.within_binary_bound(visibility);
        for lane in (0..group.len()).filter(|&lane| !inside[lane]) {
            take(lane, visibility, vector);
            if self.guard || vector.iter().any(|v| v.is_nan() || v.abs() > OVERFLOW) {
                work.guarded += u64::from(project_binary_bound(self.fine.order(), vector));
                visibility.iter_mut().zip(&*vector).for_each(|(block, value)| block.0[lane] = *value);
            }
        }
        if let Some(window) = &self.visibility_window {
            self.batch.scale(window, &mut visibility[..window.len()]);
        }
    }

    /// Sets what is known of blockers that are not gathered again, and returns how many each receiver has.
    fn resume(&self, group: &[usize], state: &mut A::State) -> [u32; LANES] {
        let mut counts = [0; LANES];
        let Some(bake) = self.bake else { return counts };
        let Some(sums) = self.accumulator.kept(state) else { return counts };
        for (lane, (&receiver, count)) in group.iter().zip(&mut counts).enumerate() {
            let (known, values) = bake.at(receiver);
            *count = known;
            sums.iter_mut().zip(values).for_each(|(block, value)| block.0[lane] = *value);
        }
        counts
    }

    /// `(L, H(N) * g)` for each colour, `L` the distant light and that of lamps.
    fn irradiance(&self, receivers: &Receivers, group: &[usize], scratch: &mut Scratch<A::State>) -> [Block<f32>; 3] {
        let Scratch { visibility, cosine, weights, transfer, glow, .. } = scratch;
        let normal = lanes(group, &receivers.normal);
        let visibility = &visibility[..coefficients(self.batch.order())];
        self.batch.rotate_zonal(cosine, &[normal], weights);
        self.batch.product(weights, visibility, transfer);
        let mut irradiance = std::array::from_fn(|channel| self.batch.dot(&self.light[channel], transfer));
        if !self.lamps.is_empty() {
            let position = lanes(group, &receivers.position);
            let seers = Seers { position, normal, visibility };
            let shine = Shine { window: self.light_window, guard: self.guard, lobes: self.lobes };
            glow.add(self.lamps, &seers, &shine, &mut irradiance);
        }
        irradiance
    }
}

/// The vector in a lane.
fn take(lane: usize, blocks: &[Block<f32>], vector: &mut [f32]) {
    vector.iter_mut().zip(blocks).for_each(|(value, block)| *value = block.0[lane]);
}
