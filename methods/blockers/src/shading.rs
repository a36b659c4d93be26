//! Shading of receivers, 16 side by side.

use glam::Vec3;
use halflight_contract::Quantity;
use halflight_scenes::{Receivers, Rgb};
use halflight_sh::{
    Batch, Block, LANES, apply_bands, clamped_cosine, coefficients, pack, project_binary_bound, unpack,
};

use crate::lamps::{Glow, Lamp, Seers};
use crate::{Accumulator, Blockers, Gather, Tally, Work};

/// Above this, light times visibility could overflow: the guard then acts even where it is switched off.
const OVERFLOW: f32 = 1e30;

/// What a task needs to shade receivers.
pub(crate) struct Shading<'a, A> {
    pub(crate) accumulator: &'a A,
    /// Of light and shading.
    pub(crate) batch: Batch,
    /// Of accumulation, of this order or a higher one.
    pub(crate) fine: Batch,
    pub(crate) gather: Gather,
    pub(crate) quantity: Quantity,
    pub(crate) guard: bool,
    /// A factor for each band of visibility.
    pub(crate) visibility_window: Option<Vec<f32>>,
    /// A factor for each band of light.
    pub(crate) light_window: &'a [f32],
    /// Distant light, windowed.
    pub(crate) light: [Vec<f32>; 3],
    pub(crate) lamps: &'a [Lamp],
}

/// One task's scratch: vectors of 16 receivers, coefficient by coefficient unless said otherwise.
struct Scratch<S> {
    state: S,
    visibility: Vec<Block<f32>>,
    /// Visibility, one receiver after the other.
    vectors: Vec<f32>,
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
        out: &mut [f32],
    ) -> (Tally, Work) {
        let channels = self.quantity.channels();
        let valid: Vec<usize> = (first..first + out.len() / channels).filter(|&i| receivers.valid[i]).collect();
        self.shade(receivers, &valid, blockers, |place, values| {
            out[(valid[place] - first) * channels..][..channels].copy_from_slice(values);
        })
    }

    /// Calls `write` with the place among the numbers and the values of each receiver.
    pub(crate) fn shade(
        &self,
        receivers: &Receivers,
        numbers: &[usize],
        blockers: Blockers<'_>,
        mut write: impl FnMut(usize, &[f32]),
    ) -> (Tally, Work) {
        let (channels, size) = (self.quantity.channels(), coefficients(self.batch.order()));
        let mut scratch = self.scratch();
        let (mut tally, mut work) = Default::default();
        for (group, first) in numbers.chunks(LANES).zip((0..).step_by(LANES)) {
            self.visibility(receivers, group, blockers, &mut scratch, &mut tally, &mut work);
            if let Quantity::Visibility { .. } = self.quantity {
                let vectors = scratch.vectors.chunks_exact(size).take(group.len());
                (first..).zip(vectors).for_each(|(place, vector)| write(place, &vector[..channels]));
            } else {
                let irradiance = self.irradiance(receivers, group, &mut scratch);
                for (lane, &receiver) in group.iter().enumerate() {
                    let irradiance = Rgb::from_array(irradiance.map(|channel| channel.0[lane]));
                    write(first + lane, &(irradiance * receivers.albedo[receiver]).to_array());
                }
            }
        }
        (tally, work)
    }

    fn scratch(&self) -> Scratch<A::State> {
        let (order, fine) = (self.batch.order(), coefficients(self.fine.order()));
        let blocks = || vec![Block::ZERO; coefficients(order)];
        Scratch {
            state: self.accumulator.state(),
            visibility: vec![Block::ZERO; fine],
            vectors: vec![0.0; LANES * fine],
            cosine: clamped_cosine(order).iter().map(|&value| Block::splat(value as f32)).collect(),
            weights: blocks(),
            transfer: blocks(),
            glow: Glow::new(self.batch),
        }
    }

    /// Stores the visibilities of a group, guarded, cut down to the order and windowed, in `vectors`.
    fn visibility(
        &self,
        receivers: &Receivers,
        group: &[usize],
        blockers: Blockers<'_>,
        scratch: &mut Scratch<A::State>,
        tally: &mut Tally,
        work: &mut Work,
    ) {
        let (accumulator, fine) = (self.accumulator, self.fine.order());
        let Scratch { state, visibility, vectors, .. } = scratch;
        accumulator.begin(state);
        let accumulate = |circles: &_| accumulator.block(state, circles);
        let counts = self.gather.circles(receivers, group, blockers, tally, accumulate);
        accumulator.finish(state, &counts[..group.len()], visibility, work);
        unpack(fine, visibility, vectors);
        for vector in vectors.chunks_exact_mut(coefficients(fine)).take(group.len()) {
            if self.guard || vector.iter().any(|v| v.is_nan() || v.abs() > OVERFLOW) {
                work.guarded += u64::from(project_binary_bound(fine, vector));
            }
        }
        let (size, kept) = (coefficients(fine), coefficients(self.batch.order()));
        (1..LANES).for_each(|lane| vectors.copy_within(lane * size..lane * size + kept, lane * kept));
        if let Some(window) = &self.visibility_window {
            vectors.chunks_exact_mut(kept).take(group.len()).for_each(|vector| apply_bands(window, vector));
        }
    }

    /// `(L, H(N) * g)` for each colour, `L` the distant light and that of lamps.
    fn irradiance(&self, receivers: &Receivers, group: &[usize], scratch: &mut Scratch<A::State>) -> [Block<f32>; 3] {
        let Scratch { visibility, vectors, cosine, weights, transfer, glow, .. } = scratch;
        let normal = lanes(group, &receivers.normal);
        let size = coefficients(self.batch.order());
        let visibility = &mut visibility[..size];
        pack(self.batch.order(), &vectors[..LANES * size], visibility);
        self.batch.rotate_zonal(cosine, &[normal], weights);
        self.batch.product(weights, visibility, transfer);
        let mut irradiance = std::array::from_fn(|channel| self.batch.dot(&self.light[channel], transfer));
        if !self.lamps.is_empty() {
            let position = lanes(group, &receivers.position);
            let seers = Seers { position, normal, visibility };
            glow.add(self.lamps, &seers, self.light_window, self.guard, &mut irradiance);
        }
        irradiance
    }
}

/// The vectors of a group of receivers, a lane each.
fn lanes(group: &[usize], vectors: &[Vec3]) -> [Block<f32>; 3] {
    let mut blocks = [Block::ZERO; 3];
    for (lane, &receiver) in group.iter().enumerate() {
        let components = vectors[receiver].to_array();
        blocks.iter_mut().zip(components).for_each(|(axis, component)| axis.0[lane] = component);
    }
    blocks
}
