//! Receivers in runs along rows of the grid.

use crate::Points;

/// Receivers that one run holds at most.
pub(crate) const RUN: usize = 128;

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

/// Cuts points of a field of `[columns, rows]` into runs.
pub(crate) fn runs(at: Points<'_>, size: [usize; 2]) -> impl Iterator<Item = Run> {
    assert_eq!(at.x.len(), at.y.len(), "as many x as y");
    let inside = move |at: f32, axis: usize| f64::from(at).max(0.0).min((size[axis] - 1) as f64);
    let place = move |point: usize| [inside(at.x[point], 0), inside(at.y[point], 1)];
    let mut first = 0;
    std::iter::from_fn(move || {
        if first == at.len() {
            return None;
        }
        let start = place(first);
        let follows = |count: &usize| place(first + count) == [start[0] + *count as f64, start[1]];
        let count = 1 + (1..RUN.min(at.len() - first)).take_while(follows).count();
        let run = Run { start, first, count };
        first += count;
        Some(run)
    })
}
