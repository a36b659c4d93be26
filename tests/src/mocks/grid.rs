//! A method that keeps a grid of cells from frame to frame and updates those that a motion touches.

use halflight_contract::{
    Backend, Coupling, Footprint, Info, Job, Meter, Method, Output, ParamSpec, Params, Prepared, Quantity, Request,
    Result, Support,
};
use halflight_scenes::{Frame, Revision, Rgb, SceneFacts, Sphere};

use super::toy;

const PARAMS: &[ParamSpec] = &[toy::INFLATE, toy::RANGE, toy::STRENGTH];

/// Keeps what covers every cell, and computes it anew where a sphere that moved was or is in range.
pub struct Grid {
    info: &'static Info,
    /// The flaw: cells that a sphere left are forgotten.
    forgets_left: bool,
}

impl Grid {
    /// Updates every cell that changes.
    pub const HONEST: Grid = Grid { info: &INFO, forgets_left: false };
    /// Leaves shadows behind where a sphere was.
    pub const TWIN: Grid = Grid { info: &TWIN_INFO, forgets_left: true };
}

static INFO: Info = Info {
    id: "mock/grid",
    about: "a grid of cells updated in part",
    paper: "none",
    backends: &[Backend::Cpu],
    params: PARAMS,
    coupling: Coupling::Grid,
};
static TWIN_INFO: Info = Info { id: "mock/grid-twin", ..INFO };

impl Method for Grid {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn supports(&self, _: &SceneFacts, request: &Request<'_>) -> Support {
        toy::supports(request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, _: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        Ok(Box::new(Ready {
            id: self.info.id,
            forgets_left: self.forgets_left,
            params: job.params.clone(),
            at_rest: toy::casters_at_rest(job.scene, job.params.float("inflate") as f32),
            receivers: None,
            objects: Vec::new(),
            covered: Vec::new(),
            results: Vec::new(),
        }))
    }
}

/// An object where it was at an update.
struct Posed {
    revision: Revision,
    spheres: Vec<Sphere>,
}

struct Ready {
    id: &'static str,
    forgets_left: bool,
    params: Params,
    at_rest: Vec<Vec<Sphere>>,
    /// Revision of the receivers that `covered` is for; `None` if every cell is stale.
    receivers: Option<Revision>,
    /// Every object as of the last update.
    objects: Vec<Posed>,
    covered: Vec<f32>,
    results: Vec<Rgb>,
}

impl Prepared for Ready {
    fn footprint(&self) -> Footprint {
        Footprint::default()
            .host("cells", size_of_val(&self.covered[..]))
            .host("results", size_of_val(&self.results[..]))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        let range = self.params.float("range");
        params.retune(&mut self.params, PARAMS)?;
        if self.params.float("range") != range {
            self.receivers = None;
        }
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        let posed = |object: usize| Posed {
            revision: frame.objects[object].revision,
            spheres: toy::posed(object, &self.at_rest, frame),
        };
        let objects = (0..self.at_rest.len()).map(posed).collect();
        let before = std::mem::replace(&mut self.objects, objects);
        let receivers = &*frame.receivers;
        let all = self.receivers != Some(receivers.revision);
        let moved = if all { Vec::new() } else { self.moved_spheres(&before) };
        self.receivers = Some(receivers.revision);
        self.covered.resize(receivers.len(), 0.0);
        for (i, position) in receivers.position.iter().enumerate() {
            if all || moved.iter().any(|sphere| self.in_range(*position, sphere)) {
                let normal = receivers.geometric_normal[i];
                let spheres = self.objects.iter().flat_map(|object| &object.spheres);
                let near = spheres.filter(|sphere| self.in_range(*position, sphere));
                self.covered[i] = near.map(|sphere| toy::covered(*position, normal, sphere)).sum();
                meter.count("cells updated", 1);
            }
        }
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, _: Quantity, _: &mut dyn Meter) -> Result<()> {
        let (strength, light) = (self.params.float("strength") as f32, toy::mean_light(frame));
        let shade = |(i, covered): (usize, &f32)| toy::shaded(&frame.receivers, i, light, strength * covered);
        self.results = self.covered.iter().enumerate().map(shade).collect();
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        toy::write(self.id, &self.results, out)
    }
}

impl Ready {
    /// Spheres of objects that changed: where they are and where they were.
    fn moved_spheres(&self, before: &[Posed]) -> Vec<Sphere> {
        let changed = self.objects.iter().zip(before).filter(|(now, then)| now.revision != then.revision);
        let spheres = |(now, then): (&Posed, &Posed)| {
            let left = if self.forgets_left { &[] } else { &then.spheres[..] };
            [&now.spheres, left].concat()
        };
        changed.flat_map(spheres).collect()
    }

    fn in_range(&self, position: glam::Vec3, sphere: &Sphere) -> bool {
        position.distance(sphere.center) <= self.params.float("range") as f32 * sphere.radius
    }
}
