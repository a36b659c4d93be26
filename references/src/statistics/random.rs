//! Random numbers for tests.

use crate::sampling::mix;

/// Uniform in `(0, 1)`.
pub(crate) fn uniforms(seed: u64) -> impl Iterator<Item = f64> {
    (0..).map(move |i| ((mix(mix(0xd1ce, seed), i) >> 12) as f64 + 0.5) * 2f64.powi(-52))
}

/// Standard normal, by the method of Box and Muller.
pub(crate) fn normals(seed: u64) -> impl Iterator<Item = f64> {
    let (u, v) = (uniforms(2 * seed), uniforms(2 * seed + 1));
    u.zip(v).map(|(u, v)| (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos())
}
