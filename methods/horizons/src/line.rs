//! A level's heights along a row of receivers, with its bilinear or bicubic B-spline reconstruction.

use halflight_sh_kernels::Lanes;

use crate::grid::Lattice;
use crate::level::{BEYOND, Level, PAD};

/// Lanes from a place in a slice that holds 16 entries from there on.
#[inline(always)]
pub(crate) fn load<V: Lanes<Scalar = f32>>(from: &[f32], at: usize) -> V {
    V::load(from[at..at + 16].try_into().expect("16 entries"), 0)
}

/// Writes lanes to a place in a slice that holds 16 entries from there on.
#[inline(always)]
pub(crate) fn store<V: Lanes<Scalar = f32>>(lanes: V, to: &mut [f32], at: usize) {
    lanes.store((&mut to[at..at + 16]).try_into().expect("16 entries"), 0);
}

/// Shares of the `T` samples around a point at `t` in `[0, 1)` from the one before it: of two linear, of four by the cubic
/// B-spline (eq. 4), which smooths and does not interpolate.
#[inline(always)]
pub(crate) fn shares<V: Lanes<Scalar = f32>, const T: usize>(t: V) -> [V; T] {
    let mut shares = [t; T];
    let u = V::constant(1.0).sub(t);
    if T == 2 {
        shares[0] = u;
    } else {
        shares[0] = outer(u);
        shares[1] = inner(t);
        shares[2] = inner(u);
        shares[3] = outer(t);
    }
    shares
}

#[inline(always)]
fn inner<V: Lanes<Scalar = f32>>(t: V) -> V {
    t.mul(t).mul(t.mul_add(V::constant(0.5), V::constant(-1.0))).add(V::constant(2.0 / 3.0))
}

#[inline(always)]
fn outer<V: Lanes<Scalar = f32>>(t: V) -> V {
    t.mul(t).mul(t).mul(V::constant(1.0 / 6.0))
}

/// What takes heights.
pub(crate) trait Sink<V> {
    /// Takes those of the receivers from one on.
    fn put(&mut self, heights: V, receiver: usize);
}

/// The heights themselves.
pub(crate) struct Heights<'a>(pub(crate) &'a mut [f32]);

impl<V: Lanes<Scalar = f32>> Sink<V> for Heights<'_> {
    #[inline(always)]
    fn put(&mut self, heights: V, receiver: usize) {
        store(heights, self.0, receiver);
    }
}

/// How steep it is from the receivers' own heights up to others.
pub(crate) struct Slopes<'a> {
    pub(crate) own: &'a [f32],
    /// 1 over the distance.
    pub(crate) inverse: f32,
    pub(crate) out: &'a mut [f32],
}

impl<V: Lanes<Scalar = f32>> Sink<V> for Slopes<'_> {
    #[inline(always)]
    fn put(&mut self, heights: V, receiver: usize) {
        store(heights.sub(load(self.own, receiver)).mul(V::splat(self.inverse)), self.out, receiver);
    }
}

/// The steepest slopes so far.
pub(crate) struct Steepest<'a>(pub(crate) Slopes<'a>);

impl<V: Lanes<Scalar = f32>> Sink<V> for Steepest<'_> {
    #[inline(always)]
    fn put(&mut self, heights: V, receiver: usize) {
        let Slopes { own, inverse, ref mut out } = self.0;
        let slopes = heights.sub(load(own, receiver)).mul(V::splat(inverse));
        store(slopes.max(load(out, receiver)), out, receiver);
    }
}

/// The numbers of lanes.
const NUMBERS: [f32; 16] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Lanes of 16 entries from a place on.
#[inline(always)]
fn part<V: Lanes<Scalar = f32>>(from: &[f32], at: usize, lane: usize) -> V {
    V::load(from[at..at + 16].try_into().expect("16 entries"), lane / V::WIDTH)
}

/// The sum of each receiver's samples by their shares, of 16 the one with a number and those after it.
#[inline(always)]
fn pick<V: Lanes<Scalar = f32>, const T: usize>(window: &[f32; 16], sample: V, along: [V; T]) -> V {
    let mut sum = V::constant(0.0);
    for (tap, share) in along.iter().enumerate() {
        sum = sample.add(V::constant(tap as f64)).select_from(window).mul_add(*share, sum);
    }
    sum
}

