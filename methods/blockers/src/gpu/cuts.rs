//! Cuts on the device: the CPU makes them, shaders walk them.

use halflight_contract::{Meter, Params, Result, timed};
use halflight_gpu::{Gpu, Part, Resident, Revision};
use halflight_proxies::PosedSpheres;
use halflight_scenes::{Receivers, Scene};
use halflight_sh::Batch;
use rayon::prelude::*;

use crate::clustered::{self, Clustered};
use crate::cut::{Cut, Rule, Visits};
use crate::stage::Stage;
use crate::{Accumulator, Gather, params};

/// What shaders read of cuts.
pub(super) struct Cuts {
    clustered: Clustered,
    rule: Rule,
    /// What the cuts on the device were made of.
    made_of: Option<MadeOf>,
    /// A first and a last sphere for each cluster.
    lists: Resident,
    ratios: Resident,
    visits: Visits,
    /// Spheres that receivers look at, of all receivers.
    pub(super) looked_at: u64,
}

#[derive(PartialEq)]
struct MadeOf {
    blockers: Revision,
    clusters: Option<(Revision, usize)>,
    rule: Rule,
    gather: Gather,
    order: usize,
}

impl Cuts {
    /// None if every receiver looks at every sphere.
    pub(super) fn new<A: Accumulator>(scene: &Scene, stage: &Stage<'_>, params: &Params) -> Option<Self> {
        let rule = params::cut(params, A::PARAMS)?;
        Some(Cuts {
            clustered: Clustered::new(scene, &stage.proxies),
            rule,
            made_of: None,
            lists: Resident::new("cuts"),
            ratios: Resident::new("ratio vectors"),
            visits: Visits::default(),
            looked_at: 0,
        })
    }

    pub(super) fn retune<A: Accumulator>(&mut self, params: &Params) {
        self.rule = params::cut(params, A::PARAMS).unwrap_or(self.rule);
    }

    /// Follows blockers and receivers that moved.
    pub(super) fn update(
        &mut self,
        blockers: &PosedSpheres,
        receivers: &Receivers,
        params: &Params,
        meter: &mut dyn Meter,
    ) {
        self.clustered.update(blockers, receivers, params, meter);
    }

    /// Receivers cluster by cluster, each with its cluster's number.
    pub(super) fn members(&self) -> impl Iterator<Item = (u32, u32)> {
        let clusters = (0..).zip(self.clustered.clusters());
        clusters.flat_map(|(number, cluster)| self.clustered.members(cluster).iter().map(move |&i| (i as u32, number)))
    }

    /// What clusters were found for.
    pub(super) fn made_for(&self) -> Option<(Revision, usize)> {
        self.clustered.made_for()
    }

    /// Makes cuts and uploads them, their spheres to `spheres`, unless those on the device are the same.
    pub(super) fn upload(
        &mut self,
        gpu: &Gpu,
        stage: &Stage<'_>,
        receivers: &Receivers,
        params: &Params,
        spheres: &mut Resident,
        meter: &mut dyn Meter,
    ) -> Result<()> {
        let (gather, order) = (params::gather(params), params::accumulated_order(params));
        let made_of = Some(MadeOf { blockers: stage.posed, clusters: self.made_for(), rule: self.rule, gather, order });
        if self.made_of == made_of {
            return Ok(());
        }
        let cuts = timed(meter, "make cuts", |_| self.cuts(&stage.spheres, receivers, gather, order));
        self.made_of = None;
        self.visits = cuts.iter().map(|(_, visits)| *visits).fold(Visits::default(), std::ops::Add::add);
        self.looked_at = 0;
        let (mut lists, mut seen, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
        for (cluster, (cut, _)) in self.clustered.clusters().iter().zip(&cuts) {
            self.looked_at += (cut.spheres.len() * self.clustered.members(cluster).len()) as u64;
            let first = seen.len() as u32;
            seen.extend(super::words(&cut.spheres));
            ratios.extend_from_slice(&cut.ratios);
            lists.push([first, seen.len() as u32]);
        }
        if ratios.is_empty() {
            ratios.resize(order, 1.0); // no buffer ends before its first vector
        }
        spheres.upload(gpu, meter, &seen)?;
        self.lists.upload(gpu, meter, &lists)?;
        self.ratios.upload(gpu, meter, &ratios)?;
        self.made_of = made_of;
        Ok(())
    }

    fn cuts(&self, blockers: &PosedSpheres, receivers: &Receivers, gather: Gather, order: usize) -> Vec<(Cut, Visits)> {
        let (forest, batch) = (self.clustered.forest(blockers), Batch::new(order));
        let cut = |cluster| {
            let mut cut = Cut::default();
            let visits = forest.cut(self.rule, gather, batch, receivers, cluster, &mut cut);
            (cut, visits)
        };
        self.clustered.clusters().par_iter().map(cut).collect()
    }

    /// Spheres of the largest cut.
    pub(super) fn longest(&self) -> u64 {
        self.visits.largest
    }

    /// Whether logs are scaled.
    pub(super) fn scales(&self) -> bool {
        self.rule.ratios
    }

    pub(super) fn report(&self, meter: &mut dyn Meter) {
        clustered::report(meter, &self.visits);
    }

    /// In the order of their bindings.
    pub(super) fn buffers(&self) -> impl Iterator<Item = Part<'_>> {
        [&self.lists, &self.ratios].into_iter().map(Resident::whole)
    }

    /// Host bytes, by purpose.
    pub(super) fn host_bytes(&self) -> [(&'static str, usize); 2] {
        self.clustered.bytes()
    }

    /// Device bytes, by purpose.
    pub(super) fn device_bytes(&self) -> [(&'static str, u64); 2] {
        [("cuts", self.lists.bytes()), ("ratio vectors", self.ratios.bytes())]
    }
}
