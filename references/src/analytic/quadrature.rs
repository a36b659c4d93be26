//! Quadrature that closed forms are tested against.

use std::f64::consts::PI;

/// Midpoint rule under `t = a + (b − a)(3s² − 2s³)`, which removes square-root behaviour at the ends.
pub(crate) fn smooth_ends(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let n = 4000;
    let step = |i: usize| (i as f64 + 0.5) / f64::from(n as u32);
    (0..n)
        .map(|i| {
            let s = step(i);
            f(a + (b - a) * s * s * (3.0 - 2.0 * s)) * (b - a) * 6.0 * s * (1.0 - s) / f64::from(n as u32)
        })
        .sum()
}

/// Gauss–Legendre quadrature with so many nodes.
pub(crate) fn gauss(nodes: usize, a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    legendre(nodes).iter().map(|(x, weight)| half * weight * f(middle + half * x)).sum()
}

/// Nodes and weights on `[−1, 1]`: roots of Legendre's polynomial, by Newton's method.
pub(crate) fn legendre(nodes: usize) -> Vec<(f64, f64)> {
    let root = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (nodes as f64 + 0.5)).cos();
        loop {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=nodes {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            let slope = nodes as f64 * (x * value - before) / (x * x - 1.0);
            let step = value / slope;
            x -= step;
            if step.abs() < 1e-14 {
                return (x, 2.0 / ((1.0 - x * x) * slope * slope));
            }
        }
    };
    (0..nodes).map(root).collect()
}

#[test]
fn gauss_is_exact_for_its_degree() {
    for nodes in [2, 5, 12, 48] {
        let degree = 2 * nodes as i32 - 1;
        let integral = gauss(nodes, 0.0, 2.0, |x| (x - 0.5).powi(degree - 1));
        let expected = (1.5f64.powi(degree) + 0.5f64.powi(degree)) / f64::from(degree);
        assert!((integral / expected - 1.0).abs() < 1e-12, "{nodes}: {integral} for {expected}");
    }
}