/// A level along receivers that lie a vertex apart on a row of the field, reconstructed from `T · T` samples. Beyond its border it
/// goes on as it ends there.
pub(crate) struct Line<'l, const T: usize> {
    heights: &'l [f32],
    /// Where the rows begin, their padding left out.
    rows: [usize; T],
    shares: [f32; T],
    /// The first sample that the first receiver needs, and how far it lies from that of its samples which is before it.
    first: isize,
    fraction: f32,
    /// Samples from a receiver to the next.
    step: f32,
    columns: isize,
}

impl<'l, const T: usize> Line<'l, T> {
    const BEFORE: usize = T / 2 - 1;

    /// From a point in grid coordinates of the field on, which may lie outside.
    #[inline(always)]
    pub(crate) fn new(level: &'l Level, x: f64, y: f64) -> Self {
        let Lattice { scale, shift, .. } = level.lattice;
        Self::among(level, scale, (x + 0.5) * scale[0] + shift[0] - 0.5, (y + 0.5) * scale[1] + shift[1] - 0.5)
    }

    /// From a point in coordinates of a grid with `scale` samples of the level in the length of one of its own.
    #[inline(always)]
    pub(crate) fn seen(level: &'l Level, scale: [f64; 2], x: f64, y: f64) -> Self {
        Self::among(level, scale, (x + 0.5) * scale[0] - 0.5, (y + 0.5) * scale[1] - 0.5)
    }

    /// From a point in coordinates of the level's samples on.
    #[inline(always)]
    fn among(level: &'l Level, scale: [f64; 2], along: f64, across: f64) -> Self {
        let across = across.clamp(-2.0, level.size[1] as f64 + 1.0);
        let (whole, below) = (along.floor(), across.floor());
        let (first, last) = (below as isize - Self::BEFORE as isize, level.size[1] as isize - 1);
        let row = |tap: usize| (first + tap as isize).clamp(0, last) as usize * level.stride() + PAD;
        Line {
            heights: &level.heights,
            rows: std::array::from_fn(row),
            shares: shares((across - below) as f32),
            first: whole as isize - Self::BEFORE as isize,
            fraction: (along - whole) as f32,
            step: scale[0] as f32,
            columns: level.size[0] as isize,
        }
    }

    /// Gives the heights at some receivers away, a few lanes more than `count`.
    #[inline(always)]
    pub(crate) fn write<V: Lanes<Scalar = f32>>(&self, count: usize, sink: &mut impl Sink<V>) {
        let width = V::WIDTH as f32;
        let near = (width - 1.0) * self.step + T as f32 <= 15.0;
        if self.step == 1.0 {
            self.shifted(count, sink);
        } else if near && (width * self.step).fract() == 0.0 {
            self.alike(count, sink);
        } else {
            for receiver in (0..count).step_by(V::WIDTH) {
                let start = self.fraction + receiver as f32 * self.step;
                let whole = start.floor();
                let (sample, along) = self.places(start - whole);
                let first = self.inside(whole as isize);
                let height: V = match near {
                    true => self.picked(first, sample, along),
                    false => self.picked_apart(first, sample, along),
                };
                sink.put(height, receiver);
            }
        }
    }

    /// Of some registers, each `advance` samples after the one before, those that find all of theirs in the rows and their padding. All
    /// others see the rows' ends alone.
    #[inline(always)]
    fn within(&self, registers: usize, advance: isize) -> std::ops::Range<usize> {
        let before = (-BEYOND - self.first).max(0);
        let until = (self.columns + 2 - self.first).max(0);
        let end = ((until + advance - 1) / advance).min(registers as isize) as usize;
        (((before + advance - 1) / advance) as usize).min(end)..end
    }

    /// The height beyond an end of the rows.
    #[inline(always)]
    fn end(&self, column: usize) -> f32 {
        self.rows.iter().zip(self.shares).map(|(row, share)| self.heights[row + column] * share).sum()
    }

    /// Gives away the height beyond an end of the rows.
    #[inline(always)]
    fn beyond<V: Lanes<Scalar = f32>>(
        &self,
        registers: std::ops::Range<usize>,
        column: usize,
        sink: &mut impl Sink<V>,
    ) {
        if registers.is_empty() {
            return;
        }
        let end = V::splat(self.end(column));
        for register in registers {
            sink.put(end, register * V::WIDTH);
        }
    }

    /// The rows from a register's samples on, for so many samples and a register.
    #[inline(always)]
    fn from(&self, start: isize, samples: usize) -> [&'l [f32]; T] {
        self.rows.map(|row| &self.heights[row.wrapping_add_signed(self.first + start)..][..samples + 16])
    }

