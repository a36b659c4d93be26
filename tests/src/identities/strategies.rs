//! Cases: what proptest strategies the identities are tried with, for tests of your own.

use proptest::collection::vec;
use proptest::prelude::*;

use super::Matrix;

/// Unit vectors, the poles and axes among them.
pub fn direction() -> impl Strategy<Value = [f64; 3]> + Clone {
    let anywhere = (-1.0f64..=1.0, 0.0..std::f64::consts::TAU).prop_map(|(z, phi)| {
        let radius = (1.0 - z * z).max(0.0).sqrt();
        [radius * phi.cos(), radius * phi.sin(), z]
    });
    let axis =
        prop_oneof![Just([0.0, 0.0, 1.0]), Just([0.0, 0.0, -1.0]), Just([1.0, 0.0, 0.0]), Just([0.0, -1.0, 0.0])];
    prop_oneof![4 => anywhere, 1 => axis]
}

/// Vectors of an order with coefficients from -1 to 1, some of them 0.
pub fn vector(order: usize) -> impl Strategy<Value = Vec<f64>> + Clone {
    vec(prop_oneof![4 => -1.0f64..1.0, 1 => Just(0.0)], order * order)
}

/// Rotations by angles of every size, tiny ones as likely as large ones.
pub fn rotation() -> impl Strategy<Value = Matrix> + Clone {
    let angle = prop_oneof![-4.0f64..4.0, (-12.0f64..0.0).prop_map(|e| 10f64.powf(e)), Just(std::f64::consts::PI)];
    (direction(), angle).prop_map(|([x, y, z], angle)| {
        let (s, c) = angle.sin_cos();
        let d = 1.0 - c;
        [
            [c + d * x * x, d * x * y - s * z, d * x * z + s * y],
            [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
            [d * x * z - s * y, d * y * z + s * x, c + d * z * z],
        ]
    })
}
