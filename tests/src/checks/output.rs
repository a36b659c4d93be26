//! What `read` writes.

use halflight_contract::{NoMeter, Quantity};
use halflight_scenes::Frame;

use super::altered::with_holes;
use super::{Case, Outcome, Verdict, Violation, ensure, same_bits};

/// Every fifth receiver is made invalid.
const HOLE: usize = 5;

/// `read` overwrites whatever the output held, NaN included, and gives zeros at invalid receivers.
pub fn dirty_output(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("dirty_output", || {
        let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
        for frame in &case.frames {
            let frame = with_holes(frame, HOLE);
            let clean = case.run(&mut *prepared, &frame)?;
            for dirt in [f32::NAN, 1e30, -1.0] {
                let found = case.read(&mut *prepared, &frame, dirt)?;
                same_bits(format_args!("output filled with {dirt:e} beforehand"), &clean, &found)?;
            }
            zero_where_invalid(case, &frame, &clean)?;
        }
        Ok(Verdict::Held)
    })
}

fn zero_where_invalid(case: &Case<'_>, frame: &Frame, values: &[f32]) -> Outcome {
    let by_receiver = values.chunks(case.quantity.channels());
    for (index, values) in by_receiver.enumerate().filter(|(index, _)| !frame.receivers.valid[*index]) {
        ensure(values.iter().all(|v| *v == 0.0), || {
            format!("invalid receiver {index} got {values:?}, expected zeros")
        })?;
    }
    Ok(Verdict::Held)
}

/// Reading twice, evaluating twice, and evaluating again after another quantity give the same bits.
pub fn repeated_evaluation(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("repeated_evaluation", || {
        let frame = &case.frames[0];
        let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
        let first = case.run(&mut *prepared, frame)?;
        same_bits("second read", &first, &case.read(&mut *prepared, frame, 0.0)?)?;
        same_bits("second evaluation", &first, &case.shade(&mut *prepared, frame)?)?;
        same_bits("second update with the same frame", &first, &case.run(&mut *prepared, frame)?)?;
        for other in others(case) {
            other.shade(&mut *prepared, frame)?;
            same_bits(format_args!("after {}", other.quantity), &first, &case.shade(&mut *prepared, frame)?)?;
        }
        Ok(Verdict::Held)
    })
}

/// The case with every other quantity that the method has at the same parameters.
fn others<'a>(case: &Case<'a>) -> impl Iterator<Item = Case<'a>> {
    let orders = (1..=8).map(|order| Quantity::Visibility { order });
    let quantities = [Quantity::Direct, Quantity::Indirect { bounces: 1 }, Quantity::Total].into_iter().chain(orders);
    quantities.filter(|q| *q != case.quantity).map(|q| case.asking(q)).filter(|other| other.is_supported())
}

/// Every value is finite in every frame, with default parameters and with each parameter at its extremes.
pub fn finite_output(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("finite_output", || {
        all_finite(case)?;
        for (spec, variant) in case.variants() {
            all_finite(&variant).map_err(|breach| breach.with(&variant, spec))?;
        }
        Ok(Verdict::Held)
    })
}

fn all_finite(case: &Case<'_>) -> Outcome {
    let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
    for frame in &case.frames {
        let values = case.run(&mut *prepared, frame)?;
        let bad = values.iter().position(|v| !v.is_finite());
        ensure(bad.is_none(), || {
            let (channels, value) = (case.quantity.channels(), bad.expect("found"));
            format!("frame {}, receiver {}: {} is not finite", frame.index, value / channels, values[value])
        })?;
    }
    Ok(Verdict::Held)
}
