//! Direct light under sphere blockers: the phases that all such methods share.

use std::sync::Arc;

use halflight_contract::{
    Error, Flow, Footprint, Job, Meter, Output, ParamSpec, Params, Prepared, Quantity, Request, Result, Support,
    counted, timed,
};
use halflight_light::{LightOf, SceneLight, ShLight};
use halflight_proxies::{PosedSpheres, Proxy, blockers, proxies};
use halflight_scenes::{Frame, Receivers, Scene, SceneFacts};
use halflight_sh::{Batch, Block, apply_bands, coefficients, window};
use rayon::prelude::*;

use crate::bake::Bake;
use crate::clustered::{self, Clustered};
use crate::cut::{Cut, Rule, Visits};
use crate::lamps::{Lamp, Lobes, is_lamp, lamps};
use crate::shading::Shading;
use crate::{Blockers, Circles, Gather, Tally, params};

/// Receivers that one task handles.
const CHUNK: usize = 256;

/// How the circles at receivers become visibility, 16 receivers side by side. A value is a method's setting; its `State` one
/// task's scratch.
pub trait Accumulator: Send + Sync + Sized {
    /// Scratch, reused from one 16 receivers to the next.
    type State: Send;
    /// The method's parameters, those of [`params`] included.
    const PARAMS: &'static [ParamSpec];

    /// Settings from parameters.
    fn new(params: &Params) -> Self;
    /// Fresh scratch.
    fn state(&self) -> Self::State;
    /// Starts 16 receivers.
    fn begin(&self, state: &mut Self::State);
    /// Adds blockers: at each receiver the circles in its lane, in the order given. A lane without a circle stays as it is.
    fn block(&self, state: &mut Self::State, circles: &Circles<'_>);
    /// Writes the visibilities, as many blocks as the accumulated order has coefficients, and counts the SH operations spent on
    /// them; lanes beyond the counts are nobody's.
    fn finish(&self, state: &mut Self::State, counts: &Counts<'_>, visibility: &mut [Block<f32>], work: &mut Work);
    /// What has been accumulated so far, a block for each coefficient of the accumulated order, if that is all that there is to know of
    /// it: a method that lets it be read, kept and set again declares [`params::BAKE`].
    fn kept<'s>(&self, _: &'s mut Self::State) -> Option<&'s mut [Block<f32>]> {
        None
    }
}

/// Circles at 16 receivers, or fewer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts<'a> {
    /// All that each receiver sees.
    pub all: &'a [u32],
    /// Those among them that had been accumulated before and were set again.
    pub kept: &'a [u32],
}

/// Writes the visibility of an open sky to a lane.
pub fn fill_open(visibility: &mut [Block<f32>], lane: usize) {
    visibility.iter_mut().for_each(|block| block.0[lane] = 0.0);
    visibility[0].0[lane] = (4.0 * std::f32::consts::PI).sqrt();
}

/// SH operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Vector sums.
    pub additions: u64,
    /// Products of two different vectors.
    pub products: u64,
    /// Squares.
    pub squares: u64,
    /// Receivers whose visibility the overlap guard changed.
    pub guarded: u64,
    /// Circles that were not accumulated, since what they add was known.
    pub kept: u64,
}

/// A [`Prepared`] for direct light around an [`Accumulator`].
pub struct DirectLight<'s, A> {
    scene: &'s Scene,
    params: Params,
    order: usize,
    light: Arc<SceneLight>,
    /// The light now.
    lit: ShLight,
    light_window: Vec<f32>,
    proxies: Vec<Option<Proxy>>,
    spheres: PosedSpheres,
    lamps: Vec<Lamp>,
    /// None if lamps light by shares, or there is none.
    lobes: Option<Lobes>,
    gather: Gather,
    /// The blockers that never move, if they are baked; `proxies` and `spheres` are of the others then.
    bake: Option<Bake>,
    /// None if every receiver sees every sphere.
    cuts: Option<(Rule, Clustered)>,
    accumulator: A,
    result: Vec<f32>,
    quantity: Quantity,
}

