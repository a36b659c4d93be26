//! What `retune` takes and refuses.

use halflight_contract::{NoMeter, ParamSpec, Phase};

use super::case::is_live;
use super::{Breach, Case, Outcome, Verdict, Violation, ensure, same_bits};

/// After `retune` a result has the bits of a method prepared with those parameters, and as much memory; so it is when one
/// setting follows another, and going back gives the first bits again. A parameter whose phase is `prepare` is refused and
/// nothing changes.
pub fn retuned_equals_fresh(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("retuned_equals_fresh", || {
        let variants = case.variants();
        if variants.is_empty() {
            return Ok(Verdict::Exempt("no parameter can be set to anything but its default here"));
        }
        let (live, fixed): (Vec<_>, Vec<_>) = variants.iter().partition(|(spec, _)| is_live(spec));
        for (spec, variant) in fixed {
            refused(case, variant).map_err(|breach| breach.with(variant, spec))?;
        }
        for (spec, variant) in &live {
            walk(case, &[("retuned", variant), ("retuned back", case)]).map_err(|breach| breach.with(variant, spec))?;
        }
        // Two parameters change at once from one setting to the next.
        let all: Vec<_> = live.iter().map(|(_, variant)| ("retuned again and again", variant)).collect();
        walk(case, &all)
    })
}

/// Retunes a prepared method to one setting after the other.
fn walk(case: &Case<'_>, settings: &[(&str, &Case<'_>)]) -> Outcome {
    let (frame, specs) = (&case.frames[0], case.method.info().params);
    let mut prepared = case.prepare(&case.cache, &mut NoMeter)?;
    case.run(&mut *prepared, frame)?;
    let mut before = &case.params;
    for (what, setting) in settings {
        let mut fresh = setting.prepare(&case.cache, &mut NoMeter)?;
        let expected = setting.run(&mut *fresh, frame)?;
        prepared.retune(&setting.params)?;
        if setting.params.first_change(before, specs) <= Some(Phase::Update) {
            prepared.update(frame, &mut NoMeter)?;
        }
        same_bits(what, &expected, &setting.shade(&mut *prepared, frame)?)?;
        let (expected, found) = (fresh.footprint(), prepared.footprint());
        ensure(expected == found, || format!("{what}: it holds {found:?}, expected {expected:?} as if prepared anew"))?;
        before = &setting.params;
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
