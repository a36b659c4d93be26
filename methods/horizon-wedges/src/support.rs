//! What the family answers.

use halflight_contract::{Backend, Quantity, Request, Support};
use halflight_scenes::SceneFacts;

use crate::params::{STORAGE, SWATH, decimated};
use crate::{Keys, Variant};

/// What the family answers on its backends.
pub(crate) fn supports(variant: &Variant, facts: &SceneFacts, request: &Request<'_>) -> Support {
    match (cpu(variant, facts, request), request.backend) {
        (Support::Skip(why), _) => Support::Skip(why),
        (support, Backend::Gpu(_)) => gpu(variant, request).map_or(support, |why| Support::Skip(why.into())),
        (support, Backend::Cpu) => support,
    }
}

/// What there is that shaders do not do.
fn gpu(variant: &Variant, request: &Request<'_>) -> Option<&'static str> {
    let missing = [
        (!cfg!(feature = "gpu"), "this program was built without the feature gpu"),
        (!variant.info.runs_on(Backend::GPU), "the method has no GPU backend"),
        (variant.declares(&STORAGE) && decimated(request.params), "levels that stay decimated are not kept on the GPU"),
    ];
    missing.into_iter().find(|(missing, _)| *missing).map(|(_, why)| why)
}

/// Direct light on the one height field of a scene. Visibility is that of the complete swath.
fn cpu(variant: &Variant, facts: &SceneFacts, request: &Request<'_>) -> Support {
    if facts.height_fields != 1 {
        return Support::Skip(format!("needs one height field that casts shadows, found {}", facts.height_fields));
    }
    match request.quantity {
        Quantity::Direct if facts.distant_lights() == 0 && facts.emitters > 0 => {
            Support::Skip("all light comes from objects that emit, none from afar".into())
        }
        Quantity::Direct => left_out(variant, facts),
        Quantity::Visibility { .. } if variant.ambient => {
            Support::Skip("the open share of the cosine is one number, without directions".into())
        }
        Quantity::Visibility { order } if usize::from(order) > request.params.int(crate::params::ORDER.name) => {
            Support::Skip(format!("visibility of order {order} needs the parameter order to be at least that"))
        }
        Quantity::Visibility { .. } if narrowed(variant, request) => Support::Skip(
            "swaths of key lights hold parts of the visibility; horizon-wedges/complete has it whole".into(),
        ),
        Quantity::Visibility { .. } => left_out(variant, &SceneFacts { emitters: 0, ..facts.clone() }),
        Quantity::Indirect { .. } | Quantity::Total => Support::Skip("computes direct light only".into()),
    }
}

/// Whether key lights are seen apart.
fn narrowed(variant: &Variant, request: &Request<'_>) -> bool {
    let whole = || variant.declares(&SWATH) && request.params.float(SWATH.name) >= 360.0;
    variant.keys != Keys::Complete && !whole()
}

fn left_out(variant: &Variant, facts: &SceneFacts) -> Support {
    let casters = if variant.casters { 0 } else { facts.casters - 1 };
    match (casters, facts.emitters) {
        (0, 0) => Support::Exact,
        (casters, 0) => Support::Approximate(format!("leaves out the shadows of {casters} objects beside the field")),
        (0, emitters) => Support::Approximate(format!("leaves out the light of {emitters} objects that emit")),
        (casters, emitters) => Support::Approximate(format!(
            "leaves out the shadows of {casters} objects beside the field and the light of {emitters} that emit"
        )),
    }
}
