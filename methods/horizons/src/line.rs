//! A level's heights along a row of receivers, with its bilinear or bicubic B-spline reconstruction.

use halflight_sh_kernels::Lanes;

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
        let inner = |t: V| t.mul(t).mul(t.mul_add(V::constant(0.5), V::constant(-1.0))).add(V::constant(2.0 / 3.0));
        let outer = |t: V| t.mul(t).mul(t).mul(V::constant(1.0 / 6.0));
        shares[0] = outer(u);
        shares[1] = inner(t);
        shares[2] = inner(u);
        shares[3] = outer(t);
    }
    shares
}

/// The numbers of lanes.
const NUMBERS: [f32; 16] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

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
        let [x, y] = [(x, 0), (y, 1)].map(|(at, axis)| at + level.shift[axis] / level.scale[axis]);
        Self::seen(level, level.scale, x, y)
    }

    /// From a point in coordinates of a grid with `scale` samples of the level in the length of one of its own.
    #[inline(always)]
    pub(crate) fn seen(level: &'l Level, scale: [f64; 2], x: f64, y: f64) -> Self {
        let along = (x + 0.5) * scale[0] - 0.5;
        let across = (y + 0.5) * scale[1] - 0.5;
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

    /// Writes `times` the height less `minus` for some receivers, a few lanes more than `count`.
    #[inline(always)]
    pub(crate) fn write<V: Lanes<Scalar = f32>>(&self, count: usize, minus: &[f32], times: f32, out: &mut [f32]) {
        let width = V::WIDTH as f32;
        let near = (width - 1.0) * self.step + T as f32 <= 15.0;
        if self.step == 1.0 {
            let along = shares::<V, T>(V::splat(self.fraction));
            for receiver in (0..count).step_by(V::WIDTH) {
                let height: V = self.shifted(self.inside(receiver as isize), along);
                store(height.sub(load(minus, receiver)).mul(V::splat(times)), out, receiver);
            }
        } else if near && (width * self.step).fract() == 0.0 {
            // Every register's receivers lie among their samples as the first's do.
            let (sample, along) = self.among(self.fraction);
            for receiver in (0..count).step_by(V::WIDTH) {
                let first = self.inside((receiver as f32 * self.step) as isize);
                let height: V = self.picked(first, sample, along);
                store(height.sub(load(minus, receiver)).mul(V::splat(times)), out, receiver);
            }
        } else {
            for receiver in (0..count).step_by(V::WIDTH) {
                let start = self.fraction + receiver as f32 * self.step;
                let whole = start.floor();
                let (sample, along) = self.among(start - whole);
                let first = self.inside(whole as isize);
                let height: V = match near {
                    true => self.picked(first, sample, along),
                    false => self.picked_apart(first, sample, along),
                };
                store(height.sub(load(minus, receiver)).mul(V::splat(times)), out, receiver);
            }
        }
    }

    /// The first sample after some, or one so far outside that heights are what they are there.
    #[inline(always)]
    fn inside(&self, after: isize) -> isize {
        (self.first + after).clamp(-BEYOND, self.columns + 1)
    }

    /// The number of each receiver's first sample after the first one's, and the shares of its samples.
    #[inline(always)]
    fn among<V: Lanes<Scalar = f32>>(&self, fraction: f32) -> (V, [V; T]) {
        let at = V::load(&NUMBERS, 0).mul_add(V::splat(self.step), V::splat(fraction));
        let sample = at.floor();
        (sample, shares(at.sub(sample)))
    }

    /// Each receiver's samples follow those of the one before.
    #[inline(always)]
    fn shifted<V: Lanes<Scalar = f32>>(&self, first: isize, along: [V; T]) -> V {
        let mut sum = self.blended::<V>(first, 0).mul(along[0]);
        for (tap, share) in along.into_iter().enumerate().skip(1) {
            sum = self.blended::<V>(first, tap).mul_add(share, sum);
        }
        sum
    }

    /// The samples of all receivers lie within 16.
    #[inline(always)]
    fn picked<V: Lanes<Scalar = f32>>(&self, first: isize, sample: V, along: [V; T]) -> V {
        let mut window = [0.0; 16];
        for lane in (0..16).step_by(V::WIDTH) {
            self.blended::<V>(first, lane).store(&mut window, lane / V::WIDTH);
        }
        let mut sum = V::constant(0.0);
        for (tap, share) in along.into_iter().enumerate() {
            sum = sample.add(V::constant(tap as f64)).select_from(&window).mul_add(share, sum);
        }
        sum
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
