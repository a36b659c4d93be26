//! A method that shares its light and its spheres with others through the cache.

use std::sync::Arc;

use halflight_contract::{
    Backend, Coupling, Derived, Footprint, Info, Job, Meter, Method, Output, ParamSpec, Params, Prepared, Quantity,
    Request, Result, Support,
};
use halflight_scenes::{Frame, Rgb, Scene, SceneFacts, Sphere};

use super::toy;

const PARAMS: &[ParamSpec] = &[toy::STRENGTH];

/// Derives its light by the lights' content and its spheres by the shapes'.
pub struct SharedDerived {
    info: &'static Info,
    /// The flaw: what is derived is known by the scene's name.
    by_name: bool,
}

impl SharedDerived {
    /// Keys by content.
    pub const HONEST: SharedDerived = SharedDerived { info: &INFO, by_name: false };
    /// Keys by name.
    pub const TWIN: SharedDerived = SharedDerived { info: &TWIN_INFO, by_name: true };
}

static INFO: Info = Info {
    id: "mock/derived",
    about: "shared derived data",
    paper: "none",
    backends: &[Backend::Cpu],
    params: PARAMS,
    coupling: Coupling::Independent,
};
static TWIN_INFO: Info = Info { id: "mock/derived-twin", ..INFO };

impl Method for SharedDerived {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        match facts.turning {
            0 => toy::supports(request),
            _ => Support::Skip("derives its light once".into()),
        }
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        Ok(Box::new(Ready {
            id: self.info.id,
            params: job.params.clone(),
            toy: job.derive(&ToyOf { by_name: self.by_name }, meter)?,
            spheres: Vec::new(),
            results: Vec::new(),
        }))
    }
}

/// A scene's light and spheres. Derives its light in turn.
struct ToyOf {
    by_name: bool,
}

struct Toy {
    light: Arc<Rgb>,
    at_rest: Vec<Vec<Sphere>>,
}

impl Derived for ToyOf {
    type Value = Toy;
    const NAME: &'static str = "mock-toy";
    const REVISION: &'static str = "1";

    fn key(&self, scene: &Scene) -> String {
        if self.by_name {
            return scene.name.clone();
        }
        let objects = scene.objects.iter().map(|object| format!("{}{}", object.content, object.casts));
        objects.chain([LightOf.key(scene)]).collect()
    }

    fn make(&self, job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Toy> {
        Ok(Toy { light: job.derive(&LightOf, meter)?, at_rest: toy::casters_at_rest(job.scene, 1.0) })
    }
}

/// A scene's mean light.
struct LightOf;

impl Derived for LightOf {
    type Value = Rgb;
    const NAME: &'static str = "mock-light";
    const REVISION: &'static str = "1";

    fn key(&self, scene: &Scene) -> String {
        scene.lights.iter().map(|light| light.content().to_string()).collect()
    }

    fn make(&self, job: &Job<'_, '_>, _: &mut dyn Meter) -> Result<Rgb> {
        Ok(toy::mean_light(&job.scene.frame(0)))
    }
}

struct Ready {
    id: &'static str,
    params: Params,
    toy: Arc<Toy>,
    spheres: Vec<Sphere>,
    results: Vec<Rgb>,
}

impl Prepared for Ready {
    fn footprint(&self) -> Footprint {
        Footprint::default()
            .host("spheres", size_of_val(&self.spheres[..]))
            .host("results", size_of_val(&self.results[..]))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        params.retune(&mut self.params, PARAMS)
    }

    fn update(&mut self, frame: &Frame, _: &mut dyn Meter) -> Result<()> {
        self.spheres = toy::all_posed(&self.toy.at_rest, frame);
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, _: Quantity, _: &mut dyn Meter) -> Result<()> {
        let receivers = &*frame.receivers;
        let strength = self.params.float("strength") as f32;
        let shade = |i: usize| {
            let (position, normal) = (receivers.position[i], receivers.geometric_normal[i]);
            let covered: f32 = self.spheres.iter().map(|sphere| toy::covered(position, normal, sphere)).sum();
            toy::shaded(receivers, i, *self.toy.light, strength * covered)
        };
        self.results = (0..receivers.len()).map(shade).collect();
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        toy::write(self.id, &self.results, out)
    }
}
