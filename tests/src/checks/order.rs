//! How receivers couple.

use halflight_contract::{Coupling, Quantity};
use halflight_scenes::{Frame, Light, Rgb, Sky};

use super::altered::{of_unit_albedo, relit, with_receivers};
use super::{Breach, Case, Outcome, Verdict, Violation, close, ensure, same_bits};

/// The same receivers in another order, or a part of them, get what the method's [`Coupling`] promises: the same bits,
/// or within its bound under a unit environment at unit albedo. Grids are exempt, for their order is part of the input.
pub fn permuted_receivers(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("permuted_receivers", || match case.method.coupling(&case.params) {
        Coupling::Independent => {
            regrouped(case, &case.frames, |what, expected, found| same_bits(what, expected, found))
        }
        Coupling::Clustered(bound) => clustered(case, bound),
        Coupling::Grid => Ok(Verdict::Exempt("receivers are cells of a grid, whose order is part of the input")),
    })
}

fn clustered(case: &Case<'_>, bound: f32) -> Outcome {
    ensure(bound.is_finite() && bound >= 0.0, || format!("bound {bound}, expected a finite number from 0"))?;
    if let Quantity::Visibility { .. } = case.quantity {
        return Ok(Verdict::Exempt("the bound of clusters is on radiance"));
    }
    let scene = relit(case.scene, vec![Light::Sky(Sky::Uniform(Rgb::ONE)).into()]);
    let case = case.on(&scene);
    let frames: Vec<Frame> = case.frames.iter().map(of_unit_albedo).collect();
    regrouped(&case, &frames, |what, expected, found| {
        close(format_args!("{what}, bound {bound}"), expected, found, |e, f| (e - f).abs() <= bound)
    })
}

/// Holds the last frame's results for reordered and thinned receivers against those for all in order.
fn regrouped(case: &Case<'_>, frames: &[Frame], agree: impl Fn(&str, &[f32], &[f32]) -> Result<(), Breach>) -> Outcome {
    let Some(frame) = frames.last() else { return Ok(Verdict::Held) };
    let all = case.fresh(frame)?;
    for (what, chosen) in groupings(frame.receivers.len()) {
        let found = case.fresh(&with_receivers(frame, &chosen))?;
        let channels = case.quantity.channels();
        let expected: Vec<f32> = chosen.iter().flat_map(|i| &all[i * channels..(i + 1) * channels]).copied().collect();
        agree(what, &expected, &found)?;
    }
    Ok(Verdict::Held)
}

fn groupings(count: usize) -> [(&'static str, Vec<usize>); 3] {
    [
        ("receivers reversed", (0..count).rev().collect()),
        ("receivers shuffled", shuffled(count)),
        ("every third receiver", (0..count).step_by(3).collect()),
    ]
}

/// Fisher and Yates' shuffle with a linear congruential generator (Knuth's MMIX constants).
fn shuffled(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    let mut state = 1u64;
    for last in (1..count).rev() {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        order.swap(last, (state >> 33) as usize % (last + 1));
    }
    order
}
