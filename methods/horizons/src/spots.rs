//! Heights of a level below receivers that lie anywhere.

use halflight_sh_kernels::Lanes;

use crate::grid::Lattice;
use crate::level::{Level, NEAR, PAD};
use crate::line::{Sink, load, shares};

/// Gives away a level's heights by `T · T` samples at `count` points in grid coordinates of the field, `offset` from those of `at`. Beyond
/// the border heights are `beyond`, where that is given, or go on as they end there.
#[inline(always)]
pub(crate) fn write<V: Lanes<Scalar = f32>, const T: usize>(
    level: &Level,
    at: &[Vec<f32>; 2],
    offset: [f64; 2],
    count: usize,
    beyond: Option<&[f32]>,
    sink: &mut impl Sink<V>,
) {
    for receiver in (0..count).step_by(V::WIDTH) {
        let x = load::<V>(&at[0], receiver).add(V::splat(offset[0] as f32));
        let y = load::<V>(&at[1], receiver).add(V::splat(offset[1] as f32));
        let mut height =
            gathered::<V, T>(level, split(level, x, 0), split(level, y, 1), V::WIDTH.min(count - receiver));
        if let Some(beyond) = beyond {
            let other = load::<V>(beyond, receiver);
            height = kept(level, x, 0, height, other);
            height = kept(level, y, 1, height, other);
        }
        sink.put(height, receiver);
    }
}

/// The sample before a place along an axis, and how far that is after it.
#[inline(always)]
fn split<V: Lanes<Scalar = f32>>(level: &Level, at: V, axis: usize) -> (V, V) {
    let Lattice { scale, shift, .. } = level.lattice;
    let start = V::constant(0.5 * scale[axis] + shift[axis] - 0.5);
    let sample = at.mul_add(V::constant(scale[axis]), start);
    let sample = sample.max(V::constant(-2.0)).min(V::constant(level.size[axis] as f64 + 1.0));
    let before = sample.floor();
    (before, sample.sub(before))
}

/// `height` at places that lie on the field, else `other`.
#[inline(always)]
fn kept<V: Lanes<Scalar = f32>>(level: &Level, at: V, axis: usize, height: V, other: V) -> V {
    let last = V::constant(level.lattice.last[axis] + NEAR);
    at.where_less(V::constant(-NEAR), other, last.where_less(at, other, height))
}

/// Heights from the samples before each place, and how far that is after them, along x and y.
#[inline(always)]
fn gathered<V: Lanes<Scalar = f32>, const T: usize>(level: &Level, x: (V, V), y: (V, V), lanes: usize) -> V {
    let [mut columns, mut rows] = [[0.0; 16]; 2];
    x.0.store(&mut columns, 0);
    y.0.store(&mut rows, 0);
    let (stride, last) = (level.stride(), level.size[1] as i32 - 1);
    let mut samples = [[[0.0; 16]; T]; T];
    for lane in 0..lanes {
        let before = T as i32 / 2 - 1;
        let column = (columns[lane] as i32 - before + PAD as i32) as usize;
        let row = rows[lane] as i32 - before;
        for (across, samples) in samples.iter_mut().enumerate() {
            let start = (row + across as i32).clamp(0, last) as usize * stride + column;
            for (sample, height) in samples.iter_mut().zip(&level.heights[start..start + T]) {
                sample[lane] = *height;
            }
        }
    }
    let (along, across) = (shares::<V, T>(x.1), shares::<V, T>(y.1));
    let mut sum = V::constant(0.0);
    for (row, across) in samples.iter().zip(&across) {
        let mut blend = V::constant(0.0);
        for (sample, along) in row.iter().zip(&along) {
            blend = V::load(sample, 0).mul_add(*along, blend);
        }
        sum = blend.mul_add(*across, sum);
    }
    sum
}
