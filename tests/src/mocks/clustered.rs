//! A method whose receivers share, by clusters, the choice of spheres that matter.

use std::collections::HashMap;

use glam::{IVec3, Vec3};
use halflight_contract::{
    Backend, Coupling, Footprint, Info, Job, Meter, Method, Output, ParamSpec, Params, Prepared, Quantity, Request,
    Result, Support,
};
use halflight_scenes::{Frame, Receivers, Rgb, SceneFacts, Sphere};

use super::toy;

/// Radiance that a cluster may leave out, under unit light at unit albedo.
const BOUND: f32 = 0.02;
/// Edge of the cells whose receivers form a cluster, in metres.
const CELL: f32 = 2.0;
const PARAMS: &[ParamSpec] = &[toy::INFLATE, toy::STRENGTH];

/// Leaves out, cluster by cluster, spheres that together cover less than a bound anywhere in the cluster.
pub struct Clustered {
    info: &'static Info,
    /// The flaw: a cluster is taken for its first receiver alone, so that whoever stands first decides for all.
    first_decides: bool,
}

impl Clustered {
    /// Keeps the bound.
    pub const HONEST: Clustered = Clustered { info: &INFO, first_decides: false };
    /// Depends on the order of receivers beyond its bound.
    pub const TWIN: Clustered = Clustered { info: &TWIN_INFO, first_decides: true };
}

static INFO: Info = Info {
    id: "mock/clustered",
    about: "receivers in clusters that share a choice of spheres",
    paper: "none",
    backends: &[Backend::Cpu],
    params: PARAMS,
    coupling: Coupling::Clustered(BOUND),
};
static TWIN_INFO: Info = Info { id: "mock/clustered-twin", ..INFO };

impl Method for Clustered {
    fn info(&self) -> &'static Info {
        self.info
    }

    fn supports(&self, _: &SceneFacts, request: &Request<'_>) -> Support {
        toy::supports(request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, _: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        Ok(Box::new(Ready {
            id: self.info.id,
            first_decides: self.first_decides,
            params: job.params.clone(),
            at_rest: toy::casters_at_rest(job.scene, job.params.float("inflate") as f32),
            spheres: Vec::new(),
            results: Vec::new(),
        }))
    }
}

struct Ready {
    id: &'static str,
    first_decides: bool,
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
        self.results = vec![Rgb::ZERO; receivers.len()];
        for members in clusters(receivers) {
            let near = self.near(receivers, &members, strength);
            meter.count("spheres left out", (self.spheres.len() - near.len()) as u64);
            for i in members {
                let (position, normal) = (receivers.position[i], receivers.geometric_normal[i]);
                let covered: f32 = near.iter().map(|sphere| toy::covered(position, normal, sphere)).sum();
                self.results[i] = toy::shaded(receivers, i, light, strength * covered);
            }
        }
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        toy::write(self.id, &self.results, out)
    }
}

impl Ready {
    /// The spheres that a cluster does not leave out, in the frame's order.
    fn near(&self, receivers: &Receivers, members: &[usize], strength: f32) -> Vec<Sphere> {
        let first = receivers.position[members[0]];
        let farthest = members.iter().map(|i| receivers.position[*i].distance(first)).fold(0.0, f32::max);
        let reach = if self.first_decides { 0.0 } else { farthest };
        let mut by_effect: Vec<(f32, usize)> = self
            .spheres
            .iter()
            .enumerate()
            .map(|(i, sphere)| (strength * most_covered(first, reach, sphere), i))
            .collect();
        by_effect.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut left = BOUND;
        let mut near: Vec<usize> = Vec::new();
        for (effect, i) in by_effect {
            left -= effect;
            if left < 0.0 {
                near.push(i);
            }
        }
        near.sort_unstable();
        near.into_iter().map(|i| self.spheres[i]).collect()
    }
}

/// The most that a sphere covers at any point within `reach` of `center`.
fn most_covered(center: Vec3, reach: f32, sphere: &Sphere) -> f32 {
    let distance = (center.distance(sphere.center) - reach).max(f32::MIN_POSITIVE);
    (sphere.radius / distance).min(1.0).powi(2)
}

/// Valid receivers by the cell in which they lie.
fn clusters(receivers: &Receivers) -> Vec<Vec<usize>> {
    let mut cells: HashMap<IVec3, Vec<usize>> = HashMap::new();
    for i in (0..receivers.len()).filter(|i| receivers.valid[*i]) {
        cells.entry((receivers.position[i] / CELL).floor().as_ivec3()).or_default().push(i);
    }
    cells.into_values().collect()
}
