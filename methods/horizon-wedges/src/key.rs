//! Key lights: the swath that covers one, and the light that it then needs.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use halflight_light::project;
use halflight_scenes::{KeyLight, Light, Rgb};
use halflight_sh::{Simd, apply_bands, coefficients, gamma, irradiance_weights};

use crate::sum::{Places, sum};
use crate::swath::{Swath, Wedge};
use crate::table::Wedges;

/// Most halvings of the full circle that a swath is narrowed by: 2.8°.
const NARROWEST: u32 = 7;

/// Rings of the sums over a light's disc, each of as many points.
const RINGS: usize = 64;

/// What the light within a swath is scaled to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    /// A level receiver gets through an open swath what it gets of the light.
    Ground,
    /// The receiver that gets most of what passes an open swath gets what a receiver that faces the light does (Snyder and Nowrouzezahrai
    /// 2008, caption of Fig. 6).
    Facing,
    /// What the spherical harmonics leave.
    Plain,
}

impl Level {
    pub(crate) const NAMES: &'static [&'static str] = &["facing", "ground", "plain"];

    pub(crate) fn named(name: &str) -> Level {
        match name {
            "ground" => Level::Ground,
            "plain" => Level::Plain,
            _ => Level::Facing,
        }
    }
}

/// Radians of azimuth over which a light extends: none if it reaches the zenith.
pub(crate) fn extent(key: &KeyLight) -> Option<f64> {
    let (direction, radius) = (key.direction.as_dvec3(), f64::from(key.angular_radius));
    let around = direction.truncate().length();
    let spread = radius.sin() / around;
    (spread < 1.0 && direction.z.atan2(around).abs() + radius < FRAC_PI_2).then(|| 2.0 * spread.asin())
}

/// The full circle halved so often.
fn halved(times: u32) -> f64 {
    TAU / f64::from(1u32 << times)
}

/// The smallest swath that covers a light, of a half, a quarter and so on of the full circle, so that lights share tables; `None` if that is
/// the full circle. `wanted`, in radians, takes its place where it is not 0.
pub(crate) fn swath(key: &KeyLight, wanted: f64, azimuths: usize) -> Option<Swath> {
    let covering = |extent| (1..=NARROWEST).rev().map(halved).find(|swath| *swath >= extent);
    let needed = extent(key)?;
    let extent = if wanted > 0.0 { wanted } else { covering(needed)? };
    let direction = key.direction.as_dvec3();
    Some(Swath::partial(direction.y.atan2(direction.x), extent, azimuths))
}

/// Irradiance over π at a receiver from the part of a light of radiance 1 above the horizon, nothing in its way.
pub(crate) fn irradiance(key: &KeyLight, normal: DVec3) -> f64 {
    let axis = key.direction.as_dvec3();
    let (x, y) = axis.any_orthonormal_pair();
    let step = f64::from(key.angular_radius) / RINGS as f64;
    let rings = (0..RINGS).map(|ring| {
        let low = ring as f64 * step;
        // The ring's solid angle, at the angle that halves it.
        let area = TAU * (low.cos() - (low + step).cos());
        let cos = 0.5 * (low.cos() + (low + step).cos());
        let sin = (1.0 - cos * cos).sqrt();
        let seen = (0..RINGS).map(|point| {
            let (up, across) = (TAU * (point as f64 + 0.5) / RINGS as f64).sin_cos();
            let towards = cos * axis + sin * (across * x + up * y);
            if towards.z > 0.0 { towards.dot(normal).max(0.0) } else { 0.0 }
        });
        area * seen.sum::<f64>() / RINGS as f64
    });
    rings.sum::<f64>() / PI
}

/// A swath with nothing in it, and how bands of light and of visibility are attenuated.
pub(crate) struct Opening<'a> {
    pub(crate) tables: &'a Wedges,
    pub(crate) wedges: &'a [Wedge],
    pub(crate) light_window: Option<&'a [f32]>,
    pub(crate) visibility_window: Option<&'a [f32]>,
}