/// What sphere-blocker methods answer: direct light of what is distant and of spheres that emit, and visibility up to their own order, where
/// spheres can stand for all that casts shadows. A height field is an open surface: spheres around it would bury the receivers on it.
pub fn supports(facts: &SceneFacts, request: &Request<'_>) -> Support {
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

impl<'s, A: Accumulator> DirectLight<'s, A> {
    /// Derives sphere sets and light.
    pub fn prepare(job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Self> {
        let order = job.params.int(params::ORDER.name);
        let local_lights = job.params.flag(params::LOCAL_LIGHTS.name);
        let mut proxies = proxies(job, job.params.int(params::SPHERES.name), meter)?;
        if local_lights {
            // A lamp must not stand in its own light.
            proxies
                .iter_mut()
                .enumerate()
                .filter(|(object, _)| is_lamp(job.scene, *object))
                .for_each(|(_, proxy)| *proxy = None);
        }
        let light = job.derive(&LightOf { order }, meter)?;
        let light_window = match job.params.flag(params::WINDOW_LIGHT.name) {
            true => bands(order),
            false => vec![1.0; order],
        };
        let lobes = local_lights && job.params.choice(params::LAMPS.name) == "lobe";
        let lobes = lobes && (0..job.scene.objects.len()).any(|object| is_lamp(job.scene, object));
        let lobes = lobes.then(|| timed(meter, "fit lobes", |_| Lobes::new(order, &light_window)));
        let bake = params::bakes(job.params, A::PARAMS).then(|| {
            let mut still = proxies.clone();
            for ((object, moving), still) in job.scene.objects.iter().zip(&mut proxies).zip(&mut still) {
                *(if object.rests() { moving } else { still }) = None;
            }
            Bake::new(blockers(job.scene, &job.scene.frame(0), &still).spheres)
        });
        let cuts = params::cut(job.params, A::PARAMS).map(|rule| (rule, Clustered::new(job.scene, &proxies)));
        Ok(DirectLight {
            scene: job.scene,
            params: job.params.clone(),
            order,
            lit: light.still.clone(),
            light,
            light_window,
            proxies,
            spheres: PosedSpheres::default(),
            lamps: Vec::new(),
            lobes,
            gather: params::gather(job.params),
            bake,
            cuts,
            accumulator: A::new(job.params),
            result: Vec::new(),
            quantity: Quantity::Direct,
        })
    }

    /// Fills the result, all spheres before every receiver.
    fn each(&self, receivers: &Receivers, result: &mut [f32]) -> (Tally, Work, Visits) {
        let (shading, size) = (self.shading(), CHUNK * self.quantity.channels());
        let blockers = Blockers { spheres: &self.spheres.spheres, ratios: &[] };
        let chunks = result.par_chunks_mut(size).enumerate();
        let (tally, work) = chunks
            .map_init(
                || shading.scratch(),
                |scratch, (chunk, out)| shading.chunk(receivers, chunk * CHUNK, blockers, scratch, out),
            )
            .reduce(Default::default, |a, b| (a.0 + b.0, a.1 + b.1));
        (tally, work, Visits::default())
    }

    /// Fills the result cluster by cluster, before each the spheres of its cut.
    fn by_cluster(
        &self,
        rule: Rule,
        clustered: &Clustered,
        receivers: &Receivers,
        result: &mut [f32],
    ) -> (Tally, Work, Visits) {
        let (shading, channels) = (self.shading(), self.quantity.channels());
        let forest = clustered.forest(&self.spheres);
        let shade = |(cut, scratch): &mut (Cut, _), cluster| {
            let visits = forest.cut(rule, self.gather, shading.fine, receivers, cluster, cut);
            let members = clustered.members(cluster);
            let mut out = vec![0.0; members.len() * channels];
            let (tally, work) = shading.shade(receivers, members, cut.blockers(), scratch, |place, values| {
                out[place * channels..][..channels].copy_from_slice(values);
            });
            (out, (tally, work, visits))
        };
        let shaded: Vec<_> =
            clustered.clusters().par_iter().map_init(|| (Cut::default(), shading.scratch()), shade).collect();
        let mut sums = (Tally::default(), Work::default(), Visits::default());
        for (cluster, (out, (tally, work, visits))) in clustered.clusters().iter().zip(shaded) {
            for (&receiver, values) in clustered.members(cluster).iter().zip(out.chunks_exact(channels)) {
                result[receiver * channels..][..channels].copy_from_slice(values);
            }
            sums = (sums.0 + tally, sums.1 + work, sums.2 + visits);
        }
        sums
    }

    /// Accumulates blockers that never move at receivers that lack them.
    fn bake(&mut self, receivers: &Receivers, meter: &mut dyn Meter) {
        let Some(mut bake) = self.bake.take_if(|bake| !bake.missing().is_empty()) else { return };
        let shading = self.shading();
        let baked: Vec<_> = timed(meter, "bake blockers", |_| {
            let chunks = bake.missing().par_chunks(CHUNK);
            chunks.flat_map_iter(|numbers| shading.accumulated(receivers, numbers, &bake.spheres)).collect()
        });
        let circles = baked.iter().map(|(count, _)| u64::from(*count)).sum();
        counted(meter, &[("receivers baked", baked.len() as u64), ("blockers baked", circles)]);
        bake.store(coefficients(params::accumulated_order(&self.params)), &baked);
        self.bake = Some(bake);
    }

    fn shading(&self) -> Shading<'_, A> {
        Shading {
            accumulator: &self.accumulator,
            bake: self.bake.as_ref(),
            batch: Batch::new(self.order),
            fine: Batch::new(params::accumulated_order(&self.params)),
            gather: self.gather,
            quantity: self.quantity,
            guard: self.params.flag(params::GUARD.name),
            light_window: &self.light_window,
            lamps: &self.lamps,
            lobes: self.lobes.as_ref(),
            visibility_window: self.params.flag(params::WINDOW_VISIBILITY.name).then(|| {
                let mut window = vec![1.0; coefficients(self.order)];
                apply_bands(&bands(self.order), &mut window);
                window
            }),
            light: self.lit.rgb.clone().map(|mut channel| {
                apply_bands(&self.light_window, &mut channel);
                channel
            }),
        }
    }
}

fn bands(order: usize) -> Vec<f32> {
    window(order, 2.0 * order as f64).iter().map(|alpha| *alpha as f32).collect()
}

impl<A: Accumulator> Prepared for DirectLight<'_, A> {
    fn footprint(&self) -> Footprint {
        let proxies = self.proxies.iter().flatten();
        let cuts = self.cuts.iter().flat_map(|(_, clustered)| clustered.bytes());
        let footprint = Footprint::default()
            .host("sphere sets (shared)", proxies.map(Proxy::bytes).sum())
            .host(
                "posed spheres",
                size_of_val(self.spheres.spheres.as_slice()) + size_of_val(self.spheres.object.as_slice()),
            )
            .host("light (shared)", self.light.bytes())
            .host("lobes of lamps", self.lobes.as_ref().map_or(0, Lobes::bytes))
            .host("result", size_of_val(self.result.as_slice()));
        let footprint = match &self.bake {
            Some(bake) => footprint.host("baked blockers", bake.bytes()),
            None => footprint,
        };
        cuts.fold(footprint, |footprint, (purpose, bytes)| footprint.host(purpose, bytes))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        params.retune(&mut self.params, A::PARAMS)?;
        if let (Some((rule, _)), Some(new)) = (&mut self.cuts, params::cut(params, A::PARAMS)) {
            *rule = new;
        }
        self.gather = params::gather(params);
        self.accumulator = A::new(params);
        self.bake.iter_mut().for_each(Bake::clear);
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        self.spheres = timed(meter, "pose spheres", |_| blockers(self.scene, frame, &self.proxies));
        if !self.light.turning.is_empty() {
            self.lit = timed(meter, "turn light", |_| self.light.at(frame.time).into_owned());
        }
        if self.params.flag(params::LOCAL_LIGHTS.name) {
            self.lamps = lamps(self.scene, frame);
        }
        if let Some((_, clustered)) = &mut self.cuts {
            clustered.update(&self.spheres, &frame.receivers, &self.params, meter);
        }
        self.bake.iter_mut().for_each(|bake| bake.move_to(&frame.receivers));
        self.bake(&frame.receivers, meter);
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        let receivers = frame.receivers.as_ref();
        self.quantity = quantity;
        // Parameters may have changed since the update.
        self.bake(receivers, meter);
        self.result.clear();
        self.result.resize(receivers.len() * quantity.channels(), 0.0);
        if meter.progress("receivers", 0, receivers.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        let mut result = std::mem::take(&mut self.result);
        let (tally, work, visits) = timed(meter, "accumulate and shade", |_| match &self.cuts {
            None => self.each(receivers, &mut result),
            Some((rule, clustered)) => self.by_cluster(*rule, clustered, receivers, &mut result),
        });
        self.result = result;
        report(meter, receivers, &tally, &work);
        clustered::report(meter, &visits);
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        out.fill(self.quantity, &self.result)
    }
}

fn report(meter: &mut dyn Meter, receivers: &Receivers, tally: &Tally, work: &Work) {
    let amounts = [
        ("receivers", receivers.valid.iter().filter(|valid| **valid).count() as u64),
        ("blockers accumulated", tally.accumulated),
        ("blockers kept from before", work.kept),
        ("blockers removed by self-shadow rules", tally.removed),
        ("blockers below the smallest angle", tally.too_small),
        ("additions", work.additions),
        ("products", work.products),
        ("squares", work.squares),
        ("receivers guarded", work.guarded),
    ];
    counted(meter, &amounts);
}

impl std::ops::Add for Work {
    type Output = Work;

    fn add(self, other: Work) -> Work {
        Work {
            additions: self.additions + other.additions,
            products: self.products + other.products,
            squares: self.squares + other.squares,
            guarded: self.guarded + other.guarded,
            kept: self.kept + other.kept,
        }
    }
}

#[cfg(test)]
mod tests {
    use halflight_contract::Backend;

    use super::*;

    #[test]
    fn height_fields_that_cast_are_left_to_others() {
        let params = Params::defaults(crate::blocker_params!());
        let request = Request { quantity: Quantity::Direct, backend: Backend::Cpu, params: &params };
        let answer = |height_fields| supports(&SceneFacts { height_fields, ..SceneFacts::default() }, &request);
        assert!(matches!(answer(1), Support::Skip(why) if why.contains("height field")));
        assert!(matches!(answer(0), Support::Exact));
    }
}
