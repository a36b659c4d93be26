//! A solver that adds sphere after sphere and may be told to stop between two.

use halflight_contract::{
    Backend, Coupling, Error, Flow, Footprint, Info, Job, Meter, Method, Output, ParamSpec, Params, Prepared, Quantity,
    Request, Result, Support, timed,
};
use halflight_scenes::{Frame, Rgb, SceneFacts, Sphere};

use super::toy;

const PARAMS: &[ParamSpec] = &[toy::INFLATE, toy::RANGE, toy::STRENGTH];

/// Adds the spheres one after the other for all receivers, and asks before each whether to go on.
pub struct Cancellable {
    info: &'static Info,
    /// The flaw: a half result is passed off as whole.
    passes_off_half: bool,
}

impl Cancellable {
    /// Answers a cancel with an error.
    pub const HONEST: Cancellable = Cancellable { info: &INFO, passes_off_half: false };
    /// Answers a cancel with a half result.
    pub const TWIN: Cancellable = Cancellable { info: &TWIN_INFO, passes_off_half: true };
}

static INFO: Info = Info {
    id: "mock/cancellable",
    about: "a solver that may be cancelled",
    paper: "none",
    backends: &[Backend::Cpu],
    params: PARAMS,
    coupling: Coupling::Independent,
};
static TWIN_INFO: Info = Info { id: "mock/cancellable-twin", ..INFO };

impl Method for Cancellable {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn supports(&self, _: &SceneFacts, request: &Request<'_>) -> Support {
        toy::supports(request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, _: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        Ok(Box::new(Ready {
            id: self.info.id,
            passes_off_half: self.passes_off_half,
            params: job.params.clone(),
            at_rest: toy::casters_at_rest(job.scene, job.params.float("inflate") as f32),
            spheres: Vec::new(),
            results: Vec::new(),
        }))
    }
}

struct Ready {
    id: &'static str,
    passes_off_half: bool,
    params: Params,
    at_rest: Vec<Vec<Sphere>>,
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
        self.spheres = toy::all_posed(&self.at_rest, frame);
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, _: Quantity, meter: &mut dyn Meter) -> Result<()> {
        let receivers = &*frame.receivers;
        let (strength, light) = (self.params.float("strength") as f32, toy::mean_light(frame));
        let covered = match timed(meter, "solve", |meter| self.solve(frame, meter)) {
            Solution::Whole(covered) => covered,
            Solution::Half(covered) if self.passes_off_half => covered,
            Solution::Half(_) => return Err(Error::Cancelled),
        };
        let shade = |(i, covered): (usize, &f32)| toy::shaded(receivers, i, light, strength * covered);
        self.results = covered.iter().enumerate().map(shade).collect();
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        toy::write(self.id, &self.results, out)
    }
}

/// The share covered at every receiver.
enum Solution {
    Whole(Vec<f32>),
    Half(Vec<f32>),
}

impl Ready {
    fn solve(&self, frame: &Frame, meter: &mut dyn Meter) -> Solution {
        let receivers = &*frame.receivers;
        let mut covered = vec![0.0; receivers.len()];
        for (done, sphere) in self.spheres.iter().enumerate() {
            if meter.progress("spheres", done as u64, self.spheres.len() as u64) == Flow::Cancel {
                return Solution::Half(covered);
            }
            let range = self.params.float("range") as f32 * sphere.radius;
            for (i, covered) in covered.iter_mut().enumerate() {
                if receivers.position[i].distance(sphere.center) > range {
                    continue;
                }
                *covered += toy::covered(receivers.position[i], receivers.geometric_normal[i], sphere);
            }
        }
        Solution::Whole(covered)
    }
}
