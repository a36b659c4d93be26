//! Light that a model brings, a picture, or a sky where there is neither.
//!
//! Photometric units are taken as they are: a lux is a unit of irradiance, a candela one of radiant intensity. A light without
//! extent gets some, its irradiance or intensity kept: `E = π L sin²α` for a disc of angular radius α from afar,
//! `I = π r² L` for a ball of radius r.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::model::Model;
use super::view::Bounds;
use super::{Import, digits, text};
use crate::SceneError;
use crate::assets::{Assets, Punctual, Shines, extras};

/// Of a directional light whose file does not say, in degrees.
const ANGULAR_RADIUS: f32 = 1.0;
/// Of a point light whose file does not say, in units of the models' size.
const RADIUS: f64 = 0.01;
/// Such a ball is as large as it needs to be to stay below this radiance.
const BRIGHTEST: f64 = 1e8;

/// What goes into the scene file.
#[derive(Default)]
pub(super) struct Lights {
    /// Objects that emit.
    pub(super) lamps: String,
    pub(super) lights: String,
    /// Pictures, and their paths in the scene's folder.
    pub(super) pictures: Vec<(PathBuf, String)>,
    pub(super) told: Vec<String>,
}

impl Lights {
    pub(super) fn of(
        models: &[Model],
        picture: Option<&Path>,
        bounds: &Bounds,
        request: &Import,
    ) -> Result<Self, SceneError> {
        let mut all = Lights::default();
        match picture {
            Some(picture) => {
                let name = picture.file_name().unwrap_or_default().to_string_lossy().into_owned();
                all.environment(picture, &name, 0.0)?;
            }
            None => all.afar(models)?,
        }
        let mut lamps = 0;
        for model in models {
            for light in &model.survey.lights {
                let intensity = light.intensity * f64::from(request.light_scale);
                match light.shines {
                    Shines::From(direction) => all.key(direction, intensity, light),
                    Shines::At(point) => {
                        lamps += 1;
                        let point = super::upright(point) * f64::from(model.unit);
                        all.lamp(lamps, point, intensity, radius(light, model, bounds, intensity));
                    }
                }
            }
        }
        Ok(all)
    }

    /// Light from all around that the models' files bring, or a sky where nothing else gives light from anywhere.
    fn afar(&mut self, models: &[Model]) -> Result<(), SceneError> {
        let brought = models.iter().filter_map(|model| Some((model, model.survey.scene.as_ref()?)));
        let mut complete = false;
        for (model, scene) in brought {
            complete = true;
            for light in &scene.lights {
                match light {
                    extras::Afar::Uniform(radiance) => self.sky("uniform", *radiance),
                    extras::Afar::Overcast(zenith) => self.sky("overcast", *zenith),
                    extras::Afar::Environment { file, rotate } => {
                        let beside = Assets::beside(&model.path).read("extras", file, None)?.path;
                        self.environment(&beside, file, *rotate)?;
                    }
                }
            }
        }
        if !complete && models.iter().all(|model| model.survey.lights.is_empty()) {
            self.told.push("light: an overcast sky, since neither a picture nor a model brings any".into());
            self.sky("overcast", [1.0; 3]);
        }
        Ok(())
    }

    fn sky(&mut self, kind: &str, radiance: [f32; 3]) {
        self.lights += &format!("\n[[lights]]\nsky = {{ {kind} = {radiance:?} }}\n");
    }

    fn environment(&mut self, picture: &Path, name: &str, rotate: f32) -> Result<(), SceneError> {
        let file = picture.file_name().unwrap_or_default().to_string_lossy();
        let asset = Assets::beside(picture).read("picture", &file, None)?;
        let turned = if rotate == 0.0 { String::new() } else { format!(", rotate = {rotate:?}") };
        self.lights += &format!(
            "\n[[lights]]\nenvironment = {{ file = {}, sha256 = \"{}\"{turned} }}\n",
            text::string(name),
            asset.content()
        );
        self.pictures.push((picture.to_owned(), name.to_owned()));
        self.told.push(format!("light: {name}, its upper edge up; `rotate` in the scene turns it about the vertical"));
        Ok(())
    }

    fn key(&mut self, direction: DVec3, lux: DVec3, light: &Punctual) {
        let radius = light.extras.angular_radius.filter(|radius| *radius > 0.0 && *radius <= 90.0);
        let (radius, by) = radius.map_or((ANGULAR_RADIUS, "a guess"), |radius| (radius, "of the file"));
        let radius = digits::number(f64::from(radius));
        let radiance = lux / (PI * f64::from(radius.to_radians()).sin().powi(2));
        let lux = digits::vector(lux);
        self.lights += &format!(
            "\n[[lights]] # directional, {lux:?} lux; its angular radius is {by}\n\
             key = {{ direction = {:?}, angular_radius = {radius:?}, radiance = {:?} }}\n",
            digits::direction(super::upright(direction)),
            digits::vector(radiance)
        );
        self.told.push(format!("light: from afar, {lux:?} lux, given an angular radius of {radius} degrees"));
    }

    fn lamp(&mut self, number: usize, center: DVec3, candela: DVec3, radius: f32) {
        let radiance = candela / (PI * f64::from(radius).powi(2));
        let candela = digits::vector(candela);
        self.lamps += &format!(
            "\n[[objects]] # a point light of {candela:?} candela as a ball, which stands in nobody's way\n\
             name = \"lamp.{number}\"\nsphere = {{ center = {:?}, radius = {radius:?} }}\nalbedo = [0.5, 0.5, 0.5]\n\
             emission = {:?}\ncasts = false\n",
            center.as_vec3().to_array(),
            digits::vector(radiance)
        );
        self.told.push(format!("light: lamp.{number}, {candela:?} candela, a ball of radius {radius} m"));
    }
}

fn radius(light: &Punctual, model: &Model, bounds: &Bounds, candela: DVec3) -> f32 {
    match light.extras.radius.filter(|radius| *radius > 0.0) {
        Some(radius) => radius * model.unit,
        None => {
            let least = (candela.max_element() / (PI * BRIGHTEST)).sqrt();
            digits::number((RADIUS * bounds.size()).max(least))
        }
    }
}
