//! Rotation of SH vectors: any rotation, and the cheap one about z.

use std::sync::OnceLock;

use crate::basis::evaluate;
use crate::order::{MAX_ORDER, assert_order, assert_vector, coefficients, index};
use crate::quadrature::Quadrature;
use crate::zonal::band;
use halflight_sh_kernels::Real;

/// The block-diagonal matrix that rotates SH vectors: one `(2l+1)²` block a band.
///
/// The blocks are the projections of the rotated basis functions by a quadrature that is exact for them, so that the
/// error is rounding (about 1e-15) at every angle, with no Euler angles and no special cases.
#[derive(Clone, Debug)]
pub struct Rotation {
    order: usize,
    /// The blocks one after another, each row-major.
    blocks: Vec<f64>,
}

/// A quadrature exact for products of two functions of one order, with the basis at its directions.
struct Samples {
    rule: Quadrature,
    basis: Vec<f64>,
}

fn samples(order: usize) -> &'static Samples {
    static SAMPLES: [OnceLock<Samples>; MAX_ORDER] = [const { OnceLock::new() }; MAX_ORDER];
    SAMPLES[order - 1].get_or_init(|| {
        let size = coefficients(order);
        let rule = Quadrature::exact(2 * (order - 1));
        let mut basis = vec![0.0; size * rule.directions.len()];
        for (&direction, out) in rule.directions.iter().zip(basis.chunks_exact_mut(size)) {
            evaluate(order, direction, out);
        }
        Samples { rule, basis }
    })
}

impl Rotation {
    /// The rotation of SH vectors that belongs to a rotation matrix, given by rows: `f` becomes `s ↦ f(R⁻¹ s)`.
    ///
    /// The matrix must be orthogonal (a reflection works too); otherwise the result is no rotation.
    ///
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`].
    pub fn new(order: usize, matrix: [[f64; 3]; 3]) -> Self {
        assert_order(order);
        let Samples { rule, basis } = samples(order);
        let size = coefficients(order);
        let mut blocks = vec![0.0; (0..order).map(|l| (2 * l + 1).pow(2)).sum()];
        let mut turned = vec![0.0; size];
        for ((&s, &weight), fixed) in rule.directions.iter().zip(&rule.weights).zip(basis.chunks_exact(size)) {
            let back = std::array::from_fn(|column| (0..3).map(|row| matrix[row][column] * s[row]).sum());
            evaluate(order, back, &mut turned);
            let mut entries = blocks.iter_mut();
            for l in 0..order {
                for y in &fixed[band(l)] {
                    turned[band(l)].iter().zip(&mut entries).for_each(|(t, entry)| *entry += weight * y * t);
                }
            }
        }
        Self { order, blocks }
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The blocks of the bands in turn, each `(2l+1)²` entries by rows.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = &[f64]> {
        let mut rest = self.blocks.as_slice();
        (0..self.order).map(move |l| {
            let (block, after) = rest.split_at((2 * l + 1).pow(2));
            rest = after;
            block
        })
    }

    /// Writes the rotated vector.
    ///
    /// # Panics
    /// If a slice does not hold `n²` coefficients.
    pub fn apply<T: Real>(&self, input: &[T], out: &mut [T]) {
        assert_vector(self.order, input);
        assert_vector(self.order, out);
        let mut blocks = self.blocks.as_slice();
        for l in 0..self.order {
            let width = 2 * l + 1;
            let (block, rest) = blocks.split_at(width * width);
            blocks = rest;
            for (target, row) in out[band(l)].iter_mut().zip(block.chunks_exact(width)) {
                let terms = row.iter().zip(&input[band(l)]).map(|(&r, &v)| T::from_f64(r) * v);
                *target = terms.fold(T::ZERO, |sum, term| sum + term);
            }
        }
    }
}

/// Rotates about z by `angle` radians, counter-clockwise seen from +z.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or a slice does not hold `n²` coefficients.
pub fn rotate_z<T: Real>(order: usize, angle: T, input: &[T], out: &mut [T]) {
    assert_vector(order, input);
    assert_vector(order, out);
    let (sin_step, cos_step) = angle.sin_cos();
    let (mut sin, mut cos) = (T::ZERO, T::ONE);
    for m in 0..order as isize {
        for l in m as usize..order {
            let (cosine, sine) = (input[index(l, m)], input[index(l, -m)]);
            out[index(l, -m)] = sine * cos + cosine * sin;
            out[index(l, m)] = cosine * cos - sine * sin; // last: for m = 0 both are the same coefficient
        }
        (sin, cos) = (sin * cos_step + cos * sin_step, cos * cos_step - sin * sin_step);
    }
}
