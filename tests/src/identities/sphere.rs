//! Exact integration over the sphere.

use std::f64::consts::PI;

/// Directions with weights that integrate polynomials up to a degree exactly.
#[derive(Clone, Debug)]
pub struct Sphere {
    /// Unit vectors and solid angles.
    pub points: Vec<([f64; 3], f64)>,
}

impl Sphere {
    /// Gauss–Legendre nodes in z times uniform azimuths.
    pub fn exact(degree: usize) -> Self {
        let (rings, azimuths) = (degree / 2 + 1, degree + 1);
        let mut points = Vec::new();
        for k in 0..rings {
            let (z, weight) = node(rings, k);
            let radius = (1.0 - z * z).sqrt();
            for j in 0..azimuths {
                let phi = 2.0 * PI * (j as f64 + 0.3) / azimuths as f64;
                points.push(([radius * phi.cos(), radius * phi.sin(), z], weight * 2.0 * PI / azimuths as f64));
            }
        }
        Self { points }
    }
}

/// The `k`-th of `n` Gauss–Legendre nodes with its weight, by Newton's method.
fn node(n: usize, k: usize) -> (f64, f64) {
    let mut z = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
    let mut slope = 0.0;
    for _ in 0..8 {
        let (mut below, mut p) = (0.0, 1.0);
        for l in 0..n {
            let l = l as f64;
            (below, p) = (p, ((2.0 * l + 1.0) * z * p - l * below) / (l + 1.0));
        }
        slope = n as f64 * (below - z * p) / (1.0 - z * z);
        z -= p / slope;
    }
    (z, 2.0 / ((1.0 - z * z) * slope * slope))
}
