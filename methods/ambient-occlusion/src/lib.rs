//! Ambient occlusion by surface elements: the baseline of Bunnell 2005 ("Dynamic Ambient Occlusion and Indirect Lighting", GPU Gems 2,
//! chapter 14).
//!
//! Everything that casts becomes discs, each with a position, a normal and an area `A`: one a vertex of a mesh, with a third of the area of
//! the triangles around it, or points of a spiral on a sphere. A disc casts its shadow from its back, so that the far side of a solid
//! casts and the near side does not shadow itself. At distance `r` in the direction `v` from a receiver with the normal `n` it shadows
//!
//! `(1 − 1/√(A/(π r²) + 1)) · clamp(n_e·v) · clamp(4 n·v)`
//!
//! (the chapter's `ElementShadow`), and nothing within its own radius: there the chapter, whose receivers are the elements themselves, has
//! none but the element, while here receivers lie anywhere on the surfaces. A receiver's accessibility is 1 less the sum, 0 at least. In every pass after the first a disc's shadow
//! counts as far as the disc itself was accessible in the pass before, since what is in shadow casts nothing new. Radiance is the irradiance
//! of the distant lights in SH, as if nothing stood in their way, times accessibility: shadows have no direction.
//!
//! **Limits.** Under nothing, accessibility is 1. Under finely cut surfaces that hide the hemisphere once the shadows add up to
//! `∫₀¹ min(1, 4u) du = 7/8`: an eighth of the light passes a closed room. Layers behind each other add up, until accessibility is 0.
//! Open surfaces cast no shadow before their front.

mod cpu;
mod forest;
#[cfg(feature = "gpu")]
mod gpu;
mod lanes;
mod sites;
mod stage;

use halflight_contract::{
    Backend, Coupling, Info, Job, Kind, Meter, Method, ParamSpec, Phase, Prepared, Quantity, Request, Result, Support,
};
use halflight_scenes::SceneFacts;

/// Surface elements in a hierarchy, summed at each receiver.
pub struct Elements;

const ORDER: ParamSpec = ParamSpec {
    name: "order",
    kind: Kind::Int { min: 1, max: halflight_sh::MAX_ORDER as i64, default: 4 },
    phase: Phase::Prepare,
    help: "SH order n of the light: bands 0..n−1",
};

const ELEMENTS: ParamSpec = ParamSpec {
    name: "elements",
    kind: Kind::Int { min: 16, max: 32768, default: 2048 },
    phase: Phase::Prepare,
    help: "most elements an object, vertices beyond are merged; each of an object's spheres has 16 to 128",
};

const PASSES: ParamSpec = ParamSpec {
    name: "passes",
    kind: Kind::Int { min: 1, max: 2, default: 2 },
    phase: Phase::Update,
    help: "passes, the receivers' own counted; each takes back shadows that elements in shadow cast in the one before",
};

const OPENING: ParamSpec = ParamSpec {
    name: "opening",
    kind: Kind::Float { min: 0.0, max: 2.0, default: 0.25 },
    phase: Phase::Update,
    help: "a group of elements is one where its radius is at most this share of its distance; 0: never",
};

static INFO: Info = Info {
    id: "ambient-occlusion/elements",
    about: "unshadowed irradiance times accessibility among disc-shaped surface elements",
    paper: "Bunnell 2005, GPU Gems 2, ch. 14",
    backends: if cfg!(feature = "gpu") { &[Backend::Cpu, Backend::GPU] } else { &[Backend::Cpu] },
    params: &[ORDER, PASSES, ELEMENTS, OPENING],
    coupling: Coupling::Independent,
};

impl Method for Elements {
    fn info(&self) -> &'static Info {
        &INFO
    }

    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        match request.quantity {
            _ if !INFO.runs_on(request.backend) => {
                Support::Skip("this program was built without the feature gpu".into())
            }
            Quantity::Direct if facts.emitters == 0 => Support::Exact,
            Quantity::Direct if facts.distant_lights() == 0 => {
                Support::Skip("all light comes from objects that emit, none from afar".into())
            }
            Quantity::Direct => {
                Support::Approximate(format!("leaves out the light of {} objects that emit", facts.emitters))
            }
            Quantity::Visibility { .. } => Support::Skip("accessibility is one number, without directions".into()),
            Quantity::Indirect { .. } | Quantity::Total => Support::Skip("computes direct light only".into()),
        }
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        match job.backend {
            Backend::Cpu => Ok(Box::new(cpu::Occlusion::prepare(job, meter)?)),
            #[cfg(feature = "gpu")]
            Backend::Gpu(_) => Ok(Box::new(gpu::Occlusion::prepare(job, meter)?)),
            #[cfg(not(feature = "gpu"))]
            Backend::Gpu(_) => Err(halflight_contract::Error::Device("built without the feature gpu".into())),
        }
    }
}
