//! Eigen-decomposition of a small dense symmetric matrix, kept in factored form.

/// Rotations of the QL iteration that find one eigenvalue; about two are usual, and only NaN needs more than ten.
const MAX_SWEEPS: usize = 60;

/// `A = V D Vᵀ` of a symmetric matrix, with `V` kept as Householder reflections followed by plane rotations.
///
/// Applying a function of the matrix to one vector, which is all that the SH logarithm and exponential need, then takes
/// `O(n²)` after the `4/3 n³` of the reduction to tridiagonal form, instead of the `9 n³` that explicit eigenvectors cost.
/// The workspace is reused: after the first decomposition of a size nothing is allocated.
#[derive(Clone, Debug, Default)]
pub struct SymmetricEigen {
    size: usize,
    /// Row `k` holds in its columns after `k` the `k`-th Householder vector.
    reflectors: Vec<f64>,
    /// `2/|v|²` of each Householder vector, 0 for one that is not needed.
    betas: Vec<f64>,
    rotations: Vec<PlaneRotation>,
    values: Vec<f64>,
    /// The off-diagonal of the tridiagonal matrix; scratch of the reduction before that.
    off_diagonal: Vec<f64>,
}

/// A rotation of the coordinates `index` and `index + 1`.
#[derive(Clone, Copy, Debug)]
struct PlaneRotation {
    index: usize,
    cos: f64,
    sin: f64,
}

impl SymmetricEigen {
    /// An empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// Decomposes the symmetric row-major `size×size` matrix. The upper triangle is trusted to equal the lower one.
    ///
    /// Relative to the largest eigenvalue, which should be within 1e-100 to 1e100 in magnitude, the error is a few units in
    /// the last place of `f64`. A matrix with entries that
    /// are not finite yields eigenvalues that are not either; it ends all the same.
    ///
    /// # Panics
    /// If the matrix does not hold `size²` entries.
    pub fn decompose(&mut self, size: usize, matrix: &[f64]) {
        assert_eq!(matrix.len(), size * size, "a matrix of {size} rows has {} entries", size * size);
        self.size = size;
        self.reflectors.clear();
        self.reflectors.extend_from_slice(matrix);
        for vector in [&mut self.betas, &mut self.values, &mut self.off_diagonal] {
            vector.clear();
            vector.resize(size, 0.0);
        }
        self.rotations.clear();
        self.rotations.reserve(2 * size * size);
        self.tridiagonalise();
        self.iterate();
    }

