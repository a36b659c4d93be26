//! Direct light under sphere blockers: the phases that all such methods share.

use halflight_contract::{
    Error, Flow, Footprint, Job, Meter, Output, ParamSpec, Params, Prepared, Quantity, Result, counted, timed,
};
use halflight_scenes::{Frame, Receivers};
use halflight_sh::{Batch, Block};
use rayon::prelude::*;

use crate::bake::Bake;
use crate::clustered::{self, Clustered};
use crate::cut::{Cut, Rule, Visits};
use crate::shading::Shading;
use crate::stage::Stage;
use crate::{Blockers, Circles, Gather, Tally, params};

/// Receivers that one task handles.
const CHUNK: usize = 256;

/// How the circles at receivers become visibility, 16 receivers side by side. A value is a method's setting; its `State` one
/// task's scratch.
pub trait Accumulator: Send + Sync + Sized + 'static {
    /// Scratch, reused from one 16 receivers to the next.
    type State: Send;
    /// The method's parameters, those of [`params`] included.
    const PARAMS: &'static [ParamSpec];

    /// Its twin on the GPU, if it has one: WGSL behind [`halflight_sh::wgsl`] and `direct.wgsl`, whose functions and types it may use. It
    /// declares
    ///
    /// - `fn begin()`, called before a receiver's circles,
    /// - `fn block(circle: Circle, before: u32, place: u32)`, for each circle, with the number of those before it and the place of its
    ///   sphere, by which `matched(log, place)` scales the circle's log if the method declares [`params::CUT`],
    /// - `fn finish(circles: u32) -> Vector`, the visibility if there was a circle; it adds the SH operations spent to `work`.
    ///
    /// and, if it declares [`params::BAKE`], `fn set_kept(sum: Vector)`, which sets after `begin` what [`Accumulator::kept`] gave.
    ///
    /// State between them is in `var<private>`.
    const SHADER: Option<&'static str> = None;

    /// Settings from parameters.
    fn new(params: &Params) -> Self;
    /// The same for [`Accumulator::SHADER`], which finds them at `settings.method`.
    fn shader_settings(_: &Params) -> [f32; 4] {
        [0.0; 4]
    }
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
    params: Params,
    /// Without the blockers that are baked.
    stage: Stage<'s>,
    gather: Gather,
    /// The blockers that never move, if they are baked.
    bake: Option<Bake>,
    /// None if every receiver sees every sphere.
    cuts: Option<(Rule, Clustered)>,
    accumulator: A,
    result: Vec<f32>,
    quantity: Quantity,
}

impl<'s, A: Accumulator> DirectLight<'s, A> {
    /// Derives sphere sets and light.
    pub fn prepare(job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Self> {
        let mut stage = Stage::derive(job, meter)?;
        let bake = Bake::take::<A>(job, &mut stage);
        let cuts = params::cut(job.params, A::PARAMS).map(|rule| (rule, Clustered::new(job.scene, &stage.proxies)));
        Ok(DirectLight {
            params: job.params.clone(),
            stage,
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
        let blockers = Blockers { spheres: &self.stage.spheres.spheres, ratios: &[] };
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
        let forest = clustered.forest(&self.stage.spheres);
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
        let how = (self.gather, params::accumulated_order(&self.params));
        if let Some(bake) = &mut self.bake {
            bake.fill(&self.accumulator, how, receivers, meter);
        }
    }

    fn shading(&self) -> Shading<'_, A> {
        Shading {
            accumulator: &self.accumulator,
            bake: self.bake.as_ref(),
            batch: Batch::new(self.stage.order),
            fine: Batch::new(params::accumulated_order(&self.params)),
            gather: self.gather,
            quantity: self.quantity,
            guard: self.params.flag(params::GUARD.name),
            light_window: &self.stage.light_window,
            lamps: &self.stage.lamps,
            lobes: self.stage.lobes.as_ref(),
            visibility_window: self.stage.visibility_window(&self.params),
            light: self.stage.windowed_light(),
        }
    }
}

impl<A: Accumulator> Prepared for DirectLight<'_, A> {
    fn footprint(&self) -> Footprint {
        let cuts = self.cuts.iter().flat_map(|(_, clustered)| clustered.bytes());
        let footprint = self.stage.footprint().host("result", size_of_val(self.result.as_slice()));
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
        self.stage.update(frame, meter);
        if let Some((_, clustered)) = &mut self.cuts {
            clustered.update(&self.stage.spheres, &frame.receivers, &self.params, meter);
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

pub(crate) fn report(meter: &mut dyn Meter, receivers: &Receivers, tally: &Tally, work: &Work) {
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
