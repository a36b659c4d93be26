//! A method whose buffers stay where they were made, as on a device, and are filled only when their content changes.

use halflight_contract::{
    Backend, Coupling, Error, Footprint, Info, Job, Meter, Method, Output, ParamSpec, Params, Prepared, Quantity,
    Request, Result, Support,
};
use halflight_scenes::{Content, Frame, Receivers, Revision, Rgb, SceneFacts, Sphere};

use super::toy;

const PARAMS: &[ParamSpec] = &[toy::INFLATE, toy::STRENGTH];

/// Uploads spheres and receivers when their revisions change, and reads results back in a step of its own.
pub struct Resident {
    info: &'static Info,
    /// The flaw: what is read back is added to what the output holds.
    adds: bool,
}

impl Resident {
    /// Overwrites the output.
    pub const HONEST: Resident = Resident { info: &INFO, adds: false };
    /// Adds to the output.
    pub const TWIN: Resident = Resident { info: &TWIN_INFO, adds: true };
}

static INFO: Info = Info {
    id: "mock/resident",
    about: "buffers that are filled only when their content changes",
    paper: "none",
    backends: &[Backend::Cpu],
    params: PARAMS,
    coupling: Coupling::Independent,
};
static TWIN_INFO: Info = Info { id: "mock/resident-twin", ..INFO };

impl Method for Resident {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn supports(&self, _: &SceneFacts, request: &Request<'_>) -> Support {
        toy::supports(request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, _: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        Ok(Box::new(Ready {
            id: self.info.id,
            adds: self.adds,
            params: job.params.clone(),
            at_rest: toy::casters_at_rest(job.scene, job.params.float("inflate") as f32),
            spheres: Buffer::default(),
            receivers: Buffer::default(),
            results: Vec::new(),
        }))
    }
}

/// Data on the device and the revision that it has.
struct Buffer<T> {
    revision: Option<Revision>,
    data: Vec<T>,
}

impl<T> Default for Buffer<T> {
    fn default() -> Self {
        Buffer { revision: None, data: Vec::new() }
    }
}

impl<T> Buffer<T> {
    /// Fills the buffer if it holds another revision.
    fn sync(&mut self, revision: Revision, meter: &mut dyn Meter, fill: impl FnOnce() -> Vec<T>) {
        if self.revision != Some(revision) {
            self.data = fill();
            self.revision = Some(revision);
            meter.count("bytes uploaded", size_of_val(&self.data[..]) as u64);
        }
    }
}

struct Ready {
    id: &'static str,
    adds: bool,
    params: Params,
    at_rest: Vec<Vec<Sphere>>,
    spheres: Buffer<Sphere>,
    receivers: Buffer<Receivers>,
    results: Vec<Rgb>,
}

impl Prepared for Ready {
    fn footprint(&self) -> Footprint {
        Footprint::default()
            .host("spheres", size_of_val(&self.spheres.data[..]))
            .host("results", size_of_val(&self.results[..]))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        params.retune(&mut self.params, PARAMS)
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        self.spheres.sync(objects_revision(frame), meter, || toy::all_posed(&self.at_rest, frame));
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, _: Quantity, meter: &mut dyn Meter) -> Result<()> {
        let strength = self.params.float("strength") as f32;
        self.receivers.sync(frame.receivers.revision, meter, || vec![(*frame.receivers).clone()]);
        let receivers = &self.receivers.data[0];
        let light = toy::mean_light(frame);
        let shade = |i: usize| {
            let (position, normal) = (receivers.position[i], receivers.geometric_normal[i]);
            let covered: f32 = self.spheres.data.iter().map(|sphere| toy::covered(position, normal, sphere)).sum();
            toy::shaded(receivers, i, light, strength * covered)
        };
        self.results = (0..receivers.len()).map(shade).collect();
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()> {
        meter.count("bytes read back", size_of_val(&self.results[..]) as u64);
        if !self.adds {
            return toy::write(self.id, &self.results, out);
        }
        let Output::Radiance(out) = out else { return Err(self.wrong_output()) };
        out.iter_mut().zip(&self.results).for_each(|(out, result)| *out += *result);
        Ok(())
    }
}

impl Ready {
    fn wrong_output(&self) -> Error {
        toy::unsupported(self.id, "an output of coefficients")
    }
}

fn objects_revision(frame: &Frame) -> Revision {
    let revisions: Vec<[u8; 8]> = frame.objects.iter().map(|object| object.revision.0.to_le_bytes()).collect();
    Content::of(revisions.as_flattened()).revision()
}
