//! The horizon of a run of receivers from height differences at growing or shrinking distances.

use std::ops::Range;

use halflight_sh_kernels::{Lanes, Simd, Task, run};

use crate::arctangent::arctangent;
use crate::grid::Lattice;
use crate::level::{Level, PAD, pad};
use crate::line::{Heights, Line, Sink, Slopes, Steepest, load, store};
use crate::pyramid::Scale;
use crate::runs::{Group, Place, ROOM, RUN};
use crate::spots;

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

/// What lies beyond a field's border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// The border's heights, drawn out.
    #[default]
    Extend,
    /// Nothing: a height difference with a point out there counts as level.
    Open,
}

/// Looks along rays over some levels, whose heights are reconstructed from `T · T` samples.
pub(crate) struct Rays<'l, const T: usize> {
    levels: &'l [Level],
    simd: Simd,
    border: Border,
    group: Group,
    /// The receivers' heights, [`RUN`] a level.
    own: Vec<f32>,
    /// Tangents of a look, [`RUN`] a step.
    tangents: Vec<f32>,
    elevations: Box<[f32; ROOM]>,
}

impl<'l, const T: usize> Rays<'l, T> {
    pub(crate) fn new(levels: &'l [Level], border: Border, simd: Simd) -> Self {
        let own = vec![0.0; RUN * levels.len() + 16];
        let group = Group { first: 0, count: 0, place: Place::Row([0.0; 2]) };
        Rays { levels, simd, border, group, own, tangents: Vec::new(), elevations: Box::new([0.0; ROOM]) }
    }

    /// Goes to receivers; only the levels from `first` on will be asked.
    pub(crate) fn stand(&mut self, group: Group, first: usize) {
        self.group = group;
        let (levels, own) = (&self.levels[first..], &mut self.own[first * RUN..]);
        run(self.simd, Stand::<T> { levels, group: &self.group, own });
    }

    /// The least of the receivers' heights in metres in a level.
    pub(crate) fn lowest(&self, level: usize) -> f32 {
        self.own[level * RUN..][..self.group.count].iter().copied().fold(f32::MAX, f32::min)
    }

    /// Elevations of the receivers' horizon over the steps of an azimuth, within `[0, π/2]`.
    pub(crate) fn look(&mut self, steps: &[Step], scale: Scale) -> &[f32] {
        let rows = match scale {
            Scale::Linear => 1,
            Scale::BSpline => steps.len(),
        };
        self.tangents.resize(self.tangents.len().max(rows * RUN + 16), 0.0);
        let look = Look::<T> {
            levels: self.levels,
            border: self.border,
            group: &self.group,
            steps,
            own: &self.own,
            scale,
            tangents: &mut self.tangents,
            out: &mut self.elevations,
        };
        run(self.simd, look);
        &self.elevations[..self.group.count]
    }
}

struct Stand<'a, const T: usize> {
    levels: &'a [Level],
    group: &'a Group,
    own: &'a mut [f32],
}

impl<const T: usize> Task<f32> for Stand<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let count = self.group.count;
        for (number, level) in self.levels.iter().enumerate() {
            let mut own = Heights(&mut self.own[number * RUN..]);
            match &self.group.place {
                Place::Row([x, y]) => Line::<T>::new(level, *x, *y).write::<V>(count, &mut own),
                Place::Spots(at) => spots::write::<V, T>(level, at, [0.0; 2], count, None, &mut own),
            }
        }
    }
}

struct Look<'a, const T: usize> {
    levels: &'a [Level],
    border: Border,
    group: &'a Group,
    steps: &'a [Step],
    own: &'a [f32],
    scale: Scale,
    /// Those of all steps; or the steepest.
    tangents: &'a mut [f32],
    out: &'a mut [f32; ROOM],
}

impl<const T: usize> Task<f32> for Look<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(mut self) {
        let count = self.group.count;
        match self.scale {
            Scale::Linear => {
                self.tangents[..RUN + 16].fill(0.0);
                for step in self.steps {
                    self.raise::<V>(step);
                }
            }
            Scale::BSpline => {
                for (number, step) in self.steps.iter().enumerate() {
                    self.slopes::<V>(step, number);
                }
            }
        }
        let (zero, right) = (V::constant(0.0), V::splat(std::f32::consts::FRAC_PI_2));
        for receiver in (0..count).step_by(V::WIDTH) {
            let elevation = match self.scale {
                Scale::Linear => arctangent(load::<V>(self.tangents, receiver)),
                Scale::BSpline => smooth::<V>(self.tangents, self.steps.len(), receiver),
            };
            store(elevation.max(zero).min(right), self.out, receiver);
        }
    }
}

