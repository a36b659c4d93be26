//! The paper's lamps: `H(N) * L` tabulated over a circle's radius and its angle to the normal, each vector fitted by one lobe
//! (Ren 2006, §7, "Analytic Lights").

use std::f32::consts::{FRAC_1_PI, FRAC_2_PI};
use std::f64::consts::PI;

use halflight_sh::{apply_bands, circle_visibility, clamped_cosine, coefficients, evaluate, gamma, rotate_zonal};

/// Entries over the circle's angular radius, 0 to π/2.
pub(crate) const ANGLES: usize = 33;

/// Entries over the angle between the circle's middle and the normal, 0 to π.
pub(crate) const TILTS: usize = 65;

/// The least sine that is tabulated: what is divided by its square has met its limit there.
const LEAST: f64 = 1e-3;

/// The table at an order.
#[derive(Clone, Debug)]
pub(crate) struct Lobes {
    order: usize,
    /// By radius, then tilt: the angle from the normal to the lobe's axis, towards the lamp, then the lobe's zonal coefficients, all
    /// over the squared sine.
    entries: Vec<f32>,
}

impl Lobes {
    /// Fits lobes to lamps of radiance 1 whose bands are scaled by `window`.
    pub(crate) fn new(order: usize, window: &[f32]) -> Lobes {
        let entry = |i: usize| {
            let sine = (0.5 * PI * (i / TILTS) as f64 / (ANGLES - 1) as f64).sin().max(LEAST);
            let (angle, zonal) = fit(order, &lit(order, window, sine, tilt(i % TILTS)));
            let scaled = zonal.into_iter().map(move |value| (value / (sine * sine)) as f32);
            std::iter::once(angle as f32).chain(scaled)
        };
        Lobes { order, entries: (0..ANGLES * TILTS).flat_map(entry).collect() }
    }

    /// Writes the zonal coefficients of the lobe for a circle by its sine and the cosine of its tilt, and returns the angle from the
    /// normal to the lobe's axis.
    pub(crate) fn lookup(&self, sine: f32, cosine: f32, zonal: &mut [f32]) -> f32 {
        let (row, down) = place(sine.min(1.0).asin() * FRAC_2_PI, ANGLES);
        let (column, across) = place(cosine.clamp(-1.0, 1.0).acos() * FRAC_1_PI, TILTS);
        let entry = |row: usize, column: usize| &self.entries[(row * TILTS + column) * (self.order + 1)..];
        let corners = [entry(row, column), entry(row, column + 1), entry(row + 1, column), entry(row + 1, column + 1)];
        let weights = [(1.0 - down) * (1.0 - across), (1.0 - down) * across, down * (1.0 - across), down * across];
        let at = |k: usize| corners.iter().zip(weights).map(|(corner, weight)| corner[k] * weight).sum::<f32>();
        zonal.iter_mut().enumerate().for_each(|(band, value)| *value = sine * sine * at(band + 1));
        at(0)
    }

    /// The table: by radius, then tilt, the angle of the axis and the zonal coefficients.
    #[cfg(feature = "gpu")]
    pub(crate) fn entries(&self) -> &[f32] {
        &self.entries
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }
}

/// The entry below a share of the range, and how far it is to the next.
fn place(share: f32, entries: usize) -> (usize, f32) {
    let at = share.clamp(0.0, 1.0) * (entries - 1) as f32;
    let below = (at as usize).min(entries - 2);
    (below, at - below as f32)
}

fn tilt(column: usize) -> f64 {
    PI * column as f64 / (TILTS - 1) as f64
}

/// A direction so far from z in the plane of x and z.
fn towards(angle: f64) -> [f64; 3] {
    [angle.sin(), 0.0, angle.cos()]
}

/// `H(z) * L`, the product truncated.
fn lit(order: usize, window: &[f32], sine: f64, tilt: f64) -> Vec<f64> {
    let [mut cosine, mut light, mut product] = [0; 3].map(|_| vec![0.0; coefficients(order)]);
    let mut zonal = vec![0.0; order];
    circle_visibility(order, (1.0 - sine * sine).sqrt(), &mut zonal);
    zonal[0] -= (4.0 * PI).sqrt();
    zonal.iter_mut().for_each(|value| *value = -*value);
    rotate_zonal(order, &zonal, towards(tilt), &mut light);
    let window: Vec<f64> = window.iter().map(|factor| f64::from(*factor)).collect();
    apply_bands(&window, &mut light);
    rotate_zonal(order, clamped_cosine(order), [0.0, 0.0, 1.0], &mut cosine);
    gamma(order).product(&cosine, &light, &mut product);
    product
}

