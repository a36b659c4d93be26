//! Points and directions to sample: low-discrepancy points, and maps from the unit square to directions with known densities.

#[cfg(test)]
mod chi_squared;
mod cone;
mod cosine;
mod environment;
mod key;
mod random;
mod sobol;
mod sphere;
mod triangle;

pub(crate) use cosine::CosineLobe;
pub(crate) use environment::EnvironmentSampler;
pub(crate) use key::KeySampler;
pub(crate) use random::mix;
pub(crate) use sobol::Sobol;
pub(crate) use sphere::SphereSampler;
pub(crate) use triangle::TriangleSampler;

/// Rec. 709 luminance, in `f64` for sums over maps.
pub(crate) fn luminance(radiance: halflight_scenes::Rgb) -> f64 {
    f64::from(radiance.dot(glam::Vec3::new(0.2126, 0.7152, 0.0722)))
}
