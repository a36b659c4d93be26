//! What operations are tried with: the same vectors in every run.

use std::f64::consts::{PI, TAU};

use halflight_sh::{Real, circle_log, circle_visibility, coefficients, irradiance_weights};

use crate::oracle::{SQRT_4_PI, basis};
use crate::vector::{norm, rounded, scaled, sum};

/// Cases of a class: eight groups of lanes.
pub(crate) const COUNT: usize = 128;

/// Vectors that are exponentiated: two groups.
const LOGS: usize = 32;

/// A kind of input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Normally distributed coefficients, unit directions, angles of every size.
    Random,
    /// Single lobes, cosine lobes, the mean alone, circles, at the axes and anywhere.
    Structured,
    /// Lengths from 1e-9 to 1e9, sums that cancel, one coefficient that outweighs the others, rotations by almost nothing
    /// and by almost half a turn.
    Adversarial,
}

impl Class {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Random, Self::Structured, Self::Adversarial];

    /// As tables print it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Structured => "structured",
            Self::Adversarial => "adversarial",
        }
    }
}

/// Numbers without pattern, SplitMix64: the same everywhere.
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.unit()).ln()).sqrt() * (TAU * self.unit()).cos()
    }

    pub(crate) fn direction(&mut self) -> [f64; 3] {
        let (z, phi) = (self.between(-1.0, 1.0), TAU * self.unit());
        let radius = (1.0 - z * z).sqrt();
        [radius * phi.cos(), radius * phi.sin(), z]
    }

    /// Of length 1.
    pub(crate) fn vector(&mut self, order: usize) -> Vec<f64> {
        let v: Vec<f64> = (0..coefficients(order)).map(|_| self.normal()).collect();
        scaled(&v, 1.0 / norm(&v))
    }
}

/// Axes for structured input: the coordinate axes first, then anywhere.
fn axis(numbers: &mut Numbers, k: usize) -> [f64; 3] {
    const AXES: [[f64; 3]; 5] = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8]];
    if k < 2 * AXES.len() { AXES[k % AXES.len()] } else { numbers.direction() }
}

/// The narrowest lobe of an order, of length 1.
fn lobe(order: usize, axis: [f64; 3]) -> Vec<f64> {
    let mut out = vec![0.0; coefficients(order)];
    basis(order, axis, &mut out);
    scaled(&out, 1.0 / norm(&out))
}

/// A zonal vector turned to an axis.
fn turned(order: usize, zonal: &[f64], axis: [f64; 3]) -> Vec<f64> {
    let mut out = vec![0.0; coefficients(order)];
    basis(order, axis, &mut out);
    for (l, value) in zonal.iter().enumerate() {
        let scale = value * (4.0 * PI / (2 * l + 1) as f64).sqrt();
        out[l * l..(l + 1) * (l + 1)].iter_mut().for_each(|y| *y *= scale);
    }
    out
}

/// The visibility beside one circle.
pub(crate) fn visibility(order: usize, angle: f64, axis: [f64; 3]) -> Vec<f64> {
    let mut zonal = vec![0.0; order];
    circle_visibility(order, angle.cos(), &mut zonal);
    turned(order, &zonal, axis)
}

/// The log of the visibility beside one circle.
pub(crate) fn log_visibility(order: usize, angle: f64, axis: [f64; 3]) -> Vec<f64> {
    let mut zonal = vec![0.0; order];
    circle_log(order, angle.cos(), &mut zonal);
    turned(order, &zonal, axis)
}

fn structured(order: usize, numbers: &mut Numbers, k: usize) -> Vec<f64> {
    let axis = axis(numbers, k / 4);
    match k % 4 {
        0 => lobe(order, axis),
        1 => {
            let mut out = vec![0.0; coefficients(order)];
            irradiance_weights(order, axis, &mut out);
            out
        }
        2 => visibility(order, numbers.between(0.0, PI), axis),
        _ => scaled(&lobe(1, axis).into_iter().chain(vec![0.0; coefficients(order) - 1]).collect::<Vec<_>>(), 3.0),
    }
}

fn adversarial(order: usize, numbers: &mut Numbers, k: usize) -> Vec<f64> {
    let length = 10f64.powf(numbers.between(-9.0, 9.0));
    let v = match k % 4 {
        0 => numbers.vector(order),
        1 => {
            // two lobes whose parts cancel almost
            let axis = numbers.direction();
            let beside = numbers.vector(order);
            let difference: Vec<f64> = lobe(order, axis).iter().zip(&beside).map(|(x, y)| x - 1e-4 * y).collect();
            sum(&difference, &scaled(&lobe(order, axis), -1.0))
        }
        2 => {
            let mut v = scaled(&numbers.vector(order), 1e-5);
            v[(numbers.unit() * coefficients(order) as f64) as usize] = 1.0;
            v
        }
        _ => {
            let mut v = lobe(order, axis(numbers, k / 4));
            v.iter_mut().enumerate().for_each(|(i, x)| *x *= if i.is_multiple_of(2) { 1.0 } else { -1.0 });
            v
        }
    };
    scaled(&v, length)
}

