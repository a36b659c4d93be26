//! Basis functions, zonal rotations and rotations about z in lanes.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::Batch;
use crate::order::{coefficients, index};

impl Batch {
    /// The `n²` basis functions at directions, given as blocks of x, of y and of z; see [`evaluate`](crate::evaluate).
    ///
    /// # Panics
    /// If `out` does not hold `n²` blocks for each direction.
    pub fn evaluate<T: Real>(&self, directions: &[[Block<T>; 3]], out: &mut [Block<T>]) {
        assert_eq!(out.len(), coefficients(self.order) * directions.len(), "n² blocks a direction");
        T::evaluate(self.simd, self.order, directions, out);
    }

    /// Zonal vectors, `n` blocks each, turned to directions; see [`rotate_zonal`](crate::rotate_zonal).
    ///
    /// # Panics
    /// If `zonal` does not hold `n` blocks and `out` `n²` for each direction.
    pub fn rotate_zonal<T: Real>(&self, zonal: &[Block<T>], directions: &[[Block<T>; 3]], out: &mut [Block<T>]) {
        assert_eq!(zonal.len(), self.order * directions.len(), "n blocks a zonal vector");
        assert_eq!(out.len(), coefficients(self.order) * directions.len(), "n² blocks a direction");
        T::rotate_zonal(self.simd, self.order, zonal, directions, out);
    }

    /// The sums of vectors as [`Batch::rotate_zonal`] makes them, lane by lane, added to what `out` holds: `n²` additions a
    /// lobe, which come with the multiplications.
    ///
    /// # Panics
    /// If `zonal` does not hold `n` blocks for each direction and `out` `n²`.
    pub fn sum_zonal<T: Real>(&self, zonal: &[Block<T>], directions: &[[Block<T>; 3]], out: &mut [Block<T>]) {
        assert_eq!(zonal.len(), self.order * directions.len(), "n blocks a zonal vector");
        assert_eq!(out.len(), coefficients(self.order), "n² blocks");
        T::sum_zonal(self.simd, self.order, zonal, directions, out);
    }

    /// Rotations about z, counter-clockwise seen from +z, by angles given as blocks of their cosines and of their sines;
    /// see [`rotate_z`](crate::rotate_z).
    ///
    /// # Panics
    /// If the batches differ in size or do not hold `n²` blocks for each angle.
    pub fn rotate_z<T: Real>(&self, angles: &[[Block<T>; 2]], input: &[Block<T>], out: &mut [Block<T>]) {
        self.assert_batches([input.len()], out.len());
        assert_eq!(out.len(), coefficients(self.order) * angles.len(), "n² blocks an angle");
        run(self.simd, RotateZ { order: self.order, angles, input, out });
    }
}

struct RotateZ<'a, T> {
    order: usize,
    angles: &'a [[Block<T>; 2]],
    input: &'a [Block<T>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for RotateZ<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let size = coefficients(self.order);
        let vectors = self.input.chunks_exact(size).zip(self.out.chunks_exact_mut(size));
        for ([cosines, sines], (input, out)) in self.angles.iter().zip(vectors) {
            for part in 0..LANES / V::WIDTH {
                let (cos_step, sin_step) = (V::load(&cosines.0, part), V::load(&sines.0, part));
                let (mut cos, mut sin) = (V::constant(1.0), V::constant(0.0));
                for m in 0..self.order as isize {
                    for l in m as usize..self.order {
                        let (minus, plus) = (index(l, -m), index(l, m));
                        let (cosine, sine) = (V::load(&input[plus].0, part), V::load(&input[minus].0, part));
                        sine.mul_add(cos, cosine.mul(sin)).store(&mut out[minus].0, part);
                        sine.neg_mul_add(sin, cosine.mul(cos)).store(&mut out[plus].0, part); // last: they are one for m = 0
                    }
                    let next = sin.neg_mul_add(sin_step, cos.mul(cos_step));
                    sin = sin.mul_add(cos_step, cos.mul(sin_step));
                    cos = next;
                }
            }
        }
    }
}
