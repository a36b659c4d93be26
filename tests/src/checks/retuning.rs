//! What `retune` takes and refuses.

use halflight_contract::{NoMeter, ParamSpec, Phase};

use super::case::is_live;
use super::{Breach, Case, Outcome, Verdict, Violation, ensure, same_bits};

/// After `retune` a result has the bits of a method prepared with those parameters, and going back gives the first bits
/// again; a parameter whose phase is `prepare` is refused and nothing changes.
pub fn retuned_equals_fresh(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("retuned_equals_fresh", || {
        let variants = case.variants();
        if variants.is_empty() {
            return Ok(Verdict::Exempt("no parameter can be set to anything but its default here"));
        }
        for (spec, variant) in &variants {
            let checked = if is_live(spec) { taken(case, variant, spec.phase) } else { refused(case, variant) };
            checked.map_err(|breach| breach.with(variant, spec))?;
        }
        Ok(Verdict::Held)
    })
}

fn taken(case: &Case<'_>, variant: &Case<'_>, phase: Phase) -> Outcome {
    let frame = &case.frames[0];
    let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
    let first = case.run(&mut *prepared, frame)?;
    for (what, target, expected) in [("retuned", variant, variant.fresh(frame)?), ("retuned back", case, first)] {
        prepared.retune(&target.params)?;
        if phase <= Phase::Update {
            prepared.update(frame, &mut NoMeter)?;
        }
        same_bits(what, &expected, &target.shade(&mut *prepared, frame)?)?;
    }
    Ok(Verdict::Held)
}

fn refused(case: &Case<'_>, variant: &Case<'_>) -> Outcome {
    let frame = &case.frames[0];
    let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
    let first = case.run(&mut *prepared, frame)?;
    let answer = prepared.retune(&variant.params);
    ensure(answer.is_err(), || "retune took a parameter whose phase is prepare, expected an error".into())?;
    same_bits("after a refused retune", &first, &case.run(&mut *prepared, frame)?)?;
    Ok(Verdict::Held)
}

impl Breach {
    /// Names the parameter that was set.
    pub(super) fn with(self, variant: &Case<'_>, spec: &ParamSpec) -> Self {
        let value = variant.params.iter().find(|(name, _)| *name == spec.name).map(|(_, value)| value.to_string());
        Breach(format!("{} = {}: {}", spec.name, value.unwrap_or_default(), self.0))
    }
}
