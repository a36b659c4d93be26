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

/// A level along receivers that lie a vertex apart on a row of the field, reconstructed from `T · T` samples. Beyond its border it
/// goes on as it ends there.
pub(crate) struct Line<'l, const T: usize> {
    heights: &'l [f32],
    /// Where the rows begin, their padding left out.
    rows: [usize; T],
    shares: [f32; T],
    /// Position of the first receiver in samples.
    start: f64,
    /// Samples from a receiver to the next.
    step: f64,
    last: f64,
    /// Shares of samples along the row, where the step is 1 and all receivers share them.
    along: [f32; T],
}

impl<'l, const T: usize> Line<'l, T> {
    const BEFORE: usize = T / 2 - 1;

    /// From a point in grid coordinates of the field on, which may lie outside.
    pub(crate) fn new(level: &'l Level, x: f64, y: f64) -> Self {
        let [start, across] = [(x, 0), (y, 1)].map(|(at, axis)| (at + 0.5) * level.scale[axis] - 0.5);
        let rows = level.size[1] as f64;
        let across = across.clamp(-2.0, rows + 1.0);
        let first = across.floor() as i64 - Self::BEFORE as i64;
        let row = |tap: usize| (first + tap as i64).clamp(0, level.size[1] as i64 - 1) as usize * level.stride() + PAD;
        Line {
            heights: &level.heights,
            rows: std::array::from_fn(row),
            shares: shares((across - across.floor()) as f32),
            start,
            step: level.scale[0],
            last: level.size[0] as f64,
            along: shares((start - start.floor()) as f32),
        }
    }

    /// Heights of the receivers from a number on.
    #[inline(always)]
    pub(crate) fn heights<V: Lanes<Scalar = f32>>(&self, receiver: usize, numbers: V) -> V {
        // Farther out all is constant, so that this moves nothing that differs.
        let from = (self.start + receiver as f64 * self.step).clamp(-BEYOND, self.last + 1.0);
        let whole = from.floor();
        let first = (whole as i64 - Self::BEFORE as i64) as isize;
        if self.step == 1.0 {
            return self.shifted(first);
        }
        let at = numbers.mul_add(V::splat(self.step as f32), V::splat((from - whole) as f32));
        let sample = at.floor();
        let shares = shares::<V, T>(at.sub(sample));
        if (V::WIDTH - 1) as f64 * self.step + T as f64 <= 15.0 {
            self.picked(first, sample, shares)
        } else {
            self.picked_apart(first, sample, shares)
        }
    }

    /// Each receiver's samples follow those of the one before.
    #[inline(always)]
    fn shifted<V: Lanes<Scalar = f32>>(&self, first: isize) -> V {
        let mut sum = V::constant(0.0);
        for tap in 0..T {
            sum = self.blended::<V>(first, tap).mul_add(V::splat(self.along[tap]), sum);
        }
        sum
    }

    /// The samples of all receivers lie within 16.
    #[inline(always)]
    fn picked<V: Lanes<Scalar = f32>>(&self, first: isize, sample: V, shares: [V; T]) -> V {
        let mut window = [0.0; 16];
        for lane in (0..16).step_by(V::WIDTH) {
            self.blended::<V>(first, lane).store(&mut window, lane / V::WIDTH);
        }
        let mut sum = V::constant(0.0);
        for (tap, share) in shares.into_iter().enumerate() {
            sum = sample.add(V::constant(tap as f64)).select_from(&window).mul_add(share, sum);
        }
        sum
    }

    /// The first samples of all receivers lie within 16.
    #[inline(always)]
    fn picked_apart<V: Lanes<Scalar = f32>>(&self, first: isize, sample: V, shares: [V; T]) -> V {
        let mut sum = V::constant(0.0);
        for (tap, share) in shares.into_iter().enumerate() {
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
        let mut sum = V::constant(0.0);
        for tap in 0..T {
            let at = self.rows[tap].wrapping_add_signed(first) + offset;
            sum = load::<V>(self.heights, at).mul_add(V::splat(self.shares[tap]), sum);
        }
        sum
    }
}
