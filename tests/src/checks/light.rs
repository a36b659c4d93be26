//! What light does to results.

use glam::Vec3;
use halflight_contract::{NoMeter, Quantity};
use halflight_scenes::Rgb;
use halflight_scenes::{DistantLight, Light, Scene, Turn};

use super::altered::{brighter, relit};
use super::{Case, Verdict, Violation, close, same_bits};

/// Relative to the greatest value: light tables may be built by sums whose rounding differs.
const TOLERANCE: f32 = 1e-5;

/// Twice the radiance of every light gives twice the result, and the same visibility.
pub fn linear_in_light(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("linear_in_light", || {
        let frame = &case.frames[0];
        let once = case.fresh(frame)?;
        let bright = brighter(case.scene, Rgb::splat(2.0));
        let twice = case.on(&bright).fresh(&bright.frame(frame.index))?;
        if let Quantity::Visibility { .. } = case.quantity {
            same_bits("visibility under twice the light", &once, &twice)?;
            return Ok(Verdict::Held);
        }
        let expected: Vec<f32> = once.iter().map(|value| 2.0 * value).collect();
        let tolerance = TOLERANCE * expected.iter().fold(0.0f32, |greatest, value| greatest.max(value.abs()));
        close("twice the light", &expected, &twice, |e, f| (e - f).abs() <= tolerance)?;
        Ok(Verdict::Held)
    })
}

/// A light that turns gives at every frame what it would if it rested where it then is.
pub fn turning_light(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("turning_light", || {
        let turning = relit(case.scene, case.scene.lights.iter().map(turned).collect());
        let turning = Scene { frame_count: 3, fps: 1.0, ..turning };
        let turning_case = case.on(&turning);
        if turning.lights.iter().all(|light| light.turn.is_none()) || !turning_case.is_supported() {
            return Ok(Verdict::Exempt("no light of it may turn"));
        }
        let mut prepared = turning_case.prepare(&turning_case.cache, &mut NoMeter)?;
        for frame in &turning_case.frames {
            let found = turning_case.run(&mut *prepared, frame)?;
            let resting = turning.lights.iter().map(|light| light.at(frame.time).into()).collect();
            let resting = relit(&turning, resting);
            let expected = case.on(&resting).fresh(&resting.frame(frame.index))?;
            let tolerance = TOLERANCE * expected.iter().fold(0.0f32, |greatest, value| greatest.max(value.abs()));
            let what = format!("light turned by frame {}", frame.index);
            close(what, &expected, &found, |e, f| (e - f).abs() <= tolerance)?;
        }
        Ok(Verdict::Held)
    })
}

/// Environments about the vertical, key lights about any axis.
fn turned(light: &DistantLight) -> DistantLight {
    let about = |axis: Vec3| Some(Turn { axis: axis.normalize(), speed: 0.9 });
    let turn = match light.rest {
        Light::Environment(_) => about(Vec3::Z),
        Light::Key(_) => about(Vec3::new(1.0, -0.5, 2.0)),
        Light::Sky(_) => None,
    };
    DistantLight { turn, ..light.clone() }
}
