//! The lights of a scene as derived data.

use std::borrow::Cow;

use glam::Mat3;
use halflight_contract::{Derived, Job, Meter, Result};
use halflight_scenes::{DistantLight, Light, Scene, Turn};
use halflight_sh::{Rotation, coefficients};

use crate::project;

/// Radiance in SH.
#[derive(Clone, Debug, PartialEq)]
pub struct ShLight {
    /// SH order.
    pub order: usize,
    /// `order²` coefficients of radiance for red, green and blue.
    pub rgb: [Vec<f32>; 3],
}

/// The distant lights of a scene in SH.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLight {
    /// The sum of those that rest.
    pub still: ShLight,
    /// Those that turn, as they are at second 0.
    pub turning: Vec<(ShLight, Turn)>,
}

impl SceneLight {
    /// The sum of all lights at a time in seconds.
    pub fn at(&self, time: f32) -> Cow<'_, ShLight> {
        if self.turning.is_empty() {
            return Cow::Borrowed(&self.still);
        }
        let mut sum = self.still.clone();
        for (light, turn) in &self.turning {
            let matrix = Mat3::from_quat(turn.at(time)).as_dmat3();
            let rotation = Rotation::new(sum.order, [0, 1, 2].map(|row| matrix.row(row).to_array()));
            let mut turned = vec![0.0; coefficients(sum.order)];
            for (sum, channel) in sum.rgb.iter_mut().zip(&light.rgb) {
                rotation.apply(channel, &mut turned);
                sum.iter_mut().zip(&turned).for_each(|(sum, value)| *sum += value);
            }
        }
        Cow::Owned(sum)
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        (1 + self.turning.len()) * 3 * coefficients(self.still.order) * size_of::<f32>()
    }
}

/// Recipe for the [`SceneLight`] of a scene.
#[derive(Clone, Copy, Debug)]
pub struct LightOf {
    /// SH order, 1 to 8.
    pub order: usize,
}

impl Derived for LightOf {
    type Value = SceneLight;
    const NAME: &'static str = "sh-light";
    const REVISION: &'static str = "2";

    fn key(&self, scene: &Scene) -> String {
        let lights: Vec<String> = scene.lights.iter().map(|light| light.content().to_string()).collect();
        format!("{}:{}", self.order, lights.join("+"))
    }

    fn make(&self, job: &Job<'_, '_>, _: &mut dyn Meter) -> Result<SceneLight> {
        Ok(self.together(&job.scene.lights))
    }
}

/// Recipe for each light of a scene by itself, in the scene's order.
#[derive(Clone, Copy, Debug)]
pub struct EachLightOf {
    /// SH order, 1 to 8.
    pub order: usize,
}

impl Derived for EachLightOf {
    type Value = Vec<SceneLight>;
    const NAME: &'static str = "sh-lights";
    const REVISION: &'static str = LightOf::REVISION;

    fn key(&self, scene: &Scene) -> String {
        LightOf { order: self.order }.key(scene)
    }

    fn make(&self, job: &Job<'_, '_>, _: &mut dyn Meter) -> Result<Vec<SceneLight>> {
        let of = LightOf { order: self.order };
        Ok(job.scene.lights.iter().map(|light| of.together(std::slice::from_ref(light))).collect())
    }
}

impl LightOf {
    fn together(&self, lights: &[DistantLight]) -> SceneLight {
        let still = self.sum(lights.iter().filter(|light| light.turn.is_none()).map(|light| &light.rest));
        let turning = lights.iter().filter_map(|light| Some((self.sum([&light.rest].into_iter()), light.turn?)));
        SceneLight { still, turning: turning.collect() }
    }

    fn sum<'l>(&self, lights: impl Iterator<Item = &'l Light>) -> ShLight {
        let mut sum = [0; 3].map(|_| vec![0.0; coefficients(self.order)]);
        for light in lights {
            for (sum, channel) in sum.iter_mut().zip(project(light, self.order)) {
                sum.iter_mut().zip(channel).for_each(|(sum, value)| *sum += value);
            }
        }
        ShLight { order: self.order, rgb: sum.map(|channel| channel.iter().map(|v| *v as f32).collect()) }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use halflight_contract::{Backend, Cache, NoMeter, Params};

    use super::*;

    /// What turns in SH is what turns, in SH.
    #[test]
    fn lights_turn_in_sh_as_they_do_in_space() {
        let lights = "sky = { uniform = [1, 2, 3] }\n[[lights]]\nkey = { direction = [1, 2, 0.5], angular_radius = 20, radiance = [3, 2, 1] }\n\
             turn = { axis = [1, 1, 3], degrees_a_second = 40 }\n[[lights]]\n\
             key = { direction = [1, 0, 0.5], angular_radius = 10, radiance = [1, 2, 1] }\nturn = { degrees_a_second = -70 }\n";
        let scene = scene_of(lights);
        for order in [1, 3, 6] {
            let cache = Cache::default();
            let params = Params::default();
            let job = Job::new(&scene, &params, 0, Backend::Cpu, &cache);
            let light = LightOf { order }.make(&job, &mut NoMeter).expect("made");
            assert_eq!(light.turning.len(), 2);
            for time in [0.0, 1.7, 33.0] {
                let now: Vec<Light> = scene.lights.iter().map(|light| light.at(time)).collect();
                let want = LightOf { order }.sum(now.iter());
                for (got, want) in light.at(time).rgb.iter().zip(&want.rgb) {
                    assert!(got.iter().zip(want).all(|(got, want)| (got - want).abs() < 2e-5), "{got:?} {want:?}");
                }
            }
        }
    }

    fn scene(light: &str) -> Scene {
        scene_of(&format!("sky = {{ {light} }}\n"))
    }

    fn scene_of(lights: &str) -> Scene {
        let text = format!(
            "purpose = 'test'\n[receivers]\ngrid = {{ center = [0, 0, 0], size = [1, 1], resolution = [1, 1] }}\n\
             [[objects]]\nname = 'ball'\nsphere = {{ center = [0, 0, 1], radius = 0.5 }}\nalbedo = [1, 1, 1]\n\
             [[lights]]\n{lights}"
        );
        Scene::parse(Path::new("test.toml"), &text).expect("a scene")
    }

    #[test]
    fn the_key_holds_the_order_and_all_that_the_lights_emit() {
        let white = scene("uniform = [1, 1, 1]");
        let key = |order, scene: &Scene| LightOf { order }.key(scene);
        assert_eq!(key(4, &white), key(4, &white.clone()));
        assert_ne!(key(4, &white), key(5, &white));
        assert_ne!(key(4, &white), key(4, &scene("uniform = [1, 1, 0.5]")));
        assert_ne!(key(4, &white), key(4, &scene("overcast = [1, 1, 1]")));
    }
}
