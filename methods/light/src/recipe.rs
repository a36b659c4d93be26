//! The lights of a scene as derived data.

use halflight_contract::{Derived, Job, Meter, Result};
use halflight_scenes::Scene;
use halflight_sh::coefficients;

use crate::project;

/// The sum of a scene's distant lights in SH.
#[derive(Clone, Debug, PartialEq)]
pub struct ShLight {
    /// SH order.
    pub order: usize,
    /// `order²` coefficients of radiance for red, green and blue.
    pub rgb: [Vec<f32>; 3],
}

/// Recipe for the [`ShLight`] of a scene.
#[derive(Clone, Copy, Debug)]
pub struct LightOf {
    /// SH order, 1 to 8.
    pub order: usize,
}

impl Derived for LightOf {
    type Value = ShLight;
    const NAME: &'static str = "sh-light";
    const REVISION: &'static str = "1";

    fn key(&self, scene: &Scene) -> String {
        let lights: Vec<String> = scene.lights.iter().map(|light| light.content().to_string()).collect();
        format!("{}:{}", self.order, lights.join("+"))
    }

    fn make(&self, job: &Job<'_, '_>, _: &mut dyn Meter) -> Result<ShLight> {
        let mut sum = [0; 3].map(|_| vec![0.0; coefficients(self.order)]);
        for light in &job.scene.lights {
            for (sum, channel) in sum.iter_mut().zip(project(light, self.order)) {
                sum.iter_mut().zip(channel).for_each(|(sum, value)| *sum += value);
            }
        }
        Ok(ShLight { order: self.order, rgb: sum.map(|channel| channel.iter().map(|v| *v as f32).collect()) })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn scene(light: &str) -> Scene {
        let text = format!(
            "purpose = 'test'\n[receivers]\ngrid = {{ center = [0, 0, 0], size = [1, 1], resolution = [1, 1] }}\n\
             [[objects]]\nname = 'ball'\nsphere = {{ center = [0, 0, 1], radius = 0.5 }}\nalbedo = [1, 1, 1]\n\
             [[lights]]\nsky = {{ {light} }}\n"
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
