//! What sphere-blocker methods answer and where they run.

use halflight_contract::{Backend, Job, Meter, Prepared, Quantity, Request, Result, Support};
use halflight_scenes::SceneFacts;

use crate::{Accumulator, DirectLight, params};

/// The backends of a method, by its [`Accumulator::SHADER`]: with the feature `gpu` those that have one run there.
pub const fn backends(shader: Option<&str>) -> &'static [Backend] {
    if cfg!(feature = "gpu") && shader.is_some() { &[Backend::Cpu, Backend::GPU] } else { &[Backend::Cpu] }
}

/// Prepares a method for the job's backend.
pub fn prepare<'s, A: Accumulator>(job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
    match job.backend {
        Backend::Cpu => Ok(Box::new(DirectLight::<A>::prepare(job, meter)?)),
        #[cfg(feature = "gpu")]
        Backend::Gpu(_) => Ok(Box::new(crate::GpuDirectLight::<A>::prepare(job, meter)?)),
        #[cfg(not(feature = "gpu"))]
        Backend::Gpu(_) => Err(halflight_contract::Error::Device("built without the feature gpu".into())),
    }
}

/// What sphere-blocker methods answer on their backends.
pub fn supports<A: Accumulator>(facts: &SceneFacts, request: &Request<'_>) -> Support {
    match (cpu(facts, request), request.backend) {
        (Support::Skip(why), _) => Support::Skip(why),
        (support, Backend::Gpu(_)) => gpu::<A>().map_or(support, |why| Support::Skip(why.into())),
        (support, Backend::Cpu) => support,
    }
}

/// Why a method does not run on the GPU.
fn gpu<A: Accumulator>() -> Option<&'static str> {
    match A::SHADER {
        None => Some("the method has no GPU backend"),
        Some(_) if !cfg!(feature = "gpu") => Some("this program was built without the feature gpu"),
        Some(_) => None,
    }
}

/// Direct light of what is distant and of spheres that emit, and visibility up to their own order, where
/// spheres can stand for all that casts shadows. A height field is an open surface: spheres around it would bury the receivers on it.
fn cpu(facts: &SceneFacts, request: &Request<'_>) -> Support {
    let (order, most) = (params::accumulated_order(request.params), halflight_sh::MAX_ORDER);
    match request.quantity {
        _ if order > most => Support::Skip(format!("order + extra-bands is {order}, expected at most {most}")),
        _ if facts.height_fields > 0 => {
            Support::Skip("spheres cannot stand for a height field that casts shadows".into())
        }
        Quantity::Direct => direct(facts, request.params.flag(params::LOCAL_LIGHTS.name)),
        Quantity::Visibility { order } if usize::from(order) <= request.params.int(params::ORDER.name) => {
            Support::Exact
        }
        Quantity::Visibility { order } => {
            Support::Skip(format!("visibility of order {order} needs the parameter order to be at least that"))
        }
        Quantity::Indirect { .. } | Quantity::Total => Support::Skip("computes direct light only".into()),
    }
}

fn direct(facts: &SceneFacts, local_lights: bool) -> Support {
    let left_out = facts.emitters - if local_lights { facts.lamps } else { 0 };
    if left_out == 0 {
        Support::Exact
    } else if left_out == facts.emitters && facts.distant_lights() == 0 {
        Support::Skip("all light comes from objects that are no lamps of spheres, none from afar".into())
    } else {
        Support::Approximate(format!("leaves out the light of {left_out} objects that emit"))
    }
}

#[cfg(test)]
mod tests {
    use halflight_contract::Params;

    use super::*;

    #[test]
    fn height_fields_that_cast_are_left_to_others() {
        let params = Params::defaults(crate::blocker_params!());
        let request = Request { quantity: Quantity::Direct, backend: Backend::Cpu, params: &params };
        let answer = |height_fields| cpu(&SceneFacts { height_fields, ..SceneFacts::default() }, &request);
        assert!(matches!(answer(1), Support::Skip(why) if why.contains("height field")));
        assert!(matches!(answer(0), Support::Exact));
    }
}
