//! The light that arrives at every receiver, and where to look for it.

use halflight_light::ShLight;
use halflight_scenes::{Light, Rgb, Sky};
use halflight_sh::coefficients;

use glam::Vec3;

use crate::sampling::{EnvironmentSampler, KeySampler};

/// What a reference takes for the light.
pub(crate) enum Emission {
    /// The scene's lights.
    Lights(Lights),
    /// Their reconstruction from spherical harmonics: one `order²` vector a channel.
    Harmonics(std::sync::Arc<ShLight>),
}

impl Emission {
    /// Radiance from a direction, and the density a steradian with which [`Emission::direction`] finds it.
    pub(crate) fn look(&self, direction: Vec3) -> (Rgb, f32) {
        match self {
            Emission::Lights(lights) => lights.look(direction),
            Emission::Harmonics(light) => (reconstruct(light, direction), 0.0),
        }
    }

    /// A direction in proportion to the lights that can be sampled.
    pub(crate) fn direction(&self, point: [f32; 2]) -> Vec3 {
        match self {
            Emission::Lights(lights) => lights.direction(point),
            Emission::Harmonics(_) => unreachable!("nothing to sample by, as `strategies` says"),
        }
    }

    /// Whether the cosine lobe and whether the lights are to be sampled. Key lights alone need no cosine lobe; what is smooth
    /// over the sphere needs nothing else.
    pub(crate) fn strategies(&self) -> [bool; 2] {
        match self {
            Emission::Lights(lights) => {
                let peaked = lights.total > 0.0;
                [!peaked || !lights.skies.is_empty() || !lights.environments.is_empty(), peaked]
            }
            Emission::Harmonics(_) => [true, false],
        }
    }
}

/// All lights of a scene.
pub(crate) struct Lights {
    environments: Vec<EnvironmentSampler>,
    keys: Vec<KeySampler>,
    /// Lights that are smooth over the sphere.
    skies: Vec<Light>,
    /// Their mean radiance over the sphere and the channels.
    sky_level: f64,
    /// Share of the power of each environment, then of each key light.
    shares: Vec<f32>,
    /// Power of all environments and key lights.
    total: f64,
}

impl Lights {
    pub(crate) fn new(lights: &[Light]) -> Self {
        let (mut environments, mut keys, mut skies, mut sky_level) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
        for light in lights {
            match light {
                Light::Environment(map) => environments.push(EnvironmentSampler::new(map)),
                Light::Key(key) => keys.push(KeySampler::new(key)),
                Light::Sky(sky) => {
                    sky_level += mean_radiance(sky);
                    skies.push(light.clone());
                }
            }
        }
        let powers: Vec<f64> =
            environments.iter().map(|e| e.power()).chain(keys.iter().map(KeySampler::power)).collect();
        let total: f64 = powers.iter().sum();
        let shares = powers.iter().map(|power| if total > 0.0 { (power / total) as f32 } else { 0.0 }).collect();
        Lights { environments, keys, skies, sky_level, shares, total }
    }

    /// `1/4π ∫ L dω`, mean of the channels.
    pub(crate) fn level(&self) -> f64 {
        let environments: f64 = self.environments.iter().map(EnvironmentSampler::mean_power).sum();
        let keys: f64 = self.keys.iter().map(KeySampler::mean_power).sum();
        (environments + keys) / (4.0 * std::f64::consts::PI) + self.sky_level
    }

    fn look(&self, direction: Vec3) -> (Rgb, f32) {
        let mut radiance: Rgb = self.skies.iter().map(|sky| sky.radiance(direction)).sum();
        let mut density = 0.0;
        let (environment_shares, key_shares) = self.shares.split_at(self.environments.len());
        for (environment, share) in self.environments.iter().zip(environment_shares) {
            let (seen, texel_density) = environment.look(direction);
            radiance += seen;
            density += share * texel_density;
        }
        for (key, share) in self.keys.iter().zip(key_shares).filter(|(key, _)| key.light.contains(direction)) {
            radiance += key.light.radiance;
            density += share / key.solid_angle();
        }
        (radiance, density)
    }

    fn direction(&self, [u, v]: [f32; 2]) -> Vec3 {
        // The first coordinate chooses the light; what is left of it is uniform again.
        let mut rest = u;
        let last = self.shares.len() - 1;
        for (i, share) in self.shares.iter().enumerate() {
            if rest < *share || i == last {
                let point = [(rest / share).clamp(f32::EPSILON, 1.0 - f32::EPSILON), v];
                return match self.environments.get(i) {
                    Some(environment) => environment.direction(point),
                    None => self.keys[i - self.environments.len()].direction(point),
                };
            }
            rest -= share;
        }
        unreachable!("the last light takes what is left")
    }
}

/// Mean over the sphere and the channels.
fn mean_radiance(sky: &Sky) -> f64 {
    match sky {
        Sky::Uniform(radiance) => f64::from(radiance.element_sum()) / 3.0,
        Sky::Overcast(zenith) => f64::from(zenith.element_sum()) / 9.0,
    }
}

fn reconstruct(light: &ShLight, direction: Vec3) -> Rgb {
    let mut basis = [0.0; coefficients(halflight_sh::MAX_ORDER)];
    let basis = &mut basis[..coefficients(light.order)];
    halflight_sh::evaluate(light.order, direction.to_array(), basis);
    Rgb::from_array(light.rgb.each_ref().map(|channel| channel.iter().zip(&*basis).map(|(c, y)| c * y).sum()))
}