/// The lobe nearest to a vector that is even in y: the angle of its axis from z towards x, and its zonal coefficients. About a given
/// axis each band's best coefficient is its projection. The lobe points where the vector does: of two axes that are opposite, bands up
/// to 1 cannot tell which.
fn fit(order: usize, vector: &[f64]) -> (f64, Vec<f64>) {
    let kept = |angle: &f64| {
        let zonal = about(order, vector, *angle);
        let forwards = zonal.get(1).is_none_or(|value| *value >= 0.0);
        if forwards { zonal.iter().map(|value| value * value).sum::<f64>() } else { 0.0 }
    };
    let (mut best, mut step) = (0.5 * PI, PI / 90.0);
    let mut reach = 45;
    while step > 1e-4 {
        let around = (-reach..=reach).map(|k| (best + f64::from(k) * step).clamp(0.0, PI));
        best = around.max_by(|a, b| kept(a).total_cmp(&kept(b))).unwrap_or(best);
        (step, reach) = (0.1 * step, 10);
    }
    (best, about(order, vector, best))
}

/// The zonal coefficients about an axis.
fn about(order: usize, vector: &[f64], angle: f64) -> Vec<f64> {
    let mut basis = vec![0.0; coefficients(order)];
    evaluate(order, towards(angle), &mut basis);
    let band = |l: usize| {
        let along: f64 = (l * l..(l + 1) * (l + 1)).map(|i| vector[i] * basis[i]).sum();
        along * (4.0 * PI / (2 * l + 1) as f64).sqrt()
    };
    (0..order).map(band).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn norm(values: impl Iterator<Item = f64>) -> f64 {
        values.map(|value| value * value).sum::<f64>().sqrt()
    }

    fn expand(order: usize, zonal: &[f64], angle: f64) -> Vec<f64> {
        let mut out = vec![0.0; coefficients(order)];
        rotate_zonal(order, zonal, towards(angle), &mut out);
        out
    }

    #[test]
    fn a_lobe_is_found_again() {
        for order in 2..=8 {
            let zonal: Vec<f64> = (0..order).map(|l| 1.0 / (1.0 + l as f64)).collect();
            for angle in [0.0, 0.3, 1.2, 2.9, PI] {
                let (found, values) = fit(order, &expand(order, &zonal, angle));
                assert!((found - angle).abs() < 1e-3, "order {order}: {found} for {angle}");
                assert!(norm(values.iter().zip(&zonal).map(|(a, b)| a - b)) < 1e-4);
            }
        }
    }

    /// What one lobe cannot say, of the longest vector of a row; small where the lamp faces the receiver, and nothing where it is
    /// overhead.
    #[test]
    fn lobes_miss_little_of_lamps() {
        let order = 4;
        for sine in [0.05, 0.3, 0.8] {
            let vectors: Vec<_> = (0..=12).map(|i| lit(order, &[1.0; 4], sine, PI * f64::from(i) / 12.0)).collect();
            let longest = vectors.iter().map(|v| norm(v.iter().copied())).fold(0.0, f64::max);
            let missed = vectors.iter().map(|vector| {
                let (angle, zonal) = fit(order, vector);
                norm(expand(order, &zonal, angle).iter().zip(vector).map(|(a, b)| a - b)) / longest
            });
            let missed: Vec<f64> = missed.collect();
            assert!(missed[0] < 1e-12 && missed.iter().all(|m| *m < 0.3), "{sine}: {missed:.3?}");
        }
    }

    #[test]
    fn entries_and_what_lies_between_are_near_fits() {
        for order in [2, 4, 8] {
            let window = vec![1.0; order];
            let lobes = Lobes::new(order, &window);
            let mut zonal = vec![0.0; order];
            for (sine, tilt) in [(0.25f64, PI / 4.0), (0.26, 0.8), (0.5, 0.02), (0.013, 1.0), (0.99, 0.6)] {
                let angle = lobes.lookup(sine as f32, tilt.cos() as f32, &mut zonal);
                let found = expand(order, &zonal.iter().map(|v| f64::from(*v)).collect::<Vec<_>>(), f64::from(angle));
                let vector = lit(order, &window, sine, tilt);
                let (angle, zonal) = fit(order, &vector);
                let want = expand(order, &zonal, angle);
                let error = norm(found.iter().zip(&want).map(|(a, b)| a - b)) / norm(vector.iter().copied());
                assert!(error < 0.01, "order {order}, sine {sine}, tilt {tilt}: {error}");
            }
        }
    }
}