/// The coefficients of a light's radiance, each colour, attenuated, scaled for what passes a swath.
pub(crate) fn light(key: &KeyLight, level: Level, opening: &Opening<'_>) -> [Vec<f32>; 3] {
    let order = opening.tables.order;
    let [mut shape, ..] = project(&Light::Key(KeyLight { radiance: Rgb::ONE, ..*key }), order);
    attenuate(opening.light_window, &mut shape);
    let (facing, through) = (key.direction.as_dvec3(), opening.passed(&shape));
    let scale = match level {
        Level::Plain => 1.0,
        Level::Facing => ratio(irradiance(key, facing), brightest(order, &through, facing)),
        Level::Ground => ratio(irradiance(key, DVec3::Z), at(order, &through, DVec3::Z)),
    };
    key.radiance
        .to_array()
        .map(|radiance| shape.iter().map(|value| (f64::from(radiance) * scale * value) as f32).collect())
}

fn attenuate(window: Option<&[f32]>, vector: &mut [f64]) {
    if let Some(window) = window {
        let window: Vec<f64> = window.iter().map(|factor| f64::from(*factor)).collect();
        apply_bands(&window, vector);
    }
}

/// None of the light where a swath lets none through.
fn ratio(wanted: f64, found: f64) -> f64 {
    if found > 1e-9 * wanted { wanted / found } else { 0.0 }
}

impl Opening<'_> {
    /// The light that passes: the product with visibility.
    fn passed(&self, light: &[f64]) -> Vec<f64> {
        let Opening { tables, wedges, .. } = *self;
        let azimuths = wedges.iter().map(|wedge| wedge.start + 1).max().unwrap_or(0);
        let mut open = vec![0.0; coefficients(tables.order)];
        let mut places = Places::default();
        places.set(Simd::Portable, 1, &vec![0.0; azimuths], wedges);
        sum(Simd::Portable, tables, wedges, &places, &mut open);
        let mut open: Vec<f64> = open.into_iter().map(f64::from).collect();
        attenuate(self.visibility_window, &mut open);
        let mut product = vec![0.0; open.len()];
        gamma(tables.order).product(light, &open, &mut product);
        product
    }
}

/// Irradiance over π at a receiver with a normal.
fn at(order: usize, light: &[f64], normal: DVec3) -> f64 {
    let mut weights = vec![0.0; coefficients(order)];
    irradiance_weights(order, normal.to_array(), &mut weights);
    weights.iter().zip(light).map(|(weight, light)| weight * light).sum()
}

/// The most irradiance that a normal gets in the vertical plane through the light, which halves the swath.
fn brightest(order: usize, light: &[f64], facing: DVec3) -> f64 {
    let ahead = DVec3::new(facing.x, facing.y, 0.0).normalize_or(DVec3::X);
    let turned = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        at(order, light, cos * ahead + sin * DVec3::Z)
    };
    let best = (0..360).map(f64::from).max_by(|a, b| turned(*a).total_cmp(&turned(*b))).unwrap_or(0.0);
    // The top of the parabola through three neighbours.
    let [before, here, after] = [-1.0, 0.0, 1.0].map(|step| turned(best + step));
    let bend = before - 2.0 * here + after;
    if bend < 0.0 { here - 0.125 * (after - before) * (after - before) / bend } else { here }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of all normals the one that gets most through an open swath gets what faces the light, windows or not.
    #[test]
    fn what_gets_most_gets_what_faces_the_light() {
        let order = 4;
        let direction = glam::Vec3::new(0.5, 0.4, 0.3).normalize();
        let key = KeyLight { direction, angular_radius: 0.05, radiance: Rgb::ONE };
        for window in [None, Some(&[1.0, 0.8, 0.5, 0.3][..])] {
            for extent in [20.0f64, 90.0] {
                let swath = swath(&key, extent.to_radians(), 3).expect("a partial one");
                let (tables, wedges) = (Wedges::new(order, swath.step), swath.wedges(order));
                let opening =
                    Opening { tables: &tables, wedges: &wedges, light_window: window, visibility_window: window };
                let [light, ..] = light(&key, Level::Facing, &opening);
                let passed = opening.passed(&light.iter().map(|value| f64::from(*value)).collect::<Vec<_>>());
                let most = (0..180 * 360).map(|i| {
                    let [(up, level), (y, x)] =
                        [f64::from(i / 360) - 90.0, f64::from(i % 360)].map(|degrees| degrees.to_radians().sin_cos());
                    at(order, &passed, DVec3::new(level * x, level * y, up))
                });
                let most = most.fold(0.0, f64::max);
                let expected = 0.05f64.sin().powi(2);
                assert!((most / expected - 1.0).abs() < 1e-3, "{extent}: {most} for {expected}");
            }
        }
    }
}
