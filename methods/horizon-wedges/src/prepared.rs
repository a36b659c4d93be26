//! The phases: tables and lights once, views and horizons a frame, then receivers.

use halflight_blockers::Tally;
use halflight_contract::{
    Error, Flow, Footprint, Job, Meter, Output, Params, Phase, Prepared, Quantity, Result, counted, timed,
};
use halflight_horizons::{Horizons, Made};
use halflight_scenes::{Frame, HeightField, Receivers, Revision, Shape};
use halflight_sh::Batch;
use rayon::prelude::*;

use crate::Variant;
use crate::casters::Casters;
use crate::params::ORDER;
use crate::plan::{Plan, Planner, visibility_window};
use crate::shading::{CHUNK, Ground, Shading};

/// A member of the family made ready for a scene.
pub(crate) struct Terrain<'s> {
    variant: Variant,
    params: Params,
    /// The field's object.
    object: usize,
    planner: Planner,
    plan: Option<Plan>,
    horizons: Box<dyn Horizons>,
    /// The field that horizons were made for; none if they are to be made anew.
    revision: Option<Revision>,
    ground: Option<Ground>,
    casters: Option<Casters<'s>>,
    result: Vec<f32>,
    quantity: Quantity,
}

impl<'s> Terrain<'s> {
    /// Derives lights and tables.
    pub(crate) fn prepare(variant: &Variant, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Self> {
        Ok(Terrain {
            variant: *variant,
            params: job.params.clone(),
            object: field_of(variant, job)?,
            planner: Planner::prepare(variant, job, meter)?,
            plan: None,
            horizons: (variant.horizons)(job.params),
            revision: None,
            ground: None,
            casters: variant.casters.then(|| Casters::prepare(job, meter)).transpose()?,
            result: Vec::new(),
            quantity: Quantity::Direct,
        })
    }

    /// Horizons of a field under the plan's azimuths.
    fn find(&mut self, field: &HeightField, plan: &Plan) -> Made {
        self.ground = Some(Ground::new(self.object, field));
        self.horizons.update(field, &plan.azimuths)
    }

    fn report(&self, receivers: &Receivers, tally: &Tally, meter: &mut dyn Meter) {
        let Some(plan) = &self.plan else { return };
        let samples = (0..plan.azimuths.len()).map(|azimuth| self.horizons.work(azimuth).samples).sum();
        let products = plan.views.len() * if self.casters.is_some() { 2 } else { 1 };
        report(receivers, plan, samples, products, tally, meter);
    }
}

/// The object that is the scene's one field.
pub(crate) fn field_of(variant: &Variant, job: &Job<'_, '_>) -> Result<usize> {
    let fields = job.scene.objects.iter().enumerate();
    let mut fields = fields.filter(|(_, object)| object.casts && matches!(*object.shape, Shape::Heights(_)));
    let (Some((object, _)), None) = (fields.next(), fields.next()) else {
        let what = "a scene without exactly one height field that casts".into();
        return Err(Error::Unsupported { method: variant.info.id, what });
    };
    Ok(object)
}

/// Tells the work that receivers took, samples of heights and products for each.
pub(crate) fn report(
    receivers: &Receivers,
    plan: &Plan,
    samples: f64,
    products: usize,
    tally: &Tally,
    meter: &mut dyn Meter,
) {
    let valid = receivers.valid.iter().filter(|valid| **valid).count() as u64;
    let amounts = [
        ("receivers", valid),
        ("horizons", valid * plan.azimuths.len() as u64),
        ("height samples", (valid as f64 * samples) as u64),
        ("wedges", valid * plan.wedges() as u64),
        ("products", valid * products as u64),
        ("blockers accumulated", tally.accumulated),
        ("blockers removed by self-shadow rules", tally.removed),
        ("blockers below the smallest angle", tally.too_small),
    ];
    counted(meter, &amounts);
}

impl Prepared for Terrain<'_> {
    fn footprint(&self) -> Footprint {
        let [tables, lights] = self.planner.bytes();
        Footprint::default()
            .host("wedge tables (shared)", tables)
            .host("lights (shared)", lights)
            .host("horizons", self.horizons.footprint())
            .host("sphere sets and posed spheres", self.casters.as_ref().map_or(0, Casters::bytes))
            .host("result", size_of_val(&self.result[..]))
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        let before = self.params.clone();
        params.retune(&mut self.params, self.variant.info.params)?;
        if params.first_change(&before, self.variant.info.params) == Some(Phase::Update) {
            self.horizons = (self.variant.horizons)(params);
            (self.plan, self.revision) = (None, None);
        }
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        let (plan, aimed) = self.planner.renew(self.plan.take(), frame, &self.params, meter);
        let posed = &frame.objects[self.object];
        if aimed || self.revision != Some(posed.revision) {
            if let Shape::Heights(field) = &*posed.in_place() {
                let made = timed(meter, "pyramid or sweep", |_| self.find(field, &plan));
                counted(meter, &[("levels made", made.levels as u64), ("azimuths aimed", made.azimuths as u64)]);
            }
            self.revision = Some(posed.revision);
        }
        self.plan = Some(plan);
        if let Some(casters) = &mut self.casters {
            timed(meter, "pose spheres", |_| casters.update(frame));
        }
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        let (Some(plan), Some(ground)) = (&self.plan, self.ground) else {
            return Err(Error::Input("evaluate before update".into()));
        };
        let receivers = frame.receivers.as_ref();
        self.quantity = quantity;
        self.result.clear();
        self.result.resize(receivers.len() * quantity.channels(), 0.0);
        if meter.progress("receivers", 0, receivers.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        let mut result = std::mem::take(&mut self.result);
        let order = self.params.int(ORDER.name);
        let window = visibility_window(&self.params, order);
        let shading = Shading {
            ground,
            horizons: self.horizons.as_ref(),
            plan,
            batch: Batch::new(order),
            quantity,
            params: &self.params,
            ambient: self.variant.ambient,
            casters: self.casters.as_ref(),
            window: window.as_deref(),
        };
        let chunks = result.par_chunks_mut(CHUNK * quantity.channels()).enumerate();
        let tally = timed(meter, "horizons, wedges and shading", |_| {
            let shaded = chunks.map(|(chunk, out)| shading.chunk(receivers, chunk * CHUNK, out));
            shaded.reduce(Tally::default, |a, b| a + b)
        });
        self.result = result;
        self.report(receivers, &tally, meter);
        Ok(())
    }

    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        out.fill(self.quantity, &self.result)
    }
}