impl<const T: usize> Look<'_, T> {
    /// Raises the steepest tangents to those of a step: what is linear between knots is greatest at one, and the arctangent is monotonic.
    #[inline(always)]
    fn raise<V: Lanes<Scalar = f32>>(&mut self, step: &Step) {
        let seen = self.seen(step);
        let mut after = [0.0; 16];
        after.copy_from_slice(&self.tangents[seen.end..][..16]);
        let (own, out) = (&self.own[step.level * RUN + seen.start..], &mut self.tangents[seen.start..]);
        let mut steepest = Steepest(Slopes { own, inverse: step.inverse, out });
        reach::<V, T>(self.levels, self.border, self.group, step, seen.clone(), own, &mut steepest);
        // The last register's receivers that do not see it.
        self.tangents[seen.end..][..16].copy_from_slice(&after);
    }

    /// Writes the tangents of a step, 0 where it leads beyond an open border.
    #[inline(always)]
    fn slopes<V: Lanes<Scalar = f32>>(&mut self, step: &Step, row: usize) {
        let seen = self.seen(step);
        let (own, out) = (&self.own[step.level * RUN + seen.start..], &mut self.tangents[row * RUN + seen.start..]);
        let mut slopes = Slopes { own, inverse: step.inverse, out };
        reach::<V, T>(self.levels, self.border, self.group, step, seen.clone(), own, &mut slopes);
        let tangents = &mut self.tangents[row * RUN..][..self.group.count];
        tangents[..seen.start].fill(0.0);
        tangents[seen.end..].fill(0.0);
    }

    /// The receivers from which a step leads to what can be seen, where that is told by their row.
    #[inline(always)]
    fn seen(&self, step: &Step) -> Range<usize> {
        match (self.border, &self.group.place) {
            (Border::Open, Place::Row([x, y])) => {
                self.levels[step.level].inside(x + step.offset[0], y + step.offset[1], self.group.count)
            }
            _ => 0..self.group.count,
        }
    }
}

/// Gives away the heights that a step leads to from some of the receivers, whose own heights are `own`.
#[inline(always)]
fn reach<V: Lanes<Scalar = f32>, const T: usize>(
    levels: &[Level],
    border: Border,
    group: &Group,
    step: &Step,
    seen: Range<usize>,
    own: &[f32],
    sink: &mut impl Sink<V>,
) {
    let level = &levels[step.level];
    match &group.place {
        Place::Row(_) if seen.is_empty() => {}
        Place::Row([x, y]) => {
            let x = x + seen.start as f64 + step.offset[0];
            Line::<T>::new(level, x, y + step.offset[1]).write::<V>(seen.len(), sink);
        }
        Place::Spots(at) => {
            // As high as the receiver: level.
            let beyond = if border == Border::Open { Some(own) } else { None };
            spots::write::<V, T>(level, at, step.offset, group.count, beyond, sink);
        }
    }
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

/// A padded row of `to`: a level at its samples' centres in row `row`.
pub(crate) fn sample<const T: usize>(from: &Level, to: &Lattice, row: usize, simd: Simd, padded: &mut [f32]) {
    run(simd, Sample::<T> { from, to, row, padded });
}

struct Sample<'a, const T: usize> {
    from: &'a Level,
    to: &'a Lattice,
    row: usize,
    padded: &'a mut [f32],
}

impl<const T: usize> Task<f32> for Sample<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        // The level as one of the other grid, whose samples stand for vertices.
        let scale = [0, 1].map(|axis| self.from.lattice.scale[axis] / self.to.scale[axis]);
        let y = self.row as f64 - self.to.shift[1];
        let count = self.padded.len() - 2 * PAD;
        for first in (0..count).step_by(RUN) {
            let line = Line::<T>::seen(self.from, scale, first as f64 - self.to.shift[0], y);
            line.write::<V>(RUN.min(count - first), &mut Heights(&mut self.padded[PAD + first..]));
        }
        pad(self.padded);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `smooth` of some angles, as every receiver of a register sees it.
    struct Smooth<'a>(&'a [f64], &'a mut f32);

    impl Task<f32> for Smooth<'_> {
        #[inline(always)]
        fn run<V: Lanes<Scalar = f32>>(self) {
            let mut tangents = vec![0.0; self.0.len() * RUN + 16];
            for (step, angle) in self.0.iter().enumerate() {
                tangents[step * RUN..][..16].fill(angle.tan() as f32);
            }
            *self.1 = smooth::<V>(&tangents, self.0.len(), 0).first();
        }
    }

    /// The cubic B-spline over angles of which the last at either end is repeated (eq. 4), by its basis functions.
    fn spline(angles: &[f64], at: f64) -> f64 {
        let angle = |i: i64| angles[i.clamp(0, angles.len() as i64 - 1) as usize];
        let u = at.fract();
        let basis = [
            (1.0 - u).powi(3) / 6.0,
            (3.0 * u.powi(3) - 6.0 * u * u + 4.0) / 6.0,
            (-3.0 * u.powi(3) + 3.0 * u * u + 3.0 * u + 1.0) / 6.0,
            u.powi(3) / 6.0,
        ];
        (-1..=2).zip(basis).map(|(i, share)| share * angle(at as i64 + i)).sum()
    }

    #[test]
    fn the_spline_is_sought_at_knots_and_between() {
        let lists: [&[f64]; 7] = [
            &[0.3],
            &[0.2, 0.9],
            &[1.1, -0.4],
            &[-0.2, 0.8, 0.8, -0.1],
            &[0.1, 0.2, 1.2, 0.1, -0.5],
            &[-0.3, -0.2, -0.9, -1.0],
            &[0.0, 0.4, 0.7, 0.75, 0.72, 0.1, 0.9],
        ];
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            let mut between = 0;
            for angles in lists {
                let halves = 0..=2 * (angles.len() - 1);
                let at = |half: &usize| spline(angles, *half as f64 / 2.0);
                let expected = halves.clone().map(|half| at(&half)).fold(0.0, f64::max);
                between += usize::from(halves.step_by(2).map(|half| at(&half)).fold(0.0, f64::max) < expected);
                let mut found = 0.0;
                run(simd, Smooth(angles, &mut found));
                assert!((f64::from(found) - expected).abs() < 1e-6, "{simd:?}, {angles:?}: {found} for {expected}");
            }
            assert!(between > 0, "none is greatest between knots");
        }
    }
}
