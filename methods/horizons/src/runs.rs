//! Receivers in runs along rows of the grid, and those that lie anywhere.

use crate::Points;

/// Receivers that one run holds at most.
pub(crate) const RUN: usize = 256;

/// Receivers that a run has at least for it to be quicker than one by one.
const SHORTEST: usize = 8;

/// Entries for a run's receivers, and for those that a register may hold beyond.
pub(crate) const ROOM: usize = RUN + 16;

/// Receivers a vertex apart on a row: `start`, then `start` plus 1, and so on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Run {
    /// Grid coordinates of the first.
    pub(crate) start: [f64; 2],
    /// Its number among the points.
    pub(crate) first: usize,
    /// How many there are, at most [`RUN`].
    pub(crate) count: usize,
}

/// Receivers that are looked from together, at most [`RUN`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// The number of the first among the points.
    pub(crate) first: usize,
    pub(crate) count: usize,
    pub(crate) place: Place,
}

/// Where a group's receivers are, in grid coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Place {
    /// A vertex apart on a row, from here on.
    Row([f64; 2]),
    /// Anywhere: [`ROOM`] coordinates along x and as many along y.
    Spots([Vec<f32>; 2]),
}

/// Points of a field, and its columns and rows.
#[derive(Clone, Copy)]
struct Receivers<'p> {
    at: Points<'p>,
    size: [usize; 2],
}

impl Receivers<'_> {
    fn inside(&self, at: f32, axis: usize) -> f32 {
        at.max(0.0).min((self.size[axis] - 1) as f32)
    }

    fn place(&self, point: usize) -> [f64; 2] {
        [self.inside(self.at.x[point], 0), self.inside(self.at.y[point], 1)].map(f64::from)
    }

    /// The run that a point begins.
    fn run(&self, first: usize) -> Run {
        let start = self.place(first);
        let follows = |count: &usize| self.place(first + count) == [start[0] + *count as f64, start[1]];
        let count = 1 + (1..RUN.min(self.at.len() - first)).take_while(follows).count();
        Run { start, first, count }
    }

    /// The points from one on up to the next that begins a run worth the name.
    fn spots(&self, first: usize) -> Group {
        let scattered = |point: &usize| self.run(*point).count < SHORTEST;
        let count = 1 + (first + 1..self.at.len().min(first + RUN)).take_while(scattered).count();
        let along = |axis: usize, from: &[f32]| {
            let mut to: Vec<f32> = from[first..][..count].iter().map(|at| self.inside(*at, axis)).collect();
            to.resize(ROOM, 0.0);
            to
        };
        Group { first, count, place: Place::Spots([along(0, self.at.x), along(1, self.at.y)]) }
    }

    fn group(&self, first: usize) -> Group {
        let Run { start, count, .. } = self.run(first);
        if count < SHORTEST { self.spots(first) } else { Group { first, count, place: Place::Row(start) } }
    }
}

impl<'p> Receivers<'p> {
    fn new(at: Points<'p>, size: [usize; 2]) -> Self {
        assert_eq!(at.x.len(), at.y.len(), "as many x as y");
        Receivers { at, size }
    }
}

/// Cuts points of a field of `[columns, rows]` into runs.
pub(crate) fn runs(at: Points<'_>, size: [usize; 2]) -> impl Iterator<Item = Run> {
    let receivers = Receivers::new(at, size);
    let mut first = 0;
    std::iter::from_fn(move || {
        let run = (first < at.len()).then(|| receivers.run(first))?;
        first += run.count;
        Some(run)
    })
}

/// Cuts points of a field of `[columns, rows]` into groups.
pub(crate) fn groups(at: Points<'_>, size: [usize; 2]) -> impl Iterator<Item = Group> {
    let receivers = Receivers::new(at, size);
    let mut first = 0;
    std::iter::from_fn(move || {
        let group = (first < at.len()).then(|| receivers.group(first))?;
        first += group.count;
        Some(group)
    })
}
