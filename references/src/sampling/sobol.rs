//! Two-dimensional Sobol points with hash-based Owen scrambling (Burley 2020, Practical Hash-based Owen Scrambling).

use super::mix;

/// One randomised replicate of the first two Sobol dimensions. Its first `2^k` points hit every elementary interval of area
/// `2^-k` once; each point is uniform in the unit square; replicates of different seeds are independent.
pub(crate) struct Sobol {
    seeds: [u32; 2],
    order: u32,
}

impl Sobol {
    pub(crate) fn new(seed: u64) -> Self {
        let bits = mix(seed, 0);
        Sobol { seeds: [bits as u32, (bits >> 32) as u32], order: mix(seed, 1) as u32 }
    }

    /// The points in another order, in which every aligned `2^k` of them still are well spread: for further dimensions of samples
    /// that have used `index` before.
    pub(crate) fn shuffled(&self, index: u32) -> [f32; 2] {
        self.point(scramble_reversed(index.reverse_bits(), self.order).reverse_bits())
    }

    /// Point `index`, strictly inside the unit square.
    pub(crate) fn point(&self, index: u32) -> [f32; 2] {
        // Scrambling works on reversed bits; the first dimension is the reversed index, so it is reversed but once.
        let x = scramble_reversed(index, self.seeds[0]).reverse_bits();
        let y = scramble_reversed(second_dimension(index).reverse_bits(), self.seeds[1]).reverse_bits();
        [unit(x), unit(y)]
    }
}

/// The second Sobol dimension, whose direction numbers are the rows of Pascal's triangle modulo 2.
fn second_dimension(mut index: u32) -> u32 {
    let (mut result, mut direction) = (0, 1 << 31);
    while index != 0 {
        if index & 1 != 0 {
            result ^= direction;
        }
        direction ^= direction >> 1;
        index >>= 1;
    }
    result
}

/// A permutation in which every bit depends on itself and lower ones alone: Owen scrambling, on reversed bits.
/// Constants by Vegdahl (2021), which pass where those of the paper leave structure.
fn scramble_reversed(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// The middle of one of `2^23` cells: never 0 or 1.
fn unit(bits: u32) -> f32 {
    ((bits >> 9) as f32 + 0.5) * (1.0 / (1 << 23) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::chi_squared_survival;

    #[test]
    fn every_elementary_interval_is_hit_once() {
        for seed in 0..20 {
            let sobol = Sobol::new(seed);
            for k in 0..=8u32 {
                let points: Vec<_> = (0..1 << k).map(|i| sobol.point(i)).collect();
                for columns in 0..=k {
                    let (w, h) = (1u32 << columns, 1u32 << (k - columns));
                    let mut cells: Vec<_> =
                        points.iter().map(|[x, y]| ((x * w as f32) as u32, (y * h as f32) as u32)).collect();
                    cells.sort_unstable();
                    cells.dedup();
                    assert_eq!(cells.len(), 1 << k, "seed {seed}, {w}×{h}");
                }
            }
        }
    }

    #[test]
    fn shuffled_points_are_as_well_spread_and_owe_nothing_to_the_index() {
        let sobol = Sobol::new(3);
        let mut cells: Vec<_> =
            (0..256).map(|i| sobol.shuffled(i).map(|x| (x * 16.0) as u32)).map(|[x, y]| 16 * x + y).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 256);
        // Against the plain points of another seed: correlation over many pairs.
        let products = (0..4000u64).map(|seed| {
            let (a, b) = (Sobol::new(mix(1, seed)), Sobol::new(mix(2, seed)));
            (0..4).map(|i| f64::from((a.point(i)[0] - 0.5) * (b.shuffled(i)[0] - 0.5))).sum::<f64>()
        });
        let (sum, squares) = products.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
        assert!(sum.abs() < 4.0 * squares.sqrt(), "{sum} for {}", squares.sqrt());
    }

    #[test]
    fn one_point_over_seeds_is_uniform() {
        const CELLS: usize = 16;
        let draws = 64_000;
        for index in [0, 1, 5, 100] {
            let mut counts = [0u32; CELLS * CELLS];
            for seed in 0..draws {
                let [x, y] = Sobol::new(mix(7, seed)).point(index);
                counts[(x * CELLS as f32) as usize * CELLS + (y * CELLS as f32) as usize] += 1;
            }
            let expected = draws as f64 / counts.len() as f64;
            let chi: f64 = counts.iter().map(|c| (f64::from(*c) - expected).powi(2) / expected).sum();
            let p = chi_squared_survival(chi, (counts.len() - 1) as f64);
            assert!(p > 1e-4, "index {index}: p = {p}");
        }
    }
}
