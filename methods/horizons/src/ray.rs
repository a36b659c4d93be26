//! The horizon of a run of receivers from height differences at growing or shrinking distances.

use halflight_sh_kernels::{Lanes, Simd, Task, run};

use crate::arctangent::arctangent;
use crate::level::{Level, PAD, pad};
use crate::line::{Line, load, store};
use crate::pyramid::Scale;
use crate::runs::{RUN, Run};

/// A run's entries and those that a register may write beyond.
const ROOM: usize = RUN + 16;

/// A height difference to take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// The number of the level that both heights are of.
    pub(crate) level: usize,
    /// From the receiver, in grid coordinates of the field.
    pub(crate) offset: [f64; 2],
    /// 1 over the distance in metres.
    pub(crate) inverse: f32,
}

/// The steps of an azimuth to distances in metres, each with its level, over a grid of `cell` metres.
pub(crate) fn steps(angle: f32, cell: [f32; 2], distances: impl Iterator<Item = (usize, f64)>) -> Vec<Step> {
    let (sin, cos) = f64::from(angle).sin_cos();
    let [x, y] = [cos / f64::from(cell[0]), sin / f64::from(cell[1])];
    let step = |(level, distance): (usize, f64)| Step {
        level,
        offset: [x * distance, y * distance],
        inverse: (1.0 / distance) as f32,
    };
    distances.map(step).collect()
}

/// Looks along rays over some levels, whose heights are reconstructed from `T · T` samples.
pub(crate) struct Rays<'l, const T: usize> {
    levels: &'l [Level],
    simd: Simd,
    run: Run,
    /// The receivers' heights, [`RUN`] a level.
    own: Vec<f32>,
    /// Tangents of a look, [`RUN`] a step.
    tangents: Vec<f32>,
    elevations: Box<[f32; ROOM]>,
}

impl<'l, const T: usize> Rays<'l, T> {
    pub(crate) fn new(levels: &'l [Level], simd: Simd) -> Self {
        let own = vec![0.0; RUN * levels.len() + 16];
        let nowhere = Run { start: [0.0; 2], first: 0, count: 0 };
        Rays { levels, simd, run: nowhere, own, tangents: Vec::new(), elevations: Box::new([0.0; ROOM]) }
    }

    /// Goes to receivers; only the levels from `first` on will be asked.
    pub(crate) fn stand(&mut self, at: Run, first: usize) {
        self.run = at;
        run(self.simd, Stand::<T> { levels: &self.levels[first..], run: at, own: &mut self.own[first * RUN..] });
    }

    /// The least of the receivers' heights in metres in a level.
    pub(crate) fn lowest(&self, level: usize) -> f32 {
        self.own[level * RUN..][..self.run.count].iter().copied().fold(f32::MAX, f32::min)
    }

    /// Elevations of the receivers' horizon over the steps of an azimuth, within `[0, π/2]`.
    pub(crate) fn look(&mut self, steps: &[Step], scale: Scale) -> &[f32] {
        self.tangents.resize(steps.len() * RUN + 16, 0.0);
        let look = Look::<T> {
            levels: self.levels,
            run: self.run,
            steps,
            own: &self.own,
            scale,
            tangents: &mut self.tangents,
            out: &mut self.elevations,
        };
        run(self.simd, look);
        &self.elevations[..self.run.count]
    }
}

struct Stand<'a, const T: usize> {
    levels: &'a [Level],
    run: Run,
    own: &'a mut [f32],
}

impl<const T: usize> Task<f32> for Stand<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let [x, y] = self.run.start;
        for (number, level) in self.levels.iter().enumerate() {
            Line::<T>::new(level, x, y).write::<V>(self.run.count, &[0.0; ROOM], 1.0, &mut self.own[number * RUN..]);
        }
    }
}

struct Look<'a, const T: usize> {
    levels: &'a [Level],
    run: Run,
    steps: &'a [Step],
    own: &'a [f32],
    scale: Scale,
    tangents: &'a mut [f32],
    out: &'a mut [f32; ROOM],
}

