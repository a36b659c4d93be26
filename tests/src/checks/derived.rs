//! What methods share through the cache.

use halflight_contract::{Cache, Meter, NoMeter};

use super::altered::changed;
use super::meters::Watch;
use super::{Breach, Case, Outcome, Verdict, Violation, ensure, same_bits};

/// Two scenes of one name but different content that share a cache get the results that they get with a cache each; and
/// preparing again with the same cache builds nothing anew, yet is charged the same build times.
pub fn shared_derived_data(case: &Case<'_>) -> Result<Verdict, Violation> {
    case.judge("shared_derived_data", || {
        let other_scene = changed(case.scene);
        let other = case.on(&other_scene);
        let shared = Cache::in_memory();
        let mut first = Watch::default();
        let result = run_with(case, &shared, &mut first)?;
        same_bits("in the first of two scenes of one name", &case.fresh(&case.frames[0])?, &result)?;
        if other.is_supported() {
            let result = run_with(&other, &shared, &mut NoMeter)?;
            same_bits("in the second of two scenes of one name", &other.fresh(&other.frames[0])?, &result)?;
        }
        charged_again(case, &shared, &first)
    })
}

fn run_with(case: &Case<'_>, cache: &Cache, meter: &mut dyn Meter) -> Result<Vec<f32>, Breach> {
    let mut prepared = case.prepare(cache, meter)?;
    Ok(case.run(&mut *prepared, &case.frames[0])?)
}

/// A build that is made anew takes other nanoseconds, so equal charges mean that nothing was.
fn charged_again(case: &Case<'_>, cache: &Cache, first: &Watch) -> Outcome {
    let mut second = Watch::default();
    case.prepare(cache, &mut second)?;
    ensure(first.charges == second.charges, || {
        format!("charged {:?} at first and {:?} with the same cache, expected the same", first.charges, second.charges)
    })?;
    Ok(if first.charges.is_empty() { Verdict::Exempt("it derives nothing") } else { Verdict::Held })
}
