//! Circles in lanes: zonal visibility and log visibility by angular radius.

use std::sync::OnceLock;

use halflight_sh_kernels::{Block, LANES, Lanes, Real, Task, run};

use super::Batch;
use crate::circle::{circle_log, log_kinks};
use crate::order::MAX_ORDER;
use crate::pieces::{Pieces, of_precision};
use crate::small::Small;

/// The fitted logs of an order.
#[derive(Debug)]
struct Fit<T> {
    /// Circles up to an angle, by `sin²θ`: most of what receivers see.
    small: Small<T>,
    /// All others, by `1 − cos θ`, between the kinks.
    large: Pieces<T>,
}

fn logs<T: Real>(order: usize) -> &'static Fit<T> {
    static FITS: [OnceLock<(Fit<f32>, Fit<f64>)>; MAX_ORDER] = [const { OnceLock::new() }; MAX_ORDER];
    let (single, double) = FITS[order - 1].get_or_init(|| (fit(order), fit(order)));
    of_precision(single, double)
}

fn fit<T: Real>(order: usize) -> Fit<T> {
    let log = |height: f64, out: &mut [f64]| circle_log(order, 1.0 - height, out);
    let kinks = log_kinks(order);
    let rise = |square: f64| square / (1.0 + (1.0 - square).sqrt());
    let most = kinks.first().map_or(1.0, |&height| height * (2.0 - height));
    let small = Small::<T>::fit(order, most, |square, out| log(rise(square), out));
    let breaks = [&[rise(small.end().to_f64())], kinks, &[1.0]].concat();
    Fit { small, large: Pieces::fit(order, &breaks, |_| 1.0, log) }
}

/// Up to which `sin²θ` a circle is small, and the fits' coefficients one after the other.
pub(crate) fn circle_log_fits(order: usize) -> (f32, Vec<f32>) {
    let (fit, mut table) = (logs::<f32>(order), Vec::new());
    fit.small.print(&mut table);
    fit.large.print(&mut table);
    (fit.small.end(), table)
}

struct Logs<'a, T> {
    order: usize,
    sines: &'a [Block<T>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for Logs<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        let fit = logs::<T>(self.order);
        let end = V::splat(fit.small.end());
        for (sines, out) in self.sines.iter().zip(self.out.chunks_exact_mut(self.order)) {
            for part in 0..LANES / V::WIDTH {
                let sine = V::load(&sines.0, part).max(V::constant(0.0)).min(V::constant(1.0));
                let square = sine.mul(sine);
                fit.small.lookup(square, |band, value| value.store(&mut out[band].0, part));
                if end.any_less(square) {
                    fit.large.lookup(height(sine), |band, value| {
                        let small = V::load(&out[band].0, part);
                        end.where_less(square, value, small).store(&mut out[band].0, part);
                    });
                }
            }
        }
    }
}

/// `1 - cos θ` from `sin θ`, clamped to [0, 1].
#[inline(always)]
fn height<V: Lanes>(sine: V) -> V {
    let one = V::constant(1.0);
    let sine = sine.max(V::constant(0.0)).min(one);
    let cosine = sine.neg_mul_add(sine, one).max(V::constant(0.0)).sqrt();
    sine.mul(sine).div(one.add(cosine))
}

struct Visibilities<'a, T> {
    order: usize,
    sines: &'a [Block<T>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for Visibilities<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for (sines, out) in self.sines.iter().zip(self.out.chunks_exact_mut(self.order)) {
            for part in 0..LANES / V::WIDTH {
                let cosine = V::constant(1.0).sub(height(V::load(&sines.0, part)));
                zonal_visibility(cosine, |band, value| value.store(&mut out[band].0, part), self.order);
            }
        }
    }
}

/// The recurrence of [`circle_visibility`](crate::circle_visibility).
#[inline(always)]
fn zonal_visibility<V: Lanes>(cosine: V, mut out: impl FnMut(usize, V), order: usize) {
    let pi = std::f64::consts::PI;
    out(0, V::constant(pi.sqrt()).mul(V::constant(1.0).add(cosine)));
    let (mut below, mut p) = (V::constant(1.0), cosine);
    for l in 1..order {
        let width = (2 * l + 1) as f64;
        let risen = V::constant(width / (l + 1) as f64).mul(cosine).mul(p);
        let above = below.neg_mul_add(V::constant(l as f64 / (l + 1) as f64), risen);
        out(l, V::constant((pi / width).sqrt()).mul(above.sub(below)));
        (below, p) = (p, above);
    }
}