impl<const T: usize> Task<f32> for Look<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let [x, y] = self.run.start;
        let count = self.run.count;
        for (number, step) in self.steps.iter().enumerate() {
            let line = Line::<T>::new(&self.levels[step.level], x + step.offset[0], y + step.offset[1]);
            line.write::<V>(count, &self.own[step.level * RUN..], step.inverse, &mut self.tangents[number * RUN..]);
        }
        let (zero, right) = (V::constant(0.0), V::splat(std::f32::consts::FRAC_PI_2));
        for receiver in (0..count).step_by(V::WIDTH) {
            let elevation = match self.scale {
                Scale::Linear => arctangent(steepest::<V>(self.tangents, self.steps.len(), receiver)),
                Scale::BSpline => smooth::<V>(self.tangents, self.steps.len(), receiver),
            };
            store(elevation.max(zero).min(right), self.out, receiver);
        }
    }
}

/// The greatest tangent, at least 0: what is linear between knots is greatest at one, and the arctangent is monotonic.
#[inline(always)]
fn steepest<V: Lanes<Scalar = f32>>(tangents: &[f32], steps: usize, receiver: usize) -> V {
    let mut steepest = V::constant(0.0);
    for step in 0..steps {
        steepest = load::<V>(tangents, step * RUN + receiver).max(steepest);
    }
    steepest
}

/// The greatest value at knots and half knots of the B-spline over the steps' angles (eqs. 3 to 5). At either end of scale
/// the last angle is repeated once, so that the spline covers all knots.
#[inline(always)]
fn smooth<V: Lanes<Scalar = f32>>(tangents: &[f32], steps: usize, receiver: usize) -> V {
    let first = arctangent(load::<V>(tangents, receiver));
    let (mut before, mut low, mut high) = (first, first, first);
    let mut greatest = V::constant(0.0);
    for step in 1..steps {
        let next = arctangent(load::<V>(tangents, step * RUN + receiver));
        if step > 1 {
            greatest = half_knot(before, low, high, next).max(greatest);
        }
        greatest = knot(low, high, next).max(greatest);
        (before, low, high) = (low, high, next);
    }
    if steps > 1 {
        greatest = half_knot(before, low, high, high).max(greatest);
    }
    knot(low, high, high).max(greatest)
}

/// The B-spline at the middle one of three.
#[inline(always)]
fn knot<V: Lanes<Scalar = f32>>(before: V, at: V, after: V) -> V {
    before.add(after).mul_add(V::constant(1.0 / 6.0), at.mul(V::constant(2.0 / 3.0)))
}

/// The B-spline between the inner ones of four.
#[inline(always)]
fn half_knot<V: Lanes<Scalar = f32>>(before: V, low: V, high: V, after: V) -> V {
    before.add(after).mul_add(V::constant(1.0 / 48.0), low.add(high).mul(V::constant(23.0 / 48.0)))
}

/// Where a level's samples lie, see [`Level`].
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) scale: [f64; 2],
    pub(crate) shift: [f64; 2],
}

/// A padded row of `to`: a level at its samples' centres in row `row`.
pub(crate) fn sample<const T: usize>(from: &Level, to: &Grid, row: usize, simd: Simd, padded: &mut [f32]) {
    run(simd, Sample::<T> { from, to, row, padded });
}

struct Sample<'a, const T: usize> {
    from: &'a Level,
    to: &'a Grid,
    row: usize,
    padded: &'a mut [f32],
}

impl<const T: usize> Task<f32> for Sample<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        // The level as one of the other grid, whose samples stand for vertices.
        let scale = [0, 1].map(|axis| self.from.scale[axis] / self.to.scale[axis]);
        let y = self.row as f64 - self.to.shift[1];
        let count = self.padded.len() - 2 * PAD;
        for first in (0..count).step_by(RUN) {
            let line = Line::<T>::seen(self.from, scale, first as f64 - self.to.shift[0], y);
            line.write::<V>(RUN.min(count - first), &[0.0; ROOM], 1.0, &mut self.padded[PAD + first..]);
        }
        pad(self.padded);
    }
}
