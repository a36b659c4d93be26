//! General rotations in lanes.

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::Batch;
use super::linear::Dense;
use crate::order::{MAX_COEFFICIENTS, coefficients, index};
use crate::rotation::{QuarterTurn, Rotation};

impl Batch {
    /// Every vector of `input` rotated by one rotation, see [`Rotation::apply`].
    ///
    /// # Panics
    /// If the rotation is of another order, or the batches differ in size or do not hold whole vectors.
    pub fn rotate<T: Real>(&self, rotation: &Rotation, input: &[Block<T>], out: &mut [Block<T>]) {
        assert_eq!(rotation.order(), self.order, "a rotation of another order");
        self.assert_batches([input.len()], out.len());
        let stride = coefficients(self.order);
        for (l, block) in rotation.blocks().enumerate() {
            let (first, size) = (coefficients(l), 2 * l + 1);
            let matrix: Vec<T> = block.iter().map(|&entry| T::from_f64(entry)).collect();
            run(self.simd, Dense { size, matrix: &matrix, x: &input[first..], out: &mut out[first..], stride });
        }
    }

    /// Every vector of `input` rotated by a rotation of its own, given by the blocks of its matrix by rows: three rotations
    /// about z and two quarter turns about x. In `f32` it errs by at most 1e-6 of the length at every angle, near the identity
    /// too. The matrices must be rotations; reflections, which [`Rotation`] takes, are none.
    ///
    /// # Panics
    /// If the batches differ in size or do not hold `n²` blocks for each matrix.
    pub fn rotate_each<T: Real>(&self, matrices: &[[[Block<T>; 3]; 3]], input: &[Block<T>], out: &mut [Block<T>]) {
        self.assert_batches([input.len()], out.len());
        assert_eq!(out.len(), coefficients(self.order) * matrices.len(), "n² blocks a matrix");
        run(self.simd, RotateEach { order: self.order, matrices, input, out });
    }
}

struct RotateEach<'a, T> {
    order: usize,
    matrices: &'a [[[Block<T>; 3]; 3]],
    input: &'a [Block<T>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for RotateEach<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let size = coefficients(self.order);
        let QuarterTurn { forward, backward } = QuarterTurn::get();
        let mut buffers = [[V::constant(0.0); MAX_COEFFICIENTS]; 2];
        let [value, turned] = &mut buffers;
        let vectors = self.input.chunks_exact(size).zip(self.out.chunks_exact_mut(size));
        for (matrix, (input, out)) in self.matrices.iter().zip(vectors) {
            for part in 0..LANES / V::WIDTH {
                let [alpha, beta, gamma] = angles::<V>(matrix, part);
                for (value, block) in value.iter_mut().zip(input) {
                    *value = V::load(&block.0, part);
                }
                rotate_z(self.order, gamma, value);
                multiply(&forward[..size], value, turned);
                rotate_z(self.order, beta, turned);
                multiply(&backward[..size], turned, value);
                rotate_z(self.order, alpha, value);
                for (block, value) in out.iter_mut().zip(&*value) {
                    value.store(&mut block.0, part);
                }
            }
        }
    }
}

/// Cosines and sines of α, β and γ, see [`crate::rotation`].
#[inline(always)]
fn angles<V: Lanes>(matrix: &[[Block<V::Scalar>; 3]; 3], part: usize) -> [[V; 2]; 3] {
    let mut m = [[V::constant(0.0); 3]; 3];
    for (row, blocks) in m.iter_mut().zip(matrix) {
        for (entry, block) in row.iter_mut().zip(blocks) {
            *entry = V::load(&block.0, part);
        }
    }
    let alpha = unit(m[0][2], m[1][2]);
    let [cos, sin] = alpha;
    let beta = unit(m[2][2], sin.mul_add(m[1][2], cos.mul(m[0][2])));
    let gamma = unit(sin.neg_mul_add(m[0][1], cos.mul(m[1][1])), sin.neg_mul_add(m[0][0], cos.mul(m[1][0])));
    [alpha, beta, gamma]
}

/// Scaled to length 1; `[1, 0]` if shorter than anything that matters.
#[inline(always)]
fn unit<V: Lanes>(cos: V, sin: V) -> [V; 2] {
    let (zero, one, least) = (V::constant(0.0), V::constant(1.0), V::constant(1e-30));
    let squares = sin.mul_add(sin, cos.mul(cos));
    let nearness = one.div(squares.sqrt());
    [least.where_less(squares, cos.mul(nearness), one), least.where_less(squares, sin.mul(nearness), zero)]
}

#[inline(always)]
fn multiply<V: Lanes>(rows: &[Vec<(usize, f64)>], x: &[V], out: &mut [V]) {
    for (row, out) in rows.iter().zip(out) {
        let mut sum = V::constant(0.0);
        for &(column, value) in row {
            sum = V::constant(value).mul_add(x[column], sum);
        }
        *out = sum;
    }
}

#[inline(always)]
fn rotate_z<V: Lanes>(order: usize, [cos_step, sin_step]: [V; 2], value: &mut [V]) {
    let (mut cos, mut sin) = (cos_step, sin_step);
    for m in 1..order as isize {
        for l in m as usize..order {
            let (cosine, sine) = (value[index(l, m)], value[index(l, -m)]);
            value[index(l, -m)] = sine.mul_add(cos, cosine.mul(sin));
            value[index(l, m)] = sine.neg_mul_add(sin, cosine.mul(cos));
        }
        (cos, sin) = (sin.neg_mul_add(sin_step, cos.mul(cos_step)), sin.mul_add(cos_step, cos.mul(sin_step)));
    }
}
