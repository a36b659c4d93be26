//! Exact integration of polynomials over the sphere, and projection by it.

use std::f64::consts::PI;

use crate::basis::evaluate;
use crate::order::{assert_order, coefficients};

/// Directions and weights (which sum to 4π) of an integration rule over the sphere.
#[derive(Clone, Debug)]
pub struct Quadrature {
    /// Unit vectors.
    pub directions: Vec<[f64; 3]>,
    /// Solid angles, one a direction.
    pub weights: Vec<f64>,
}

impl Quadrature {
    /// Gauss–Legendre nodes in z times uniform azimuths: exact for polynomials in (x, y, z) up to `degree`.
    ///
    /// The integral of a product of harmonics has as degree the sum of their bands.
    pub fn exact(degree: usize) -> Self {
        let (nodes, node_weights) = gauss_legendre(degree / 2 + 1);
        let azimuths = degree + 1;
        let step = 2.0 * PI / azimuths as f64;
        let mut rule = Self { directions: Vec::new(), weights: Vec::new() };
        for (&z, &weight) in nodes.iter().zip(&node_weights) {
            let radius = (1.0 - z * z).sqrt();
            for k in 0..azimuths {
                // Half a step off the axes, so that no symmetric function is sampled on its symmetry planes only.
                let (sin, cos) = ((k as f64 + 0.5) * step).sin_cos();
                rule.directions.push([radius * cos, radius * sin, z]);
                rule.weights.push(weight * step);
            }
        }
        rule
    }

    /// The integral of `f` over the sphere.
    pub fn integrate(&self, mut f: impl FnMut([f64; 3]) -> f64) -> f64 {
        self.directions.iter().zip(&self.weights).map(|(&s, &w)| w * f(s)).sum()
    }
}

/// The `n` nodes (ascending) and weights of Gauss–Legendre quadrature on [-1, 1], exact to degree `2n - 1`.
pub fn gauss_legendre(n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut nodes = vec![0.0; n];
    let mut weights = vec![0.0; n];
    for i in 0..n {
        let mut x = -((i as f64 + 0.75) / (n as f64 + 0.5) * PI).cos();
        // Newton doubles the correct digits, and the starting value has two: five steps reach the last bit.
        for _ in 0..5 {
            let (value, slope) = legendre_with_slope(n, x);
            x -= value / slope;
        }
        let (_, slope) = legendre_with_slope(n, x);
        nodes[i] = x;
        weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
    }
    (nodes, weights)
}

/// The Legendre polynomial `P_n` and its derivative at `x` in (-1, 1).
fn legendre_with_slope(n: usize, x: f64) -> (f64, f64) {
    let (mut below, mut p) = (0.0, 1.0);
    for l in 1..=n {
        let l = l as f64;
        (below, p) = (p, ((2.0 * l - 1.0) * x * p - (l - 1.0) * below) / l);
    }
    (p, n as f64 * (below - x * p) / (1.0 - x * x))
}

/// The `n²` coefficients `∫ f y_i` (Ren 2006, eq. 1) of a function of direction, by the given rule.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`](crate::MAX_ORDER).
pub fn project(order: usize, quadrature: &Quadrature, mut f: impl FnMut([f64; 3]) -> f64) -> Vec<f64> {
    assert_order(order);
    let mut out = vec![0.0; coefficients(order)];
    let mut basis = out.clone();
    for (&direction, &weight) in quadrature.directions.iter().zip(&quadrature.weights) {
        evaluate(order, direction, &mut basis);
        let value = weight * f(direction);
        out.iter_mut().zip(&basis).for_each(|(sum, y)| *sum += value * y);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_gauss_nodes_are_the_printed_ones() {
        let (nodes, weights) = gauss_legendre(3);
        for (got, want) in
            nodes.iter().chain(&weights).zip([-0.6f64.sqrt(), 0.0, 0.6f64.sqrt(), 5. / 9., 8. / 9., 5. / 9.])
        {
            assert!((got - want).abs() < 1e-15);
        }
    }

    #[test]
    fn gauss_rules_integrate_monomials_to_their_degree() {
        for n in [1, 2, 7, 20, 64] {
            let (nodes, weights) = gauss_legendre(n);
            for degree in 0..2 * n {
                let sum: f64 = nodes.iter().zip(&weights).map(|(x, w)| w * x.powi(degree as i32)).sum();
                let want = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert!((sum - want).abs() < 1e-13, "n = {n}, x^{degree}: {sum} instead of {want}");
            }
        }
    }

    /// ∫ x^a y^b z^c dΩ = 2 Γ((a+1)/2) Γ((b+1)/2) Γ((c+1)/2) / Γ((a+b+c+3)/2) for even exponents, else 0.
    #[test]
    fn sphere_rules_integrate_monomials_to_their_degree() {
        fn double_factorial(n: i32) -> f64 {
            (1..=n).rev().step_by(2).map(f64::from).product()
        }
        let degree = 12;
        let rule = Quadrature::exact(degree as usize);
        for a in 0..=degree {
            for b in 0..=degree - a {
                for c in 0..=degree - a - b {
                    let want = if a % 2 + b % 2 + c % 2 > 0 {
                        0.0
                    } else {
                        4.0 * PI * double_factorial(a - 1) * double_factorial(b - 1) * double_factorial(c - 1)
                            / double_factorial(a + b + c + 1)
                    };
                    let got = rule.integrate(|[x, y, z]| x.powi(a) * y.powi(b) * z.powi(c));
                    assert!((got - want).abs() < 1e-13, "x^{a} y^{b} z^{c}: {got} instead of {want}");
                }
            }
        }
    }
}
