//! Exact projections of visibility wedges into spherical harmonics (Snyder and Nowrouzezahrai 2008, eqs. 6 to 8).
//!
//! A wedge is open above a horizon whose elevation `ω(φ)` changes linearly over the azimuths `0..Δ`, and blocked elsewhere. Over elevation,
//! `∫_ω^{π/2} y_lm(θ) cos θ dθ` is a trigonometric polynomial of ω of degree `l + 1`, and for odd `m` a linear term beside it. Over azimuth,
//! a sine or cosine of the linear ω times one of `mφ` integrates to sines and cosines again, so that the whole is closed form.

use std::f64::consts::{FRAC_PI_2, TAU};

use halflight_sh::{MAX_ORDER, evaluate, index};

/// Points of the discrete Fourier transform that finds the polynomials: exact for their degrees.
const POINTS: usize = 4 * MAX_ORDER;

/// What projects wedges of one extent to one order.
pub(crate) struct Projector {
    order: usize,
    /// Radians of azimuth.
    extent: f64,
    /// For each `(l, m ≥ 0)`, at `index(l, m)`: the antiderivative over elevation.
    elevation: Vec<Polynomial>,
    /// `E(mΔ)` and `E₁(mΔ)` for each `m`.
    still: Vec<[Complex; 2]>,
}

/// `constant + linear·ω + Σ_j (sine_j sin jω + cosine_j cos jω)`: the integral from ω up to the zenith.
#[derive(Clone, Copy, Default)]
struct Polynomial {
    constant: f64,
    linear: f64,
    sine: [f64; MAX_ORDER + 1],
    cosine: [f64; MAX_ORDER + 1],
}

/// Real and imaginary part.
type Complex = [f64; 2];

/// What wedges share over which the horizon rises by the same angle.
pub(crate) struct Ramp {
    rise: f64,
    /// `E(mΔ + j·rise)` and `E(mΔ − j·rise)` at `m·(n + 1) + j`.
    turns: Vec<[Complex; 2]>,
}

/// `∫₀¹ e^{ixu} du`.
fn mean_turn(x: f64) -> Complex {
    let half = 0.5 * x;
    let sinc = if half.abs() < 1e-8 { 1.0 } else { half.sin() / half };
    [half.cos() * sinc, half.sin() * sinc]
}

/// `∫₀¹ u e^{ixu} du`.
fn mean_ramped_turn(x: f64) -> Complex {
    if x.abs() < 0.1 {
        // Σ (ix)^k/(k!·(k + 2)); five terms of each parity leave 1e-17.
        let (mut term, mut sum) = (1.0, [0.0; 2]);
        for k in 0..10 {
            let sign = if k % 4 < 2 { 1.0 } else { -1.0 };
            sum[k % 2] += sign * term / (k + 2) as f64;
            term *= x / (k + 1) as f64;
        }
        return sum;
    }
    let (sin, cos) = x.sin_cos();
    [sin / x + (cos - 1.0) / (x * x), sin / (x * x) - cos / x]
}

/// The antiderivatives over elevation of an order.
fn polynomials(order: usize) -> Vec<Polynomial> {
    let mut found = vec![Polynomial::default(); order * order];
    let mut basis = vec![0.0; order * order];
    for point in 0..POINTS {
        let (sin, cos) = (TAU * point as f64 / POINTS as f64).sin_cos();
        evaluate(order, [cos, 0.0, sin], &mut basis);
        for (l, m) in (0..order).flat_map(|l| (0..=l).map(move |m| (l, m))) {
            let Polynomial { linear, sine, cosine, .. } = &mut found[index(l, m as isize)];
            let value = basis[index(l, m as isize)] * cos / POINTS as f64;
            *linear -= value;
            for j in 1..=l + 1 {
                let (sin, cos) = (TAU * (point * j) as f64 / POINTS as f64).sin_cos();
                sine[j] -= 2.0 * value * cos / j as f64;
                cosine[j] += 2.0 * value * sin / j as f64;
            }
        }
    }
    for polynomial in &mut found {
        polynomial.constant = -polynomial.at(FRAC_PI_2);
    }
    found
}

impl Polynomial {
    fn at(&self, angle: f64) -> f64 {
        let terms = (1..=MAX_ORDER).map(|j| {
            let (sin, cos) = (j as f64 * angle).sin_cos();
            self.sine[j] * sin + self.cosine[j] * cos
        });
        self.constant + self.linear * angle + terms.sum::<f64>()
    }
}

impl Projector {
    /// Wedges of an SH order over so many radians of azimuth.
    pub(crate) fn new(order: usize, extent: f64) -> Projector {
        let still = (0..order).map(|m| m as f64 * extent).map(|x| [mean_turn(x), mean_ramped_turn(x)]).collect();
        Projector { order, extent, elevation: polynomials(order), still }
    }

    /// What wedges share over which the horizon rises by so many radians.
    pub(crate) fn ramp(&self, rise: f64) -> Ramp {
        let turn = |m: usize, j: usize| {
            let (m, j) = (m as f64 * self.extent, j as f64 * rise);
            [mean_turn(m + j), mean_turn(m - j)]
        };
        let degrees = 0..=self.order;
        Ramp { rise, turns: (0..self.order).flat_map(|m| degrees.clone().map(move |j| turn(m, j))).collect() }
    }

