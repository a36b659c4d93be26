//! Spheres above the field: their visibility by the sum of logs, as SHEXP has it (Ren et al. 2006).

use halflight_blockers::{Blockers, Gather, Tally, fill_open, params};
use halflight_contract::{Job, Meter, Params, Result};
use halflight_proxies::{PosedSpheres, Proxy, blockers, proxies};
use halflight_scenes::{Frame, Receivers, Scene};
use halflight_sh::{self as sh, Batch, BatchExp, Block, LANES, SquaringRule, coefficients};

/// Sphere sets of what casts beside the field.
pub(crate) struct Casters<'s> {
    scene: &'s Scene,
    proxies: Vec<Option<Proxy>>,
    posed: PosedSpheres,
}

/// One task's scratch.
pub(crate) struct Scratch {
    exp: BatchExp<f32>,
    log: Vec<Block<f32>>,
    zonal: Vec<Block<f32>>,
}

impl Scratch {
    pub(crate) fn new(order: usize) -> Scratch {
        Scratch {
            exp: BatchExp::new(Batch::new(order)),
            log: vec![Block::ZERO; coefficients(order)],
            zonal: Vec::new(),
        }
    }
}

impl<'s> Casters<'s> {
    pub(crate) fn prepare(job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Casters<'s>> {
        let proxies = proxies(job, job.params.int(params::SPHERES.name), meter)?;
        Ok(Casters { scene: job.scene, proxies, posed: PosedSpheres::default() })
    }

    pub(crate) fn update(&mut self, frame: &Frame) {
        self.posed = blockers(self.scene, frame, &self.proxies);
    }

    pub(crate) fn bytes(&self) -> usize {
        let PosedSpheres { spheres, object } = &self.posed;
        let sets: usize = self.proxies.iter().flatten().map(Proxy::bytes).sum();
        sets + size_of_val(&spheres[..]) + size_of_val(&object[..])
    }

    /// Writes the visibility at up to 16 receivers, a lane each.
    pub(crate) fn visibility(
        &self,
        how: &Params,
        receivers: &Receivers,
        group: &[usize],
        scratch: &mut Scratch,
        tally: &mut Tally,
        out: &mut [Block<f32>],
    ) {
        let Scratch { exp, log, zonal } = scratch;
        let (gather, batch): (Gather, Batch) = (params::gather(how), exp.batch());
        let spheres = Blockers { spheres: &self.posed.spheres, ratios: &[] };
        log.fill(Block::ZERO);
        let counts = gather.circles(receivers, group, spheres, tally, |circles| {
            zonal.resize(batch.order() * circles.sines.len(), Block::ZERO);
            batch.circle_logs(&circles.sines, zonal);
            batch.sum_zonal(zonal, &circles.axes, log);
        });
        let mut work = [sh::Work::default(); LANES];
        exp.hybrid(SquaringRule::default(), log, out, &mut work[..group.len()]);
        let open = counts.iter().enumerate().filter(|(_, count)| **count == 0);
        open.for_each(|(lane, _)| fill_open(out, lane));
    }
}
