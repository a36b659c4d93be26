//! Shading of receivers, some hundred at a time, so that their horizons stay in the nearest caches.

use glam::{Vec2, Vec3};
use halflight_blockers::Tally;
use halflight_contract::{Params, Quantity};
use halflight_horizons::{Horizons, Points};
use halflight_scenes::{HeightField, Receivers, Rgb};
use halflight_sh::{Batch, Block, LANES, apply_bands, clamped_cosine, coefficients, pack};

use crate::casters::{self, Casters};
use crate::plan::{Plan, View};
use crate::sum::{Places, sum};

/// Receivers that one task handles.
pub(crate) const CHUNK: usize = 256;

/// Where receivers are on the field.
#[derive(Clone, Copy)]
pub(crate) struct Ground {
    /// The field's object.
    pub(crate) object: u32,
    /// Of vertex `(0, 0)`.
    pub(crate) origin: Vec2,
    pub(crate) cell: Vec2,
}

impl Ground {
    /// Of an object that is a field.
    pub(crate) fn new(object: usize, field: &HeightField) -> Ground {
        Ground { object: object as u32, origin: field.origin(), cell: field.cell() }
    }

    /// Grid coordinates of a receiver, of the point below it where it is on something else.
    pub(crate) fn place(&self, receivers: &Receivers, receiver: usize) -> Vec2 {
        let place = receivers.place[receiver];
        if place.object == Some(self.object) {
            return place.uv;
        }
        (receivers.position[receiver].truncate() - self.origin) / self.cell
    }
}

/// What a task needs to shade receivers.
pub(crate) struct Shading<'a> {
    pub(crate) ground: Ground,
    pub(crate) horizons: &'a dyn Horizons,
    pub(crate) plan: &'a Plan,
    pub(crate) batch: Batch,
    pub(crate) quantity: Quantity,
    pub(crate) params: &'a Params,
    pub(crate) ambient: bool,
    pub(crate) casters: Option<&'a Casters<'a>>,
    /// A factor for each band of visibility.
    pub(crate) window: Option<&'a [f32]>,
}

/// One task's receivers and scratch. Vectors lie receiver after receiver, blocks 16 receivers side by side.
struct Chunk<'a> {
    receivers: &'a Receivers,
    /// Numbers of those that are valid.
    valid: &'a [usize],
    /// Elevations of the horizon, azimuth after azimuth.
    elevations: Vec<f32>,
    /// Whether the field hides a sun, sun after sun.
    hidden: Vec<bool>,
    places: Places,
    /// Visibilities, with room for whole lanes.
    vectors: Vec<f32>,
    /// `H(N)`.
    weights: Vec<Block<f32>>,
    /// Visibilities among casters beside the field.
    beside: Vec<Block<f32>>,
    irradiance: Vec<[Block<f32>; 3]>,
}

