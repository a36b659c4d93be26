//! Generated heights, about the origin in metres.

use std::f64::consts::TAU;

use glam::{DVec2, Vec2};

use crate::SceneError;
use crate::animation::Wave;
use crate::check::Checker;
use crate::format::{HeightsFile, WaveFile};

use super::fractal::Fractal;

/// Height in metres at a horizontal position in metres.
pub(super) type Heights = Box<dyn Fn(DVec2) -> f64>;

/// Most sines and noises of one field.
const MOST_WAVES: usize = 64;
const MOST_OCTAVES: usize = 32;

/// Names of the generators, and whether the file asks for each.
fn given(file: &HeightsFile) -> [(&'static str, bool); 7] {
    [
        ("ramp", file.ramp.is_some()),
        ("trench", file.trench.is_some()),
        ("wall", file.wall.is_some()),
        ("cone", file.cone.is_some()),
        ("bump", file.bump.is_some()),
        ("waves", file.waves.is_some()),
        ("fractal", file.fractal.is_some()),
    ]
}

pub(super) fn any(file: &HeightsFile) -> bool {
    given(file).iter().any(|(_, given)| *given)
}

/// The generator that a file asks for.
pub(super) fn heights(check: Checker, field: &str, file: &HeightsFile, cell: Vec2) -> Result<Heights, SceneError> {
    let given = given(file);
    if given.iter().filter(|(_, given)| *given).count() != 1 {
        return Err(match given.iter().any(|(_, given)| *given) {
            true => check.not_one(field, &given),
            false => check.not_one(field, &[&[("file", false)], &given[..]].concat()),
        });
    }
    let at = |name: &str| format!("{field}.{name}");
    let positive = |name: &str, value: f32| check.positive(&at(name), value).map(f64::from);
    let number = |name: &str, value: f32| check.number(&at(name), value).map(f64::from);
    let not_negative = |name: &str, value: f32| {
        check.ensure(value >= 0.0, &at(name), "a finite number, not negative", value)?;
        number(name, value)
    };
    let tangent = |name: &str, value: f32| {
        check.ensure((0.0..90.0).contains(&value), &at(name), "degrees from 0 to below 90", value)?;
        Ok::<f64, SceneError>(f64::from(value).to_radians().tan())
    };
    if let Some(ramp) = &file.ramp {
        let rise = tangent("ramp.slope", ramp.slope)?;
        let gradient = rise * direction(number("ramp.azimuth", ramp.azimuth)?);
        return Ok(Box::new(move |at| gradient.dot(at)));
    }
    if let Some(trench) = &file.trench {
        let (depth, rise) = (positive("trench.depth", trench.depth)?, tangent("trench.wall", trench.wall)?);
        let floor = 0.5 * not_negative("trench.width", trench.width)?;
        return Ok(Box::new(move |at| (rise * (at.x.abs() - floor).max(0.0)).min(depth) - depth));
    }
    if let Some(wall) = &file.wall {
        let height = number("wall.height", wall.height)?;
        // A wall thinner than a cell is still met by the vertices nearest to it.
        let half = 0.5 * not_negative("wall.width", wall.width)?.max(f64::from(cell.x));
        return Ok(Box::new(move |at| if at.x.abs() <= half { height } else { 0.0 }));
    }
    if let Some(cone) = &file.cone {
        let (height, radius) = (number("cone.height", cone.height)?, positive("cone.radius", cone.radius)?);
        return Ok(Box::new(move |at| height * (1.0 - at.length() / radius).max(0.0)));
    }
    if let Some(bump) = &file.bump {
        let (height, sigma) = (number("bump.height", bump.height)?, positive("bump.sigma", bump.sigma)?);
        return Ok(Box::new(move |at| height * (-0.5 * (at / sigma).length_squared()).exp()));
    }
    if let Some(waves) = &file.waves {
        let waves = self::waves(check, field, waves)?;
        return Ok(Box::new(move |at| waves.iter().map(|wave| wave.height(at, 0.0)).sum()));
    }
    let fractal = file.fractal.as_ref().expect("the one generator left");
    let fractal = Fractal {
        seed: fractal.seed,
        amplitude: number("fractal.amplitude", fractal.amplitude)?,
        wavelength: positive("fractal.wavelength", fractal.wavelength)?,
        octaves: check.count(&at("fractal.octaves"), fractal.octaves, MOST_OCTAVES)?,
        gain: not_negative("fractal.gain", fractal.gain)?,
    };
    Ok(Box::new(move |at| fractal.height(at)))
}

/// Sines, at rest or running.
pub(super) fn waves(check: Checker, field: &str, files: &[WaveFile]) -> Result<Vec<Wave>, SceneError> {
    check.count(&format!("{field}.waves"), files.len(), MOST_WAVES)?;
    let wave = |(index, file): (usize, &WaveFile)| {
        let at = |name: &str| format!("{field}.waves[{index}].{name}");
        let number = |name: &str, value: f32| check.number(&at(name), value).map(f64::from);
        let amplitude = number("amplitude", file.amplitude)?;
        let along = direction(number("azimuth", file.azimuth)?);
        let radians = TAU / f64::from(check.positive(&at("wavelength"), file.wavelength)?);
        let (phase, pace) = (number("phase", file.phase)?.to_radians(), radians * number("speed", file.speed)?);
        Ok(Wave { amplitude, frequency: radians * along, phase, pace })
    };
    files.iter().enumerate().map(wave).collect()
}

/// The horizontal unit vector of an azimuth in degrees; the four along the axes are exact.
fn direction(azimuth: f64) -> DVec2 {
    let quarters = (azimuth / 90.0).round();
    let (sin, cos) = (azimuth - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) as u8 {
        0 => DVec2::new(cos, sin),
        1 => DVec2::new(-sin, cos),
        2 => DVec2::new(-cos, -sin),
        _ => DVec2::new(sin, -cos),
    }
}
