//! Lights of a scene file.

use std::sync::Arc;

use glam::Vec2;

use crate::assets::Assets;
use crate::check::Checker;
use crate::format::{EnvironmentFile, KeyLightFile, LightFile, SkyFile, TurnFile};
use crate::{DistantLight, Environment, KeyLight, Light, Rgb, SceneError, Sky, Turn};

pub(super) fn load(
    check: Checker,
    assets: &Assets,
    files: &[LightFile],
    notices: &mut Vec<String>,
) -> Result<Vec<DistantLight>, SceneError> {
    let distant = |(index, file): (usize, &LightFile)| {
        let field = format!("lights[{index}]");
        let rest = light(check, assets, &field, file, notices)?;
        let turn = file.turn.as_ref().map(|file| turn(check, &format!("{field}.turn"), file, &rest)).transpose()?;
        Ok(DistantLight { rest, turn })
    };
    files.iter().enumerate().map(distant).collect()
}

fn turn(check: Checker, field: &str, file: &TurnFile, light: &Light) -> Result<Turn, SceneError> {
    let axis = check.direction(&format!("{field}.axis"), file.axis)?;
    let speed = check.number(&format!("{field}.degrees_a_second"), file.degrees_a_second)?.to_radians();
    match light {
        Light::Environment(_) => {
            let upright = axis.truncate() == Vec2::ZERO;
            check.ensure(upright, &format!("{field}.axis"), "a vertical axis for an environment", axis)?;
        }
        Light::Sky(_) => return Err(check.invalid(field, "beside an environment or a key light", "a sky's")),
        Light::Key(_) => {}
    }
    Ok(Turn { axis, speed })
}

fn light(
    check: Checker,
    assets: &Assets,
    field: &str,
    file: &LightFile,
    notices: &mut Vec<String>,
) -> Result<Light, SceneError> {
    match (&file.environment, &file.sky, &file.key) {
        (Some(file), None, None) => environment(check, assets, &format!("{field}.environment"), file, notices),
        (None, Some(file), None) => sky(check, &format!("{field}.sky"), file),
        (None, None, Some(file)) => key(check, &format!("{field}.key"), file),
        (environment, sky, key) => {
            let given = [("environment", environment.is_some()), ("sky", sky.is_some()), ("key", key.is_some())];
            Err(check.not_one(field, &given))
        }
    }
}

fn environment(
    check: Checker,
    assets: &Assets,
    field: &str,
    file: &EnvironmentFile,
    notices: &mut Vec<String>,
) -> Result<Light, SceneError> {
    let scale = check.positive(&format!("{field}.scale"), file.scale)?;
    let rotation = check.number(&format!("{field}.rotate"), file.rotate)?.to_radians();
    let image = assets.read(field, &file.file, file.sha256.as_deref())?.image(notices)?;
    // A photograph runs clockwise seen from above, azimuth the other way round.
    let mirrored = image.texels.chunks_exact(image.width).flat_map(|row| row.iter().rev());
    let texels: Vec<Rgb> = mirrored.map(|texel| *texel * scale).collect();
    let brightest = texels.iter().fold(0.0, |most: f32, texel| most.max(texel.max_element()));
    check.number(&format!("{field}.scale: brightest texel"), brightest)?;
    Ok(Light::Environment(Environment { width: image.width, height: image.height, texels: Arc::new(texels), rotation }))
}

fn sky(check: Checker, field: &str, file: &SkyFile) -> Result<Light, SceneError> {
    match (file.uniform, file.overcast) {
        (Some(radiance), None) => Ok(Light::Sky(Sky::Uniform(check.radiance(&format!("{field}.uniform"), radiance)?))),
        (None, Some(zenith)) => Ok(Light::Sky(Sky::Overcast(check.radiance(&format!("{field}.overcast"), zenith)?))),
        (uniform, overcast) => {
            Err(check.not_one(field, &[("uniform", uniform.is_some()), ("overcast", overcast.is_some())]))
        }
    }
}

fn key(check: Checker, field: &str, file: &KeyLightFile) -> Result<Light, SceneError> {
    let radius = file.angular_radius;
    let within = radius > 0.0 && radius <= 90.0;
    check.ensure(within, &format!("{field}.angular_radius"), "degrees above 0 and at most 90", radius)?;
    Ok(Light::Key(KeyLight {
        direction: check.direction(&format!("{field}.direction"), file.direction)?,
        angular_radius: radius.to_radians(),
        radiance: check.radiance(&format!("{field}.radiance"), file.radiance)?,
    }))
}
