//! What the tests share: vectors, distances and strategies.

use halflight_sh::{Real, circle_log, circle_visibility, coefficients, irradiance_weights, rotate_zonal};
use proptest::prelude::*;

pub(crate) const SQRT_4_PI: f64 = 3.544_907_701_811_032;

pub(crate) fn norm<T: Real>(v: &[T]) -> f64 {
    v.iter().map(|x| x.to_f64().powi(2)).sum::<f64>().sqrt()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `‖a - b‖`.
pub(crate) fn distance<A: Real, B: Real>(a: &[A], b: &[B]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x.to_f64() - y.to_f64()).powi(2)).sum::<f64>().sqrt()
}

pub(crate) fn convert<T: Real>(v: &[f64]) -> Vec<T> {
    v.iter().map(|&x| T::from_f64(x)).collect()
}

pub(crate) fn constant<T: Real>(order: usize, value: f64) -> Vec<T> {
    let mut v = vec![T::ZERO; coefficients(order)];
    v[0] = T::from_f64(value * SQRT_4_PI);
    v
}

/// The vectors of a circle of `degrees` about `axis`: visibility and log.
pub(crate) fn circle(order: usize, degrees: f64, axis: [f64; 3]) -> Blocker {
    let mut zonal = vec![0.0; order];
    let (mut g, mut f) = (constant(order, 0.0), constant(order, 0.0));
    let cos = degrees.to_radians().cos();
    circle_visibility(order, cos, &mut zonal);
    rotate_zonal(order, &zonal, axis, &mut g);
    circle_log(order, cos, &mut zonal);
    rotate_zonal(order, &zonal, axis, &mut f);
    (g, f)
}

/// The irradiance fraction `H(z)·g`.
pub(crate) fn irradiance(order: usize, g: &[f64]) -> f64 {
    let mut weights = constant(order, 0.0);
    irradiance_weights(order, [0.0, 0.0, 1.0], &mut weights);
    dot(&weights, g)
}

pub(crate) fn unit_vector() -> impl Strategy<Value = [f64; 3]> {
    (-1.0f64..=1.0, 0.0..std::f64::consts::TAU).prop_map(|(z, phi)| {
        let radius = (1.0 - z * z).sqrt();
        [radius * phi.cos(), radius * phi.sin(), z]
    })
}

/// An order and `count` vectors with coefficients in [-1, 1].
pub(crate) fn vectors(count: usize) -> impl Strategy<Value = (usize, Vec<Vec<f64>>)> {
    (1usize..=8).prop_flat_map(move |order| {
        let vector = proptest::collection::vec(-1.0f64..1.0, coefficients(order));
        (Just(order), proptest::collection::vec(vector, count))
    })
}

/// Visibility and log of one blocker.
pub(crate) type Blocker = (Vec<f64>, Vec<f64>);

/// An order and the visibilities and logs of up to 12 random circles.
pub(crate) fn blockers() -> impl Strategy<Value = (usize, Vec<Blocker>)> {
    (1usize..=8).prop_flat_map(|order| {
        let one = (0.0f64..90.0, unit_vector()).prop_map(move |(degrees, axis)| circle(order, degrees, axis));
        (Just(order), proptest::collection::vec(one, 1..12))
    })
}

/// The sum of vectors.
pub(crate) fn sum<'a>(order: usize, vectors: impl IntoIterator<Item = &'a Vec<f64>>) -> Vec<f64> {
    let mut total = constant(order, 0.0);
    for v in vectors {
        total.iter_mut().zip(v).for_each(|(t, x)| *t += x);
    }
    total
}

pub(crate) fn scaled(v: &[f64], factor: f64) -> Vec<f64> {
    v.iter().map(|x| factor * x).collect()
}
