//! Latitude–longitude maps in spherical harmonics.

use std::f64::consts::{PI, TAU};

use halflight_scenes::Environment;
use halflight_sh::{coefficients, evaluate, gauss_legendre, index};

/// Nodes a row in polar angle. The integrands are trigonometric polynomials of degree 8 at most: a row of a quarter turn or
/// less is integrated to 1e-14, the one row of a map without any other to 1e-9.
const NODES: usize = 16;

/// `∫ L(s) y_i(s) ds` for each colour channel; exact for the piecewise constant map.
pub(crate) fn project(map: &Environment, order: usize) -> [Vec<f64>; 3] {
    let azimuth = azimuth_weights(map, order);
    let (nodes, weights) = gauss_legendre(NODES);
    let mut result = [0; 3].map(|_| vec![0.0; coefficients(order)]);
    for row in 0..map.height {
        let height = height_integrals(map, row, order, &nodes, &weights);
        let texels = &map.texels[row * map.width..(row + 1) * map.width];
        for m in -(order as isize - 1)..order as isize {
            let slot = (m + order as isize - 1) as usize;
            let mut ring = [0.0; 3];
            for (texel, weight) in texels.iter().zip(&azimuth[slot]) {
                ring.iter_mut().zip(texel.to_array()).for_each(|(sum, value)| *sum += weight * f64::from(value));
            }
            for l in m.unsigned_abs()..order {
                let share = height[index(l, m.abs())];
                result.iter_mut().zip(ring).for_each(|(out, sum)| out[index(l, m)] += share * sum);
            }
        }
    }
    result
}

/// For each `m = 1−order..order−1` and each column, `∫ cos mφ dφ` (m ≥ 0) or `∫ sin |m|φ dφ` over the texel.
fn azimuth_weights(map: &Environment, order: usize) -> Vec<Vec<f64>> {
    let step = TAU / map.width as f64;
    let left = |column: usize| f64::from(map.rotation) + step * column as f64;
    let integral = |m: isize, a: f64, b: f64| {
        let k = m.unsigned_abs() as f64;
        match m {
            0 => b - a,
            1.. => ((k * b).sin() - (k * a).sin()) / k,
            _ => ((k * a).cos() - (k * b).cos()) / k,
        }
    };
    (1 - order as isize..order as isize)
        .map(|m| (0..map.width).map(|column| integral(m, left(column), left(column) + step)).collect())
        .collect()
}

/// For each `(l, m ≥ 0)`, the integral over the row's polar angles of the basis function at azimuth 0.
fn height_integrals(map: &Environment, row: usize, order: usize, nodes: &[f64], weights: &[f64]) -> Vec<f64> {
    let half = 0.5 * PI / map.height as f64;
    let middle = half * (2 * row + 1) as f64;
    let mut basis = vec![0.0; coefficients(order)];
    let mut sum = vec![0.0; coefficients(order)];
    for (node, weight) in nodes.iter().zip(weights) {
        let (sin, cos) = (middle + half * node).sin_cos();
        evaluate(order, [sin, 0.0, cos], &mut basis);
        let scale = half * weight * sin;
        sum.iter_mut().zip(&basis).for_each(|(sum, value)| *sum += scale * value);
    }
    sum
}