    /// Samples lie as far apart as receivers: each one's follow those of the one before.
    #[inline(always)]
    fn shifted<V: Lanes<Scalar = f32>>(&self, count: usize, sink: &mut impl Sink<V>) {
        let registers = count.div_ceil(V::WIDTH);
        let within = self.within(registers, V::WIDTH as isize);
        self.beyond(0..within.start, 0, sink);
        self.beyond(within.end..registers, (self.columns - 1) as usize, sink);
        if within.is_empty() {
            return;
        }
        let along = shares::<V, T>(V::splat(self.fraction));
        let mut weights = [along; T];
        for (weights, across) in weights.iter_mut().zip(&self.shares) {
            for weight in weights {
                *weight = weight.mul(V::splat(*across));
            }
        }
        let start = within.start * V::WIDTH;
        let rows = self.from(start as isize, (within.len() - 1) * V::WIDTH + T - 1);
        for at in (0..within.len() * V::WIDTH).step_by(V::WIDTH) {
            let mut sum = V::constant(0.0);
            for (row, weights) in rows.iter().zip(&weights) {
                for (tap, weight) in weights.iter().enumerate() {
                    sum = load::<V>(row, at + tap).mul_add(*weight, sum);
                }
            }
            sink.put(sum, start + at);
        }
    }

    /// A register's receivers lie among their samples, no more than 16, as those of any other do.
    #[inline(always)]
    fn alike<V: Lanes<Scalar = f32>>(&self, count: usize, sink: &mut impl Sink<V>) {
        let (registers, advance) = (count.div_ceil(V::WIDTH), (V::WIDTH as f32 * self.step) as usize);
        let within = self.within(registers, advance as isize);
        self.beyond(0..within.start, 0, sink);
        self.beyond(within.end..registers, (self.columns - 1) as usize, sink);
        if within.is_empty() {
            return;
        }
        let (sample, along) = self.places::<V>(self.fraction);
        let rows = self.from((within.start * advance) as isize, within.len() * advance);
        for (number, register) in within.enumerate() {
            let mut window = [0.0; 16];
            for lane in (0..16).step_by(V::WIDTH) {
                let at = number * advance;
                let mut blend = V::constant(0.0);
                for (row, share) in rows.iter().zip(&self.shares) {
                    blend = part::<V>(row, at, lane).mul_add(V::splat(*share), blend);
                }
                blend.store(&mut window, lane / V::WIDTH);
            }
            sink.put(pick(&window, sample, along), register * V::WIDTH);
        }
    }

    /// The first sample after some, or one so far outside that heights are what they are there.
    #[inline(always)]
    fn inside(&self, after: isize) -> isize {
        (self.first + after).clamp(-BEYOND, self.columns + 1)
    }

    /// The number of each receiver's first sample after the first one's, and the shares of its samples.
    #[inline(always)]
    fn places<V: Lanes<Scalar = f32>>(&self, fraction: f32) -> (V, [V; T]) {
        let at = V::load(&NUMBERS, 0).mul_add(V::splat(self.step), V::splat(fraction));
        let sample = at.floor();
        (sample, shares(at.sub(sample)))
    }

    /// The samples of all receivers lie within 16.
    #[inline(always)]
    fn picked<V: Lanes<Scalar = f32>>(&self, first: isize, sample: V, along: [V; T]) -> V {
        let mut window = [0.0; 16];
        for lane in (0..16).step_by(V::WIDTH) {
            self.blended::<V>(first, lane).store(&mut window, lane / V::WIDTH);
        }
        pick(&window, sample, along)
    }

    /// The first samples of all receivers lie within 16.
    #[inline(always)]
    fn picked_apart<V: Lanes<Scalar = f32>>(&self, first: isize, sample: V, along: [V; T]) -> V {
        let mut sum = V::constant(0.0);
        for (tap, share) in along.into_iter().enumerate() {
            let mut window = [0.0; 16];
            for lane in (0..16).step_by(V::WIDTH) {
                self.blended::<V>(first, tap + lane).store(&mut window, lane / V::WIDTH);
            }
            sum = sample.select_from(&window).mul_add(share, sum);
        }
        sum
    }

    /// Samples of the rows' blend, from one on.
    #[inline(always)]
    fn blended<V: Lanes<Scalar = f32>>(&self, first: isize, offset: usize) -> V {
        let at = |tap: usize| self.rows[tap].wrapping_add_signed(first) + offset;
        let mut sum = load::<V>(self.heights, at(0)).mul(V::splat(self.shares[0]));
        for tap in 1..T {
            sum = load::<V>(self.heights, at(tap)).mul_add(V::splat(self.shares[tap]), sum);
        }
        sum
    }
}