    /// Writes the `n²` coefficients of a wedge that begins at azimuth 0 with the horizon at `from` radians.
    pub(crate) fn project(&self, from: f64, ramp: &Ramp, out: &mut [f64]) {
        let mut waves = [[0.0; 2]; MAX_ORDER + 1];
        waves.iter_mut().enumerate().for_each(|(j, wave)| *wave = (j as f64 * from).sin_cos().into());
        for m in 0..self.order {
            let [mean, ramped] = self.still[m];
            for l in m..self.order {
                let Polynomial { constant, linear, .. } = self.elevation[index(l, m as isize)];
                let part = |i: usize| constant * mean[i] + linear * (from * mean[i] + ramp.rise * ramped[i]);
                out[index(l, -(m as isize))] = self.extent * part(1);
                out[index(l, m as isize)] = self.extent * part(0); // last: for m = 0 both are the same coefficient
            }
            for j in 1..=self.order {
                self.add(m, j, waves[j], ramp.turns[m * (self.order + 1) + j], out);
            }
        }
    }

    /// Adds the terms in `jω`. Under a turn of the sphere by 180° and under reflection in the horizon `y_lm` is odd or even, so that cosines
    /// of ω come with odd `l − m` where `j + m` is even, sines with even `l − m` where it is odd, and no others.
    fn add(&self, m: usize, j: usize, [sin, cos]: [f64; 2], [plus, minus]: [Complex; 2], out: &mut [f64]) {
        let ahead = [cos * plus[0] - sin * plus[1], cos * plus[1] + sin * plus[0]];
        let back = [cos * minus[0] + sin * minus[1], cos * minus[1] - sin * minus[0]];
        let cosine = (j + m).is_multiple_of(2);
        let [real, imaginary] = match cosine {
            true => [ahead[0] + back[0], ahead[1] + back[1]],
            false => [ahead[1] - back[1], back[0] - ahead[0]],
        };
        for l in (m + usize::from(cosine)..self.order).step_by(2).filter(|l| l + 1 >= j) {
            let Polynomial { sine, cosine: cosines, .. } = &self.elevation[index(l, m as isize)];
            let weight = 0.5 * self.extent * if cosine { cosines[j] } else { sine[j] };
            out[index(l, m as isize)] += weight * real;
            if m > 0 {
                out[index(l, -(m as isize))] += weight * imaginary;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use halflight_sh::gauss_legendre;

    use super::*;

    /// Gauss–Legendre over azimuth and, from the horizon up, over elevation.
    fn quadrature(order: usize, extent: f64, [from, to]: [f64; 2]) -> Vec<f64> {
        let (nodes, weights) = gauss_legendre(40);
        let mut sum = vec![0.0; order * order];
        let mut basis = sum.clone();
        for (x, across) in nodes.iter().zip(&weights) {
            let u = 0.5 * (x + 1.0);
            let (azimuth, low) = (u * extent, from + u * (to - from));
            for (y, up) in nodes.iter().zip(&weights) {
                let elevation = low + 0.5 * (y + 1.0) * (FRAC_PI_2 - low);
                let (sin, cos) = elevation.sin_cos();
                evaluate(order, [cos * azimuth.cos(), cos * azimuth.sin(), sin], &mut basis);
                let area = 0.25 * across * up * extent * (FRAC_PI_2 - low) * cos;
                sum.iter_mut().zip(&basis).for_each(|(sum, y)| *sum += area * y);
            }
        }
        sum
    }

    #[test]
    fn wedges_are_their_quadrature() {
        for order in 1..=MAX_ORDER {
            for extent in [1e-4, 0.05, TAU / 16.0, 1.0, TAU / 3.0] {
                let projector = Projector::new(order, extent);
                let slopes = [[0.0, 0.0], [0.3, 0.3], [0.2, 0.9], [1.1, 0.1], [0.0, FRAC_PI_2], [FRAC_PI_2, 0.4]];
                // Removable singularities: the horizon rises as fast as the azimuth turns.
                for [from, to] in
                    slopes.into_iter().chain([[0.1, 0.1 + extent.min(1.0)], [0.5, 0.5 + 0.5 * extent.min(1.0)]])
                {
                    let mut found = vec![0.0; order * order];
                    projector.project(from, &projector.ramp(to - from), &mut found);
                    let expected = quadrature(order, extent, [from, to]);
                    for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
                        let error = (found - expected).abs();
                        assert!(error < 1e-13 * (1.0 + extent), "{order} {extent} {from} {to} {i}: {found} {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn series_and_closed_form_of_ramped_turns_meet() {
        for x in [-0.1, 0.1] {
            let closed = mean_ramped_turn(x * (1.0 + 1e-12));
            let series = mean_ramped_turn(x * (1.0 - 1e-12));
            assert!((closed[0] - series[0]).abs() < 1e-13 && (closed[1] - series[1]).abs() < 1e-13);
        }
    }
}
