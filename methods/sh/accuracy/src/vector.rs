//! Small vector algebra in `f64`, and conversion to the precision under test.

use halflight_sh::Real;

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(crate) fn norm(v: &[f64]) -> f64 {
    let largest = v.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    largest * v.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}

pub(crate) fn scaled(v: &[f64], factor: f64) -> Vec<f64> {
    v.iter().map(|x| factor * x).collect()
}

pub(crate) fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x + y).collect()
}

/// `‖got - want‖`; NaN or infinity where `got` has any.
pub(crate) fn distance<T: Real>(got: &[T], want: &[f64]) -> f64 {
    assert_eq!(got.len(), want.len(), "vectors of the same order");
    if got.iter().any(|x| !x.is_finite()) {
        return f64::INFINITY;
    }
    norm(&got.iter().zip(want).map(|(x, y)| x.to_f64() - y).collect::<Vec<_>>())
}

pub(crate) fn convert<T: Real>(v: &[f64]) -> Vec<T> {
    v.iter().map(|&x| T::from_f64(x)).collect()
}

pub(crate) fn widen<T: Real>(v: &[T]) -> Vec<f64> {
    v.iter().map(|x| x.to_f64()).collect()
}

/// The nearest vector of the precision under test.
pub(crate) fn rounded<T: Real>(v: &[f64]) -> Vec<f64> {
    widen(&convert::<T>(v))
}
