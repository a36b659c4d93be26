//! Upper convex hulls along parallel lines.

use std::ops::Range;

use halflight_sh_kernels::{Lanes, Simd, Task, run};

use crate::arctangent::arctangent;

/// Lines that are swept together, so that heights move between layouts by whole cache lines.
const GROUP: usize = 16;

/// Parallel lines over a grid. "Along" is the axis that the azimuth is nearer to in grid coordinates, "across" the other: line
/// `l` passes `i` along at `l + (i − middle) · slope` across, so that turning the field turns the lines.
pub(crate) struct Lines {
    /// Vertices along and across.
    size: [usize; 2],
    slope: f64,
    /// 1 over the metres along a line from one crossing to the next, negative where the azimuth looks back along the axis.
    inverse: f64,
    /// The first line.
    first: i64,
    /// How many lines there are.
    count: usize,
}

impl Lines {
    /// Lines over `[along, across]` vertices in a direction that advances that much in grid coordinates in a metre.
    pub(crate) fn new(size: [usize; 2], [along, across]: [f64; 2]) -> Self {
        let slope = across / along;
        let reach = slope.abs() * 0.5 * (size[0] - 1) as f64;
        let first = (-reach).floor() as i64;
        let last = (reach + (size[1] - 1) as f64).floor() as i64 + 1;
        Lines { size, slope, inverse: along, first, count: (last - first + 1) as usize }
    }

    /// How far lines have come across where they are at `i` along.
    fn shift(&self, i: usize) -> f64 {
        (i as f64 - 0.5 * (self.size[0] - 1) as f64) * self.slope
    }

    /// Elevations at all vertices. What is next to each other across is so in memory, of the heights and of the result.
    pub(crate) fn horizons(&self, heights: &[f32], simd: Simd) -> Vec<f32> {
        let [along, across] = self.size;
        let stride = self.count.next_multiple_of(GROUP);
        let mut swept = vec![0.0; along * stride];
        let mut lines = vec![0.0; along * GROUP];
        let mut hull = vec![(0.0, 0.0); along];
        for group in (0..self.count).step_by(GROUP) {
            self.sample(heights, group, &mut lines);
            for (line, samples) in lines.chunks_exact_mut(along).enumerate() {
                let within = self.within(self.first + (group + line) as i64);
                samples[..within.start].fill(0.0);
                samples[within.end..].fill(0.0);
                sweep(&mut samples[within], self.inverse as f32, &mut hull);
            }
            run(simd, Elevations(&mut lines));
            for (i, swept) in swept.chunks_exact_mut(stride).enumerate() {
                for (line, swept) in swept[group..group + GROUP].iter_mut().enumerate() {
                    *swept = lines[line * along + i];
                }
            }
        }
        let mut map = vec![0.0; along * across];
        for (i, (swept, map)) in swept.chunks_exact(stride).zip(map.chunks_exact_mut(across)).enumerate() {
            // A vertex lies between two lines and takes a mean of theirs.
            let shift = -self.shift(i);
            let share = (shift - shift.floor()) as f32;
            let swept = &swept[(shift.floor() as i64 - self.first) as usize..];
            for ((map, low), high) in map.iter_mut().zip(swept).zip(&swept[1..]) {
                *map = low * (1.0 - share) + high * share;
            }
        }
        map
    }

    /// Where a line crosses the field. On its way in it counts from a cell before the border on, with the border drawn out, as
    /// vertices there take a mean with it; on its way out it ends at the border, beyond which nothing is seen.
    fn within(&self, line: i64) -> Range<usize> {
        /// In cells: what rounding takes off the border is on it.
        const NEAR: f64 = 1e-9;
        let [along, across] = self.size.map(|count| count as f64);
        let (start, slope) = (line as f64 + self.shift(0), self.slope);
        let climb = slope * self.inverse;
        let bottom = if climb > 0.0 { -1.0 } else { -NEAR };
        let top = if climb < 0.0 { across } else { across - 1.0 + NEAR };
        if slope.abs() * along < NEAR {
            return if start > bottom && start < top { 0..self.size[0] } else { 0..0 };
        }
        let ends = [(bottom - start) / slope, (top - start) / slope];
        let low = (ends[0].min(ends[1]).floor() + 1.0).clamp(0.0, along);
        let high = ends[0].max(ends[1]).ceil().clamp(low, along);
        low as usize..high as usize
    }

    /// Heights where a group of lines crosses, line by line; the field's border is drawn out.
    fn sample(&self, heights: &[f32], group: usize, lines: &mut [f32]) {
        let [along, across] = self.size;
        let last = across as i64 - 1;
        for (i, heights) in heights.chunks_exact(across).enumerate() {
            let shift = self.shift(i);
            let share = (shift - shift.floor()) as f32;
            let first = self.first + group as i64 + shift.floor() as i64;
            let mix = |low: f32, high: f32| low + share * (high - low);
            if first >= 0 && first + (GROUP as i64) <= last {
                let heights = &heights[first as usize..][..GROUP + 1];
                for line in 0..GROUP {
                    lines[line * along + i] = mix(heights[line], heights[line + 1]);
                }
            } else {
                for line in 0..GROUP {
                    let at = |across: i64| heights[across.clamp(0, last) as usize];
                    let across = first + line as i64;
                    lines[line * along + i] = mix(at(across), at(across + 1));
                }
            }
        }
    }
}

/// Replaces heights along a line by the tangents of their horizons, 0 where nothing lies ahead; ahead is where `inverse`
/// points.
fn sweep(samples: &mut [f32], inverse: f32, hull: &mut [(f32, f32)]) {
    let last = samples.len();
    // The hull of what lies ahead, the nearest point last, by its number from the far end and its height.
    let mut depth = 0;
    for number in 0..last {
        let sample = if inverse > 0.0 { &mut samples[last - 1 - number] } else { &mut samples[number] };
        let (at, height) = (number as f32, *sample);
        let mut nearest = (at - 1.0, height);
        if depth > 0 {
            nearest = hull[depth - 1];
            while depth > 1 {
                let farther = hull[depth - 2];
                if (nearest.1 - height) * (at - farther.0) > (farther.1 - height) * (at - nearest.0) {
                    break;
                }
                nearest = farther;
                depth -= 1;
            }
        }
        *sample = (nearest.1 - height) / (at - nearest.0) * inverse.abs();
        hull[depth] = (at, height);
        depth += 1;
    }
}

/// Tangents to elevations, at least 0.
struct Elevations<'a>(&'a mut [f32]);

impl Task<f32> for Elevations<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        for tangents in self.0.as_chunks_mut::<GROUP>().0 {
            for part in 0..GROUP / V::WIDTH {
                let elevation = arctangent(V::load(tangents, part)).max(V::constant(0.0));
                elevation.min(V::splat(std::f32::consts::FRAC_PI_2)).store(tangents, part);
            }
        }
    }
}
