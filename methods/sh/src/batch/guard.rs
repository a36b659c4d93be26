//! Lanes that the overlap guard need not look at.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::Batch;
use crate::order::{SQRT_4_PI, coefficients};

impl Batch {
    /// In which lanes [`project_binary_bound`](crate::project_binary_bound) surely leaves the vector as it is. A few that it would leave, by
    /// less than their own rounding, are not told; nothing outside the bound or not finite is.
    ///
    /// # Panics
    /// If there is not one block of vectors.
    pub fn within_binary_bound<T: Real>(&self, g: &[Block<T>]) -> [bool; LANES] {
        assert_eq!(g.len(), coefficients(self.order), "one block of vectors");
        let mut inside = Block::ZERO;
        run(self.simd, Within { g, inside: &mut inside });
        inside.0.map(|inside| inside > T::ZERO)
    }
}

struct Within<'a, T> {
    g: &'a [Block<T>],
    /// 1 or 0.
    inside: &'a mut Block<T>,
}

impl<T: Real> Task<T> for Within<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        // The guard lets pass an excess of 64 roundings; sums here are off by less than 24, or 64 parts of themselves.
        let rounding = T::EPSILON.to_f64();
        for part in 0..LANES / V::WIDTH {
            let (zero, one) = (V::constant(0.0), V::constant(1.0));
            let mut squares = [zero; 4];
            for (i, block) in self.g.iter().enumerate().skip(1) {
                let x = V::load(&block.0, part);
                squares[i % 4] = x.mul_add(x, squares[i % 4]);
            }
            let energy = squares[0].add(squares[1]).add(squares[2].add(squares[3]));
            let mean = V::load(&self.g[0].0, part);
            let bound = mean.mul(V::constant(SQRT_4_PI).sub(mean)).add(V::constant(40.0 * rounding));
            let inside = energy.mul(V::constant(1.0 + 64.0 * rounding)).where_less(bound, one, zero);
            inside.store(&mut self.inside.0, part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project_binary_bound;

    #[test]
    fn what_is_told_is_left_alone_and_what_is_not_lies_at_the_bound() {
        for order in 1..=8 {
            let (batch, mut told, mut cases) = (Batch::new(order), 0, 0);
            for k in 0..400 {
                let block: Vec<Block<f32>> =
                    (0..coefficients(order)).map(|i| Block(std::array::from_fn(|lane| wave(k, i, lane)))).collect();
                for (lane, inside) in batch.within_binary_bound(&block).into_iter().enumerate() {
                    let mut vector: Vec<f32> = block.iter().map(|block| block.0[lane]).collect();
                    let guarded = project_binary_bound(order, &mut vector);
                    assert!(!(inside && guarded), "order {order}: {vector:?}");
                    told += usize::from(inside);
                    cases += usize::from(!guarded);
                }
            }
            assert!(told > 1000 && told + cases / 50 > cases, "order {order}: {told} of {cases}");
        }
    }

    /// Vectors of every length about the bound, some with a mean outside or at its ends, some not finite.
    fn wave(k: usize, i: usize, lane: usize) -> f32 {
        let sky = (4.0 * std::f32::consts::PI).sqrt();
        let mean = (k as f32 + 0.1 * lane as f32) / 380.0 * sky;
        match (i, lane) {
            (0, 0) => sky,
            (0, 1) => 0.0,
            (0, 2) => [f32::NAN, f32::INFINITY, -1e-3, sky + 1e-3][k % 4],
            (0, _) => mean,
            (_, 0 | 1) => 1e-3 * (k % 2) as f32,
            (1, 3) if k.is_multiple_of(7) => [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][k % 3],
            _ => {
                let length = (mean * (sky - mean)).max(0.0).sqrt();
                length * (i as f32 * 12.9 + k as f32).sin() * (0.2 + 0.1 * lane as f32) / (i as f32).sqrt()
            }
        }
    }
}
