//! The horizon of a run of receivers from height differences at growing or shrinking distances.

use halflight_sh_kernels::{Lanes, Simd, Task, run};

use crate::arctangent::arctangent;
use crate::level::{Level, PAD, pad};
use crate::line::{Line, load, store};
use crate::pyramid::Scale;
use crate::runs::{RUN, Run};

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
    lines: Vec<Line<'l, T>>,
    elevations: Box<[f32; RUN + 16]>,
}

impl<'l, const T: usize> Rays<'l, T> {
    pub(crate) fn new(levels: &'l [Level], simd: Simd) -> Self {
        let own = vec![0.0; RUN * levels.len() + 16];
        let nowhere = Run { start: [0.0; 2], first: 0, count: 0 };
        Rays { levels, simd, run: nowhere, own, lines: Vec::new(), elevations: Box::new([0.0; RUN + 16]) }
    }

    /// Goes to receivers; only the levels from `first` on will be asked.
    pub(crate) fn stand(&mut self, at: Run, first: usize) {
        self.run = at;
        let [x, y] = at.start;
        self.lines.clear();
        self.lines.extend(self.levels[first..].iter().map(|level| Line::new(level, x, y)));
        run(self.simd, Stand { lines: &self.lines, count: at.count, own: &mut self.own[first * RUN..] });
    }

    /// Elevations of the receivers' horizon over the steps of an azimuth, within `[0, π/2]`.
    pub(crate) fn look(&mut self, steps: &[Step], scale: Scale) -> &[f32] {
        let [x, y] = self.run.start;
        self.lines.clear();
        self.lines.extend(
            steps.iter().map(|step| Line::new(&self.levels[step.level], x + step.offset[0], y + step.offset[1])),
        );
        let look = Look {
            lines: &self.lines,
            steps,
            own: &self.own,
            count: self.run.count,
            scale,
            out: &mut self.elevations[..],
        };
        run(self.simd, look);
        &self.elevations[..self.run.count]
    }
}

/// The numbers of lanes.
const NUMBERS: [f32; 16] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

struct Stand<'a, 'l, const T: usize> {
    lines: &'a [Line<'l, T>],
    count: usize,
    own: &'a mut [f32],
}

impl<const T: usize> Task<f32> for Stand<'_, '_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let numbers = V::load(&NUMBERS, 0);
        for (level, line) in self.lines.iter().enumerate() {
            for receiver in (0..self.count).step_by(V::WIDTH) {
                store(line.heights(receiver, numbers), self.own, level * RUN + receiver);
            }
        }
    }
}

struct Look<'a, 'l, const T: usize> {
    lines: &'a [Line<'l, T>],
    steps: &'a [Step],
    own: &'a [f32],
    count: usize,
    scale: Scale,
    out: &'a mut [f32],
}

impl<const T: usize> Task<f32> for Look<'_, '_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let (zero, right) = (V::constant(0.0), V::splat(std::f32::consts::FRAC_PI_2));
        for receiver in (0..self.count).step_by(V::WIDTH) {
            let elevation = match self.scale {
                Scale::Linear => arctangent(self.steepest::<V>(receiver)),
                Scale::BSpline => self.smooth::<V>(receiver),
            };
            store(elevation.max(zero).min(right), self.out, receiver);
        }
    }
}

impl<const T: usize> Look<'_, '_, T> {
    /// The multi-scale derivative (eq. 2) of a step.
    #[inline(always)]
    fn tangent<V: Lanes<Scalar = f32>>(&self, index: usize, receiver: usize, numbers: V) -> V {
        let step = &self.steps[index];
        let own = load::<V>(self.own, step.level * RUN + receiver);
        self.lines[index].heights(receiver, numbers).sub(own).mul(V::splat(step.inverse))
    }

    /// The greatest tangent, at least 0: what is linear between knots is greatest at one, and the arctangent is monotonic.
    #[inline(always)]
    fn steepest<V: Lanes<Scalar = f32>>(&self, receiver: usize) -> V {
        let numbers = V::load(&NUMBERS, 0);
        let mut steepest = V::constant(0.0);
        for index in 0..self.steps.len() {
            steepest = self.tangent::<V>(index, receiver, numbers).max(steepest);
        }
        steepest
    }

    /// The greatest value at knots and half knots of the B-spline over the steps' angles (eqs. 3 to 5). At either end of scale
    /// the last angle is repeated once, so that the spline covers all knots.
    #[inline(always)]
    fn smooth<V: Lanes<Scalar = f32>>(&self, receiver: usize) -> V {
        let numbers = V::load(&NUMBERS, 0);
        let first = arctangent(self.tangent::<V>(0, receiver, numbers));
        let mut last = [first, first, first];
        let mut greatest = V::constant(0.0);
        let count = self.steps.len();
        for index in 1..=count {
            let next = match index < count {
                true => arctangent(self.tangent::<V>(index, receiver, numbers)),
                false => last[2],
            };
            let [before, low, high] = last;
            if index > 1 {
                greatest = half_knot(before, low, high, next).max(greatest);
            }
            greatest = knot(low, high, next).max(greatest);
            last = [low, high, next];
        }
        greatest
    }
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

/// All heights of a line, into a row with its padding.
pub(crate) fn sample<const T: usize>(line: Line<'_, T>, simd: Simd, padded: &mut [f32]) {
    run(simd, Sample { line, padded });
}

struct Sample<'a, 'l, const T: usize> {
    line: Line<'l, T>,
    padded: &'a mut [f32],
}

impl<const T: usize> Task<f32> for Sample<'_, '_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let numbers = V::load(&NUMBERS, 0);
        let count = self.padded.len() - 2 * PAD;
        for receiver in (0..count).step_by(V::WIDTH) {
            store(self.line.heights(receiver, numbers), self.padded, PAD + receiver);
        }
        pad(self.padded);
    }
}