/// `COUNT` sets of `N` vectors, rounded to the precision under test. Every other set repeats one vector, which makes the
/// longest products.
pub(crate) fn vectors<T: Real, const N: usize>(order: usize, class: Class) -> Vec<[Vec<f64>; N]> {
    let mut numbers = Numbers::new(order as u64);
    (0..COUNT)
        .map(|k| {
            let mut one = |k: usize| {
                rounded::<T>(&match class {
                    Class::Random => scaled(&numbers.vector(order), 1.5),
                    Class::Structured => structured(order, &mut numbers, k),
                    Class::Adversarial => adversarial(order, &mut numbers, k),
                })
            };
            let first = one(k);
            std::array::from_fn(|n| if n == 0 || k.is_multiple_of(2) { first.clone() } else { one(k + 5 * n) })
        })
        .collect()
}

/// `COUNT` unit vectors, rounded to the precision under test.
pub(crate) fn directions<T: Real>(class: Class) -> Vec<[f64; 3]> {
    let mut numbers = Numbers::new(77);
    let mut one = |k: usize| match class {
        Class::Random => numbers.direction(),
        Class::Structured => axis(&mut numbers, k % 10),
        Class::Adversarial => {
            // almost an axis
            let [x, y, _] = numbers.direction();
            let tiny = 10f64.powf(numbers.between(-9.0, -3.0));
            let near = [tiny * x, tiny * y, (1.0 - tiny * tiny * (x * x + y * y)).sqrt()];
            let mut turned = near;
            turned.rotate_left(k % 3);
            turned
        }
    };
    (0..COUNT).map(|k| one(k).map(|x| T::from_f64(x).to_f64())).collect()
}

/// `COUNT` axes with angles.
pub(crate) fn rotations(class: Class) -> Vec<([f64; 3], f64)> {
    let mut numbers = Numbers::new(78);
    let mut one = |k: usize| match class {
        Class::Random => (numbers.direction(), numbers.between(-PI, PI)),
        Class::Structured => (axis(&mut numbers, k % 5), [PI, 0.5 * PI, -0.5 * PI, 0.0][k % 4]),
        Class::Adversarial => {
            let tiny = 10f64.powf(numbers.between(-12.0, -2.0));
            (axis(&mut numbers, k % 20), if k.is_multiple_of(2) { tiny } else { PI - tiny })
        }
    };
    (0..COUNT).map(&mut one).collect()
}

/// Vectors to be exponentiated, with bands above 0 of length 3 at most.
pub(crate) fn logs<T: Real>(order: usize, class: Class) -> Vec<Vec<f64>> {
    let mut numbers = Numbers::new(79);
    let limited = |f: Vec<f64>| {
        let length = norm(&f[1..]);
        if length > 3.0 { scaled(&f, 3.0 / length) } else { f }
    };
    let mut one = |k: usize| match class {
        Class::Random => {
            let length = numbers.between(0.05, 2.0);
            scaled(&numbers.vector(order), length)
        }
        Class::Structured => blockers(order, &mut numbers, 1 + k % 6),
        Class::Adversarial => {
            let (v, e) = (numbers.vector(order), numbers.between(-20.0, 0.4));
            match k % 4 {
                0 => scaled(&v, 10f64.powf(e)),
                // blockers that cancel almost
                1 => {
                    let f = blockers(order, &mut numbers, 2);
                    sum(&f, &scaled(&f, -0.999))
                }
                // the mean outweighs the rest
                2 => {
                    let mut f = v;
                    f[0] = SQRT_4_PI * numbers.between(-3.0, 2.0);
                    f
                }
                _ => scaled(&lobe(order, numbers.direction()), -2.0),
            }
        }
    };
    (0..LOGS).map(|k| rounded::<T>(&limited(one(k)))).collect()
}

/// The sum of the logs of `count` circles of up to 35°.
pub(crate) fn blockers(order: usize, numbers: &mut Numbers, count: usize) -> Vec<f64> {
    (0..count).fold(vec![0.0; coefficients(order)], |total, _| {
        let angle = numbers.between(2.0, 35.0).to_radians();
        sum(&total, &log_visibility(order, angle, numbers.direction()))
    })
}

/// Vectors to take the logarithm of, whose eigenvalues need no clip.
pub(crate) fn positives(order: usize, class: Class) -> Vec<Vec<f64>> {
    let mut numbers = Numbers::new(80);
    let mut one = |k: usize| match class {
        Class::Random | Class::Adversarial => {
            // no value beyond ±0.9
            let room = if class == Class::Random { 0.9 } else { 10f64.powf(numbers.between(-14.0, -1.0)) };
            let mut g = scaled(&numbers.vector(order), room * SQRT_4_PI / order as f64);
            g[0] += SQRT_4_PI;
            g
        }
        Class::Structured => {
            let widest = (170.0 / order as f64).min(80.0);
            visibility(order, numbers.between(1.0, widest).to_radians(), axis(&mut numbers, k))
        }
    };
    (0..LOGS).map(&mut one).collect()
}