    /// The eigenvalues, in no particular order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The largest eigenvalue; -∞ for an empty matrix.
    pub fn largest(&self) -> f64 {
        self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Replaces `vector` by `V h(D) Vᵀ vector`, that is applies the function `h` of the matrix.
    ///
    /// # Panics
    /// If the vector's length is not the matrix's size.
    pub fn apply(&self, vector: &mut [f64], mut h: impl FnMut(f64) -> f64) {
        assert_eq!(vector.len(), self.size, "vector and matrix differ in size");
        self.analyse(vector);
        vector.iter_mut().zip(&self.values).for_each(|(component, &value)| *component *= h(value));
        self.synthesise(vector);
    }

    /// Replaces `vector` by `Vᵀ vector`, its components along the eigenvectors.
    fn analyse(&self, vector: &mut [f64]) {
        for k in 0..self.size {
            self.reflect(k, vector);
        }
        for &PlaneRotation { index, cos, sin } in &self.rotations {
            let (a, b) = (vector[index], vector[index + 1]);
            vector[index] = cos * a - sin * b;
            vector[index + 1] = sin * a + cos * b;
        }
    }

    /// Replaces `vector`, components along the eigenvectors, by `V vector`.
    fn synthesise(&self, vector: &mut [f64]) {
        for &PlaneRotation { index, cos, sin } in self.rotations.iter().rev() {
            let (a, b) = (vector[index], vector[index + 1]);
            vector[index] = cos * a + sin * b;
            vector[index + 1] = cos * b - sin * a;
        }
        for k in (0..self.size).rev() {
            self.reflect(k, vector);
        }
    }

    /// Applies the `k`-th Householder reflection.
    fn reflect(&self, k: usize, vector: &mut [f64]) {
        if self.betas[k] != 0.0 {
            let reflector = &self.reflectors[k * self.size + k + 1..(k + 1) * self.size];
            let tail = &mut vector[k + 1..];
            let scale = self.betas[k] * dot(reflector, tail);
            subtract_scaled(tail, scale, reflector);
        }
    }

    /// Householder reduction to tridiagonal form (Golub and Van Loan, algorithm 8.3.1).
    fn tridiagonalise(&mut self) {
        let size = self.size;
        for k in 0..size {
            let (head, trailing) = self.reflectors.split_at_mut((k + 1) * size);
            self.values[k] = head[k * size + k];
            let v = &mut head[k * size + k + 1..];
            let Some((&first, tail)) = v.split_first() else { break };
            if dot(tail, tail) == 0.0 {
                self.off_diagonal[k] = first;
                continue;
            }
            // The sign that avoids cancellation in the first component.
            let alpha = -dot(v, v).sqrt().copysign(first);
            v[0] -= alpha;
            let beta = 2.0 / dot(v, v);
            self.betas[k] = beta;

            // A ← A - v wᵀ - w vᵀ with w = p - (β/2 pᵀv) v and p = β A v
            let w = &mut self.off_diagonal[k + 1..];
            w.fill(0.0);
            for (row, &component) in trailing.chunks_exact(size).zip(&*v) {
                subtract_scaled(w, -beta * component, &row[k + 1..]);
            }
            let shift = 0.5 * beta * dot(w, v);
            subtract_scaled(w, shift, v);
            for (i, row) in trailing.chunks_exact_mut(size).enumerate() {
                let (vi, wi) = (v[i], w[i]);
                for ((entry, &vj), &wj) in row[k + 1..].iter_mut().zip(&*v).zip(&*w) {
                    *entry -= vi * wj + wi * vj;
                }
            }
            self.off_diagonal[k] = alpha;
        }
        if let Some(last) = self.off_diagonal.last_mut() {
            *last = 0.0;
        }
    }

    /// Implicit QL iteration with Wilkinson's shift on the tridiagonal matrix (EISPACK `tql2`), rotations recorded.
    fn iterate(&mut self) {
        for low in 0..self.size {
            for _ in 0..MAX_SWEEPS {
                let high = self.end_of_block(low);
                if high == low {
                    break;
                }
                self.sweep(low, high);
            }
        }
    }

    /// The last row of the unreduced block that starts at row `low`.
    fn end_of_block(&self, low: usize) -> usize {
        (low..self.size - 1)
            .find(|&k| self.off_diagonal[k].abs() <= f64::EPSILON * (self.values[k].abs() + self.values[k + 1].abs()))
            .unwrap_or(self.size - 1)
    }

    /// One QL sweep over rows `low..=high`.
    fn sweep(&mut self, low: usize, high: usize) {
        let (d, e) = (&mut self.values, &mut self.off_diagonal);
        let ratio = (d[low + 1] - d[low]) / (2.0 * e[low]);
        let mut g = d[high] - d[low] + e[low] / (ratio + ratio.hypot(1.0).copysign(ratio));
        let (mut sin, mut cos, mut shift) = (1.0, 1.0, 0.0);
        for k in (low..high).rev() {
            let (f, b) = (sin * e[k], cos * e[k]);
            let r = (f * f + g * g).sqrt();
            e[k + 1] = r;
            if r == 0.0 {
                // Underflow: the block has split here.
                d[k + 1] -= shift;
                e[high] = 0.0;
                return;
            }
            (sin, cos) = (f / r, g / r);
            let base = d[k + 1] - shift;
            let turn = (d[k] - base) * sin + 2.0 * cos * b;
            shift = sin * turn;
            d[k + 1] = base + shift;
            g = cos * turn - b;
            self.rotations.push(PlaneRotation { index: k, cos, sin });
        }
        d[low] -= shift;
        e[low] = g;
        e[high] = 0.0;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `target -= scale·direction`.
fn subtract_scaled(target: &mut [f64], scale: f64, direction: &[f64]) {
    target.iter_mut().zip(direction).for_each(|(t, d)| *t -= scale * d);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A random symmetric matrix, some of its rows and columns zeroed so that reductions meet empty tails.
    fn symmetric() -> impl Strategy<Value = (usize, Vec<f64>)> {
        (1usize..=64).prop_flat_map(|size| {
            let entries = proptest::collection::vec(-1.0f64..1.0, size * size);
            let zeroed = proptest::collection::vec(proptest::bool::weighted(0.2), size);
            (entries, zeroed, -150i32..150).prop_map(move |(entries, zeroed, exponent)| {
                let scale = 2f64.powi(exponent);
                let at = |i: usize, j: usize| {
                    if zeroed[i] || zeroed[j] { 0.0 } else { scale * entries[i.max(j) * size + i.min(j)] }
                };
                (size, (0..size * size).map(|k| at(k / size, k % size)).collect())
            })
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn identity_function_of_the_matrix_is_the_matrix((size, matrix) in symmetric()) {
            let mut eigen = SymmetricEigen::new();
            eigen.decompose(size, &matrix);
            let scale = matrix.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for column in 0..size {
                let mut unit = vec![0.0; size];
                unit[column] = 1.0;
                let mut same = unit.clone();
                eigen.apply(&mut same, |_| 1.0);
                eigen.apply(&mut unit, |value| value);
                for row in 0..size {
                    prop_assert!((unit[row] - matrix[row * size + column]).abs() <= 1e-13 * scale);
                    prop_assert!((same[row] - f64::from(u8::from(row == column))).abs() < 1e-13);
                }
            }
        }
    }

    /// The second-difference matrix has the eigenvalues 2 - 2 cos(kπ/(n+1)).
    #[test]
    fn eigenvalues_of_the_second_difference() {
        let size = 33usize;
        let matrix: Vec<f64> = (0..size * size)
            .map(|k| match (k / size).abs_diff(k % size) {
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            })
            .collect();
        let mut eigen = SymmetricEigen::new();
        eigen.decompose(size, &matrix);
        let mut values = eigen.values().to_vec();
        values.sort_by(f64::total_cmp);
        for (k, value) in values.iter().enumerate() {
            let want = 2.0 - 2.0 * (std::f64::consts::PI * (k + 1) as f64 / (size + 1) as f64).cos();
            assert!((value - want).abs() < 1e-13);
        }
        assert!((eigen.largest() - values[size - 1]).abs() < 1e-15);
    }

    #[test]
    fn not_finite_entries_end() {
        let mut eigen = SymmetricEigen::new();
        eigen.decompose(16, &[f64::NAN; 256]);
        assert!(!eigen.largest().is_finite());
    }
}
