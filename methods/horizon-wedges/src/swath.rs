//! Azimuthal swaths: which directions are looked at, and which wedges lie between them.

use std::f64::consts::TAU;

use halflight_sh::{Block, LANES, index};

use crate::table::rows;

/// Equally spaced azimuths, all around or across a part (Snyder and Nowrouzezahrai 2008, §4). Each stands in the middle of its share: over
/// a partial swath of extent `ΔΦ` the first lies half a step from the swath's start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Swath {
    /// Radians.
    pub(crate) first: f64,
    /// Radians from one azimuth to the next.
    pub(crate) step: f64,
    pub(crate) count: usize,
    pub(crate) complete: bool,
}

/// A wedge of a swath.
pub(crate) struct Wedge {
    /// Number of the azimuth at its start.
    pub(crate) start: usize,
    /// Number of the azimuth at its end; none for a boundary.
    pub(crate) end: Option<usize>,
    /// `cos mφ` and `sin mφ` for each coefficient, φ the azimuth of its origin; those with `m < 0` negated where the wedge is the mirror
    /// image of what is tabulated.
    pub(crate) turn: [Vec<Block<f32>>; 2],
}

impl Swath {
    /// All around, from azimuth 0 on.
    pub(crate) fn complete(count: usize) -> Swath {
        Swath { first: 0.0, step: TAU / count as f64, count, complete: true }
    }

    /// An extent, in radians, about an azimuth.
    pub(crate) fn partial(middle: f64, extent: f64, count: usize) -> Swath {
        let step = extent / count as f64;
        Swath { first: middle - 0.5 * (extent - step), step, count, complete: false }
    }

    /// Its azimuths in radians.
    pub(crate) fn azimuths(&self) -> impl Iterator<Item = f32> {
        let Swath { first, step, count, .. } = *self;
        (0..count).map(move |i| (first + i as f64 * step) as f32)
    }

    /// Its wedges for an SH order.
    pub(crate) fn wedges(&self, order: usize) -> Vec<Wedge> {
        let turn = |at: usize, mirrored| turn(order, self.first + at as f64 * self.step, mirrored);
        let interior = |start: usize, end| Wedge { start, end: Some(end), turn: turn(start, false) };
        if self.complete {
            return (0..self.count).map(|start| interior(start, (start + 1) % self.count)).collect();
        }
        let last = self.count - 1;
        let boundary = |at, mirrored| Wedge { start: at, end: None, turn: turn(at, mirrored) };
        let between = (0..last).map(|start| interior(start, start + 1));
        between.chain([boundary(0, true), boundary(last, false)]).collect()
    }
}

fn turn(order: usize, azimuth: f64, mirrored: bool) -> [Vec<Block<f32>>; 2] {
    let mut turn = [0, 1].map(|_| vec![Block::ZERO; rows(order)]);
    for (l, m) in (0..order as isize).flat_map(|l| (-l..=l).map(move |m| (l, m))) {
        let i = index(l as usize, m);
        let sign = if mirrored && m < 0 { -1.0 } else { 1.0 };
        let (sin, cos) = (m.abs() as f64 * azimuth).sin_cos();
        [cos, sin].iter().zip(&mut turn).for_each(|(value, part)| part[i / LANES].0[i % LANES] = (sign * value) as f32);
    }
    turn
}