impl Shading<'_> {
    /// Fills `out` for the receivers from `first` on, leaving invalid ones as they are.
    pub(crate) fn chunk(&self, receivers: &Receivers, first: usize, out: &mut [f32]) -> Tally {
        let channels = self.quantity.channels();
        let valid: Vec<usize> = (first..first + out.len() / channels).filter(|&i| receivers.valid[i]).collect();
        let mut tally = Tally::default();
        if valid.is_empty() {
            return tally;
        }
        let mut chunk = self.open(receivers, &valid);
        self.look(&mut chunk);
        if let Some(casters) = self.casters {
            self.beside(casters, &mut chunk, &mut tally);
        }
        let row = |place: usize| (valid[place] - first) * channels;
        if let Quantity::Visibility { .. } = self.quantity {
            self.visibilities(&mut chunk);
            let vectors = chunk.vectors.chunks_exact(coefficients(self.batch.order()));
            for (place, vector) in vectors.take(valid.len()).enumerate() {
                out[row(place)..][..channels].copy_from_slice(&vector[..channels]);
            }
            return tally;
        }
        self.shade(&mut chunk);
        for (place, &receiver) in valid.iter().enumerate() {
            let irradiance = chunk.irradiance[place / LANES].map(|channel| channel.0[place % LANES]);
            let radiance = Rgb::from_array(irradiance) * receivers.albedo[receiver];
            out[row(place)..][..3].copy_from_slice(&radiance.to_array());
        }
        tally
    }

    fn open<'c>(&self, receivers: &'c Receivers, valid: &'c [usize]) -> Chunk<'c> {
        let (size, groups) = (coefficients(self.batch.order()), valid.len().div_ceil(LANES));
        Chunk {
            receivers,
            valid,
            elevations: vec![0.0; valid.len() * self.plan.azimuths.len()],
            hidden: vec![false; valid.len() * self.plan.suns.len()],
            places: Places::default(),
            vectors: vec![0.0; groups * LANES * size],
            weights: vec![Block::ZERO; groups * size],
            beside: Vec::new(),
            irradiance: vec![[Block::ZERO; 3]; groups],
        }
    }

    fn look(&self, chunk: &mut Chunk<'_>) {
        let places: Vec<Vec2> = chunk.valid.iter().map(|&i| self.ground.place(chunk.receivers, i)).collect();
        let (x, y): (Vec<f32>, Vec<f32>) = places.iter().map(|place| (place.x, place.y)).unzip();
        let (at, count) = (Points { x: &x, y: &y }, chunk.valid.len());
        if self.plan.suns.is_empty() {
            self.horizons.elevations(at, 0..self.plan.azimuths.len(), &mut chunk.elevations);
            return;
        }
        for view in &self.plan.views {
            let azimuths = view.first..view.first + view.azimuths;
            self.horizons.elevations(
                at,
                azimuths.clone(),
                &mut chunk.elevations[count * azimuths.start..count * azimuths.end],
            );
        }
        for (sun, hidden) in self.plan.suns.iter().zip(chunk.hidden.chunks_exact_mut(count)) {
            self.horizons.hidden(at, sun.azimuth, sun.elevation.max(0.0), hidden);
        }
    }

    fn beside(&self, casters: &Casters<'_>, chunk: &mut Chunk<'_>, tally: &mut Tally) {
        let (order, size) = (self.batch.order(), coefficients(self.batch.order()));
        let mut scratch = casters::Scratch::new(order);
        chunk.beside = vec![Block::ZERO; chunk.weights.len()];
        for (group, out) in chunk.valid.chunks(LANES).zip(chunk.beside.chunks_exact_mut(size)) {
            casters.visibility(self.params, chunk.receivers, group, &mut scratch, tally, out);
        }
    }

    /// Total visibilities through a view's swath, windowed, into the chunk's vectors.
    fn see(&self, view: &View, chunk: &mut Chunk<'_>) {
        let (count, size) = (chunk.valid.len(), coefficients(self.batch.order()));
        let elevations = &chunk.elevations[view.first * count..][..view.azimuths * count];
        chunk.places.set(self.batch.simd(), count, elevations, &view.wedges);
        let vectors = &mut chunk.vectors[..count * size];
        sum(self.batch.simd(), &view.tables, &view.wedges, &chunk.places, vectors);
        if let Some(window) = self.window {
            vectors.chunks_exact_mut(size).for_each(|vector| apply_bands(window, vector));
        }
    }

    /// Visibilities through the complete swath, which is the last view.
    fn visibilities(&self, chunk: &mut Chunk<'_>) {
        let Some(view) = self.plan.views.last() else { return };
        self.see(view, chunk);
        if !chunk.beside.is_empty() {
            let order = self.batch.order();
            let [mut blocks, mut product] = [0; 2].map(|_| vec![Block::ZERO; chunk.beside.len()]);
            pack(order, &chunk.vectors, &mut blocks);
            self.batch.product(&blocks, &chunk.beside, &mut product);
            halflight_sh::unpack(order, &product, &mut chunk.vectors);
        }
    }

    /// `L · (H(N) * V)` of all views, and what arrives from suns, for each colour.
    fn shade(&self, chunk: &mut Chunk<'_>) {
        let (order, size) = (self.batch.order(), coefficients(self.batch.order()));
        let cosine: Vec<Block<f32>> = clamped_cosine(order).iter().map(|&v| Block::splat(v as f32)).collect();
        for (group, weights) in chunk.valid.chunks(LANES).zip(chunk.weights.chunks_exact_mut(size)) {
            self.batch.rotate_zonal(&cosine, &[lanes(group, &chunk.receivers.normal)], weights);
        }
        let [mut visibility, mut transfer] = [0; 2].map(|_| vec![Block::ZERO; size]);
        for view in &self.plan.views {
            self.see(view, chunk);
            for group in 0..chunk.irradiance.len() {
                let weights = &chunk.weights[group * size..][..size];
                pack(order, &chunk.vectors[group * LANES * size..][..LANES * size], &mut visibility);
                if let Some(beside) = chunk.beside.chunks_exact(size).nth(group) {
                    self.batch.product(&visibility, beside, &mut transfer);
                    std::mem::swap(&mut visibility, &mut transfer);
                }
                if self.ambient {
                    self.dim(view, weights, &visibility, &mut chunk.irradiance[group]);
                    continue;
                }
                self.batch.product(weights, &visibility, &mut transfer);
                for (sum, light) in chunk.irradiance[group].iter_mut().zip(&view.light) {
                    add(sum, &self.batch.dot(light, &transfer));
                }
            }
        }
        self.suns(chunk);
    }

    /// Adds unshadowed irradiance times the open share of the cosine.
    fn dim(&self, view: &View, weights: &[Block<f32>], visibility: &[Block<f32>], irradiance: &mut [Block<f32>; 3]) {
        let open = self.batch.dot_each(weights, visibility);
        for (sum, light) in irradiance.iter_mut().zip(&view.light) {
            let light = self.batch.dot(light, weights);
            let dimmed = std::array::from_fn(|lane| open.0[lane].clamp(0.0, 1.0) * light.0[lane]);
            add(sum, &Block(dimmed));
        }
    }

    fn suns(&self, chunk: &mut Chunk<'_>) {
        let count = chunk.valid.len();
        for (sun, hidden) in self.plan.suns.iter().zip(chunk.hidden.chunks_exact(count)) {
            if sun.elevation <= 0.0 {
                continue;
            }
            for (place, (&receiver, &hidden)) in chunk.valid.iter().zip(hidden).enumerate() {
                let cosine = sun.direction.dot(chunk.receivers.normal[receiver]).max(0.0);
                let seen = if hidden { 0.0 } else { cosine };
                let colour = (sun.irradiance * seen).to_array();
                let sums = &mut chunk.irradiance[place / LANES];
                sums.iter_mut().zip(colour).for_each(|(sum, value)| sum.0[place % LANES] += value);
            }
        }
    }
}

fn add(sum: &mut Block<f32>, other: &Block<f32>) {
    sum.0.iter_mut().zip(other.0).for_each(|(sum, value)| *sum += value);
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
