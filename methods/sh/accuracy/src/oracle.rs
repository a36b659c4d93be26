//! What operations should give, in `f64`, by ways that share nothing with the code under test but Gauss–Legendre nodes:
//! basis functions by their explicit sums, everything else by quadrature over the sphere.

use std::f64::consts::{PI, SQRT_2};
use std::sync::LazyLock;

use halflight_sh::{MAX_ORDER, Quadrature, coefficients, gauss_legendre, index};

use crate::vector::{dot, norm};

/// `√4π`, the first coefficient of the function 1.
pub(crate) const SQRT_4_PI: f64 = 3.544_907_701_811_032;

/// For each `l, m` the coefficients of `y_lm / (sin^m θ · cos or sin mφ)` by powers `z^(l-m-2k)`, `k = 0, 1, …`.
static SUMS: LazyLock<Vec<Vec<Vec<f64>>>> = LazyLock::new(|| {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let sum = |l: usize, m: usize| {
        let unit = ((2 * l + 1) as f64 / (4.0 * PI) * factorial(l - m) / factorial(l + m)).sqrt();
        let scale = if m > 0 { SQRT_2 * unit } else { unit } / 2f64.powi(l as i32);
        let term = |k: usize| {
            let sign = if k.is_multiple_of(2) { scale } else { -scale };
            sign * factorial(2 * l - 2 * k) / (factorial(k) * factorial(l - k) * factorial(l - 2 * k - m))
        };
        (0..=(l - m) / 2).map(term).collect()
    };
    (0..MAX_ORDER).map(|l| (0..=l).map(|m| sum(l, m)).collect()).collect()
});

/// The basis functions at a unit vector by the explicit sums of Legendre's polynomials.
pub(crate) fn basis(order: usize, [x, y, z]: [f64; 3], out: &mut [f64]) {
    for l in 0..order {
        let (mut cosine, mut sine) = (1.0, 0.0);
        for (m, sum) in SUMS[l].iter().enumerate() {
            let polynomial = sum.iter().fold(0.0, |value, term| value * z * z + term);
            let latitude = if (l - m).is_multiple_of(2) { polynomial } else { polynomial * z };
            out[index(l, -(m as isize))] = latitude * sine;
            out[index(l, m as isize)] = latitude * cosine;
            (cosine, sine) = (x * cosine - y * sine, x * sine + y * cosine);
        }
    }
}

/// Exact integrals of polynomials of a degree, with the basis at the points.
pub(crate) struct Oracle {
    order: usize,
    rule: Quadrature,
    /// Point by point.
    basis: Vec<f64>,
}

impl Oracle {
    /// Exact for products of three functions of an order.
    pub(crate) fn new(order: usize) -> Self {
        Self::of_degree(order, 3 * (order - 1))
    }

    /// Exact to a degree.
    pub(crate) fn of_degree(order: usize, degree: usize) -> Self {
        let rule = Quadrature::exact(degree);
        let size = coefficients(order);
        let mut values = vec![0.0; size * rule.directions.len()];
        for (&s, out) in rule.directions.iter().zip(values.chunks_exact_mut(size)) {
            basis(order, s, out);
        }
        Self { order, rule, basis: values }
    }

    fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.basis.chunks_exact(coefficients(self.order))
    }

    /// A function's values at the points.
    pub(crate) fn values(&self, f: &[f64]) -> Vec<f64> {
        self.rows().map(|row| dot(row, f)).collect()
    }

    /// The coefficients of a function that is given by its values at the points.
    pub(crate) fn project(&self, values: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; coefficients(self.order)];
        for ((row, weight), value) in self.rows().zip(&self.rule.weights).zip(values) {
            out.iter_mut().zip(row).for_each(|(sum, y)| *sum += weight * value * y);
        }
        out
    }

    /// The projection of the product of two functions.
    pub(crate) fn product(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let values: Vec<f64> = self.values(a).iter().zip(self.values(b)).map(|(a, b)| a * b).collect();
        self.project(&values)
    }

    /// The integral of the product of three functions.
    pub(crate) fn triple_product(&self, a: &[f64], b: &[f64], c: &[f64]) -> f64 {
        let values = self.values(a).into_iter().zip(self.values(b)).zip(self.values(c));
        values.zip(&self.rule.weights).map(|(((a, b), c), weight)| weight * a * b * c).sum()
    }

    /// The projection of `s ↦ f(R⁻¹ s)`.
    pub(crate) fn rotated(&self, rotation: &[[f64; 3]; 3], f: &[f64]) -> Vec<f64> {
        let mut turned = vec![0.0; f.len()];
        let values: Vec<f64> = self
            .rule
            .directions
            .iter()
            .map(|s| {
                let back = std::array::from_fn(|j| (0..3).map(|i| rotation[i][j] * s[i]).sum());
                basis(self.order, back, &mut turned);
                dot(&turned, f)
            })
            .collect();
        self.project(&values)
    }

    /// The projection of the function about `axis` that is `Σ zonal_l y_l0` about z.
    pub(crate) fn lobe(&self, zonal: &[f64], axis: [f64; 3]) -> Vec<f64> {
        let mut about_z = vec![0.0; coefficients(self.order)];
        let values: Vec<f64> = self
            .rule
            .directions
            .iter()
            .map(|s| {
                let z = dot(s, &axis).clamp(-1.0, 1.0);
                basis(self.order, [(1.0 - z * z).sqrt(), 0.0, z], &mut about_z);
                zonal.iter().enumerate().map(|(l, value)| value * about_z[index(l, 0)]).sum()
            })
            .collect();
        self.project(&values)
    }

    /// The product matrix of `f`, by rows.
    pub(crate) fn matrix(&self, f: &[f64]) -> Vec<f64> {
        let size = coefficients(self.order);
        let mut out = vec![0.0; size * size];
        for ((row, weight), value) in self.rows().zip(&self.rule.weights).zip(self.values(f)) {
            for (y, out) in row.iter().zip(out.chunks_exact_mut(size)) {
                let factor = weight * value * y;
                out.iter_mut().zip(row).for_each(|(sum, y)| *sum += factor * y);
            }
        }
        out
    }

    /// The whole product series `1 + f + f*f/2 + …`, which is `e^M 1` of the product matrix: Taylor steps of length 1 at
    /// most, the mean apart.
    pub(crate) fn exp(&self, f: &[f64]) -> Vec<f64> {
        let mut residual = f.to_vec();
        let mean = std::mem::take(&mut residual[0]) / SQRT_4_PI;
        let matrix = self.matrix(&residual);
        let steps = norm(&matrix).ceil().max(1.0);
        let mut value = vec![0.0; f.len()];
        value[0] = SQRT_4_PI;
        for _ in 0..steps as usize {
            let mut term = value.clone();
            for k in 1..=24 {
                term = times(&matrix, &term, 1.0 / (steps * f64::from(k)));
                value.iter_mut().zip(&term).for_each(|(sum, t)| *sum += t);
            }
        }
        value.iter().map(|v| mean.exp() * v).collect()
    }

    /// The logarithm that inverts the truncated exponential (Ren 2006, eq. 30), `q'(M)(g - 1)` with
    /// `q'(x) = log x/(x - 1) = ∫₀¹ dt/(1 + t(x - 1))`, by quadrature in t and a linear system at each node. All eigenvalues
    /// must lie well within 0.02 and 50.
    pub(crate) fn log(&self, g: &[f64]) -> Vec<f64> {
        let size = g.len();
        let mut right = g.to_vec();
        right[0] -= SQRT_4_PI;
        let matrix = self.matrix(g);
        let (nodes, weights) = gauss_legendre(96);
        let mut out = vec![0.0; size];
        for (node, weight) in nodes.iter().zip(weights) {
            let t = 0.5 * (node + 1.0);
            let mut system: Vec<f64> = matrix.iter().map(|entry| t * entry).collect();
            (0..size).for_each(|i| system[i * size + i] += 1.0 - t);
            let solved = solve(system, &right);
            out.iter_mut().zip(solved).for_each(|(sum, x)| *sum += 0.5 * weight * x);
        }
        out
    }
}

fn times(matrix: &[f64], v: &[f64], scale: f64) -> Vec<f64> {
    matrix.chunks_exact(v.len()).map(|row| scale * dot(row, v)).collect()
}

/// Solves a symmetric positive definite system by Cholesky's decomposition.
fn solve(mut a: Vec<f64>, b: &[f64]) -> Vec<f64> {
    let size = b.len();
    for j in 0..size {
        for k in 0..j {
            let factor = a[j * size + k];
            (j..size).for_each(|i| a[i * size + j] -= a[i * size + k] * factor);
        }
        let pivot = a[j * size + j].sqrt();
        (j..size).for_each(|i| a[i * size + j] /= pivot);
    }
    let mut x = b.to_vec();
    for i in 0..size {
        let known = dot(&a[i * size..i * size + i], &x[..i]);
        x[i] = (x[i] - known) / a[i * size + i];
    }
    for i in (0..size).rev() {
        let known: f64 = (i + 1..size).map(|k| a[k * size + i] * x[k]).sum();
        x[i] = (x[i] - known) / a[i * size + i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_is_orthonormal_and_has_the_textbook_values() {
        let oracle = Oracle::of_degree(MAX_ORDER, 14);
        let one = oracle.project(&vec![1.0; oracle.rule.weights.len()]);
        assert!((one[0] - SQRT_4_PI).abs() < 1e-13 && norm(&one[1..]) < 1e-13);
        let matrix = oracle.matrix(&one);
        for (i, entry) in matrix.iter().enumerate() {
            let unit = if i % 65 == 0 { 1.0 } else { 0.0 };
            assert!((entry - unit).abs() < 1e-13, "entry {i}: {entry}");
        }
        let mut y = vec![0.0; 16];
        let [a, b, c] = [0.48, 0.6, 0.64];
        basis(4, [a, b, c], &mut y);
        assert!((y[9] - 0.590_043_589_926_644 * b * (3.0 * a * a - b * b)).abs() < 1e-14);
        assert!((y[12] - 0.373_176_332_590_115 * c * (5.0 * c * c - 3.0)).abs() < 1e-14);
    }

    /// Of constants, and each of the other where products are not truncated: at order 1.
    #[test]
    fn exponential_and_logarithm_have_their_closed_forms() {
        for order in [1, 3, 8] {
            let oracle = Oracle::new(order);
            let constant = |value: f64| {
                let mut v = vec![0.0; order * order];
                v[0] = value * SQRT_4_PI;
                v
            };
            let off = |got: Vec<f64>, want: f64| got.iter().zip(constant(want)).all(|(x, y)| (x - y).abs() < 1e-12);
            assert!(off(oracle.exp(&constant(-1.5)), (-1.5f64).exp()));
            assert!(off(oracle.log(&constant(0.3)), 0.3f64.ln()));
        }
    }

    #[test]
    fn systems_are_solved() {
        let x = solve(vec![4.0, 2.0, 0.0, 2.0, 5.0, 1.0, 0.0, 1.0, 3.0], &[8.0, 15.0, 11.0]);
        assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(x, want)| (x - want).abs() < 1e-14), "{x:?}");
    }
}
