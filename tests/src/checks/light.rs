//! What light does to results.

use halflight_contract::Quantity;
use halflight_scenes::Rgb;

use super::altered::brighter;
use super::{Case, Verdict, Violation, close, same_bits};

/// Relative to the greatest value: light tables may be built by sums whose rounding differs.
const TOLERANCE: f32 = 1e-5;

/// Twice the radiance of every light gives twice the result, and the same visibility.
pub fn linear_in_light(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("linear_in_light", || {
        let frame = &case.frames[0];
        let once = case.fresh(frame)?;
        let bright = brighter(case.scene, Rgb::splat(2.0));
        let twice = case.on(&bright).fresh(frame)?;
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
