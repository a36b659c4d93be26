//! Rotation of SH vectors: any rotation, and the cheap one about z.
//!
//! A rotation is one about z by γ, one about y by β and one about z by α; that about y is one about z between quarter turns
//! about x, whose matrices are constant. Near the identity α and γ are badly determined each by itself, their sum is not: γ is
//! therefore taken from what the chosen α and β leave of the matrix, and every α would do to rounding.

use std::sync::OnceLock;

use crate::basis::evaluate;
use crate::order::{MAX_ORDER, assert_order, assert_vector, coefficients, index};
use crate::quadrature::Quadrature;
use crate::zonal::band;
use halflight_sh_kernels::Real;

/// Entries of the quarter turn below this are the rounding of zeros.
const ROUNDING: f64 = 1e-13;

/// The block-diagonal matrix that rotates SH vectors: one `(2l+1)²` block a band.
///
/// Entries err by about 1e-15 at every angle.
#[derive(Clone, Debug)]
pub struct Rotation {
    order: usize,
    /// The blocks one after another, each row-major.
    blocks: Vec<f64>,
}

/// The rotation by 90° about x, which takes y to z, at the highest order.
pub(crate) struct QuarterTurn {
    /// For each coefficient of the result those of the input that it is made of, with their factors.
    pub(crate) forward: Vec<Vec<(usize, f64)>>,
    /// The inverse.
    pub(crate) backward: Vec<Vec<(usize, f64)>>,
}

impl QuarterTurn {
    pub(crate) fn get() -> &'static Self {
        static TURN: OnceLock<QuarterTurn> = OnceLock::new();
        TURN.get_or_init(|| {
            let forward = by_quadrature(MAX_ORDER, |[x, y, z]| [x, z, -y]);
            let mut backward = vec![Vec::new(); forward.len()];
            for (row, entries) in forward.iter().enumerate() {
                entries.iter().for_each(|&(column, value)| backward[column].push((row, value)));
            }
            Self { forward, backward }
        })
    }
}

/// The projections of the basis functions at directions that are turned back, by a quadrature that is exact for them.
fn by_quadrature(order: usize, turn_back: fn([f64; 3]) -> [f64; 3]) -> Vec<Vec<(usize, f64)>> {
    let size = coefficients(order);
    let rule = Quadrature::exact(2 * (order - 1));
    let mut matrix = vec![0.0; size * size];
    let [mut fixed, mut turned] = [0; 2].map(|_| vec![0.0; size]);
    for (&direction, &weight) in rule.directions.iter().zip(&rule.weights) {
        evaluate(order, direction, &mut fixed);
        evaluate(order, turn_back(direction), &mut turned);
        for (row, y) in matrix.chunks_exact_mut(size).zip(&fixed) {
            row.iter_mut().zip(&turned).for_each(|(entry, t)| *entry += weight * y * t);
        }
    }
    let sparse = |row: &[f64]| row.iter().copied().enumerate().filter(|(_, value)| value.abs() > ROUNDING).collect();
    matrix.chunks_exact(size).map(sparse).collect()
}

/// Cosine and sine of an angle.
type Angle = [f64; 2];

/// α, β and γ of a rotation matrix given by rows.
fn angles(m: &[[f64; 3]; 3]) -> [Angle; 3] {
    let unit = |cos: f64, sin: f64| {
        let length = cos.hypot(sin);
        if length > 0.0 { [cos / length, sin / length] } else { [1.0, 0.0] }
    };
    let alpha = unit(m[0][2], m[1][2]);
    let [cos, sin] = alpha;
    let beta = unit(m[2][2], cos * m[0][2] + sin * m[1][2]);
    let gamma = unit(cos * m[1][1] - sin * m[0][1], cos * m[1][0] - sin * m[0][0]);
    [alpha, beta, gamma]
}

/// The angles m = 1 to `count` times as large.
fn multiples([cos, sin]: Angle, count: usize) -> impl Iterator<Item = (usize, Angle)> {
    let next = move |last: &Angle| Some([cos * last[0] - sin * last[1], sin * last[0] + cos * last[1]]);
    std::iter::successors(Some([cos, sin]), next).take(count).enumerate().map(|(k, angle)| (k + 1, angle))
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
        let [[a, b, c], [d, e, f], [g, h, i]] = matrix;
        let determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
        // A reflection is a rotation of the opposite directions, at which odd bands change sign.
        let sign = determinant.signum();
        let angles = angles(&matrix.map(|row| row.map(|entry| sign * entry)));
        let mut blocks = Vec::with_capacity((0..order).map(|l| (2 * l + 1).pow(2)).sum());
        for l in 0..order {
            let start = blocks.len();
            push_block(l, &angles, &mut blocks);
            if l % 2 == 1 {
                blocks[start..].iter_mut().for_each(|entry| *entry *= sign);
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

/// Appends a band's block: α, a quarter turn back, β, a quarter turn, γ, from the last to the first.
fn push_block(l: usize, [alpha, beta, gamma]: &[Angle; 3], blocks: &mut Vec<f64>) {
    let (width, first) = (2 * l + 1, coefficients(l));
    let QuarterTurn { forward, backward } = QuarterTurn::get();
    let mut buffer = [0.0; (2 * MAX_ORDER - 1).pow(2)];
    let turned = &mut buffer[..width * width];
    for (row, entries) in turned.chunks_exact_mut(width).zip(&forward[first..]) {
        entries.iter().for_each(|&(column, value)| row[column - first] = value);
    }
    turn_columns(l, *gamma, turned);
    turn_rows(l, *beta, turned);
    let start = blocks.len();
    blocks.resize(start + width * width, 0.0);
    let block = &mut blocks[start..];
    for (row, entries) in block.chunks_exact_mut(width).zip(&backward[first..]) {
        for &(column, value) in entries {
            let from = &turned[(column - first) * width..][..width];
            row.iter_mut().zip(from).for_each(|(entry, x)| *entry += value * x);
        }
    }
    turn_rows(l, *alpha, block);
}

/// Multiplies a band's block from the left by a rotation about z.
fn turn_rows(l: usize, angle: Angle, block: &mut [f64]) {
    let width = 2 * l + 1;
    for (m, [cos, sin]) in multiples(angle, l) {
        let (upper, lower) = block.split_at_mut((l + m) * width);
        let (sines, cosines) = (&mut upper[(l - m) * width..][..width], &mut lower[..width]);
        for (s, c) in sines.iter_mut().zip(cosines) {
            (*s, *c) = (*s * cos + *c * sin, *c * cos - *s * sin);
        }
    }
}

/// The same from the right.
fn turn_columns(l: usize, angle: Angle, block: &mut [f64]) {
    for (m, [cos, sin]) in multiples(angle, l) {
        for row in block.chunks_exact_mut(2 * l + 1) {
            let (s, c) = (row[l - m], row[l + m]);
            (row[l - m], row[l + m]) = (s * cos - c * sin, s * sin + c * cos);
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