struct Lights<'a, T> {
    order: usize,
    sines: &'a [Block<T>],
    out: &'a mut [Block<T>],
}

impl<T: Real> Task<T> for Lights<'_, T> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = T>>(self) {
        for (sines, out) in self.sines.iter().zip(self.out.chunks_exact_mut(self.order)) {
            for part in 0..LANES / V::WIDTH {
                zonal_light(V::load(&sines.0, part), |band, value| value.store(&mut out[band].0, part), self.order);
            }
        }
    }
}

/// `∫ y_l0` over a circle about z, `√(π/(2l+1))·(P_(l−1) − P_(l+1))` at its rim; the difference is `(2l+1)/(l(l+1))·sin²θ·P_l'`, which loses
/// no digits where the circle is small.
#[inline(always)]
fn zonal_light<V: Lanes>(sine: V, mut out: impl FnMut(usize, V), order: usize) {
    let pi = std::f64::consts::PI;
    let one = V::constant(1.0);
    let height = height(sine);
    let cosine = one.sub(height);
    let square = height.mul(one.add(cosine));
    out(0, V::constant(pi.sqrt()).mul(height));
    let (mut below, mut p) = (one, cosine);
    let (mut slope_below, mut slope) = (V::constant(0.0), one);
    for l in 1..order {
        let (width, next) = ((2 * l + 1) as f64, (l + 1) as f64);
        out(l, V::constant((pi * width).sqrt() / (l as f64 * next)).mul(square).mul(slope));
        let slope_above = V::constant(width).mul_add(p, slope_below);
        let risen = V::constant(width / next).mul(cosine).mul(p);
        let above = below.neg_mul_add(V::constant(l as f64 / next), risen);
        (below, p, slope_below, slope) = (p, above, slope, slope_above);
    }
}

impl Batch {
    /// The zonal coefficients of lights of radiance 1 inside circles about z and 0 elsewhere, as [`Batch::circle_logs`] takes and writes
    /// them; exact to rounding, relative to each coefficient's bound `√((2l+1)/4π)` times the solid angle, for the smallest circles too.
    ///
    /// # Panics
    /// If `out` does not hold `n` blocks for each of `sines`.
    pub fn circle_lights<T: Real>(&self, sines: &[Block<T>], out: &mut [Block<T>]) {
        assert_eq!(out.len(), self.order * sines.len(), "{} zonal values a circle", self.order);
        run(self.simd, Lights { order: self.order, sines, out });
    }

    /// The zonal log visibilities (see [`circle_log`]) of circles given by the sine of their angular radius, `n` blocks for
    /// each block of sines. Sines are clamped to [0, 1]; 0 gives 0, which blocks
    /// nothing, exactly.
    ///
    /// Small circles by one polynomial, others from 16 pieces of degree 7, split where the clip makes kinks, with no gather. Coefficients
    /// err by at most 2e-6 (order 7: 5e-6, order 8, which has most kinks: 1e-4) of the circle's largest one, or of 1.
    ///
    /// # Panics
    /// If `out` does not hold `n` blocks for each of `sines`.
    pub fn circle_logs<T: Real>(&self, sines: &[Block<T>], out: &mut [Block<T>]) {
        assert_eq!(out.len(), self.order * sines.len(), "{} zonal values a circle", self.order);
        run(self.simd, Logs { order: self.order, sines, out });
    }

    /// The zonal visibilities of circles (see [`circle_visibility`](crate::circle_visibility)), as [`Batch::circle_logs`]
    /// takes and writes them; exact to rounding.
    ///
    /// # Panics
    /// If `out` does not hold `n` blocks for each of `sines`.
    pub fn circle_visibilities<T: Real>(&self, sines: &[Block<T>], out: &mut [Block<T>]) {
        assert_eq!(out.len(), self.order * sines.len(), "{} zonal values a circle", self.order);
        run(self.simd, Visibilities { order: self.order, sines, out });
    }
}
