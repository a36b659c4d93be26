//! The family on a graphics processor: [`crate::prepared::Terrain`] with a thread for each receiver, its horizons one for each azimuth.
//!
//! What a frame needs is uploaded in `update` if it is new: the field, steps and wedges of the lights' swaths, receivers. Levels are made
//! there. Horizons, visibility and radiance are passes of `evaluate`, and stay on the device until `read`.

mod seers;
#[cfg(test)]
mod tests;
mod views;
mod words;
mod work;

use std::ops::Range;
use std::sync::Arc;

use halflight_blockers::Tally;
use halflight_contract::{
    Error, Flow, Footprint, Job, Meter, Output, Params, Phase, Prepared, Quantity, Result, counted, timed,
};
use halflight_gpu::{Access, Gpu, Part, Pass, Pipeline, Resident};
use halflight_horizons::GpuPyramid;
use halflight_scenes::{Frame, Shape};
use halflight_sh::coefficients;

use crate::Variant;
use crate::params::{self, ORDER};
use crate::plan::{Plan, Planner, visibility_window};
use crate::prepared::{field_of, report};
use crate::shading::Ground;
use seers::Seers;
use views::Views;

/// What is done to a shader's text before it is compiled.
pub(crate) type Edit = Box<dyn Fn(String) -> String + Send>;

/// A member of the family made ready for a scene.
pub(crate) struct GpuTerrain {
    gpu: Arc<Gpu>,
    variant: Variant,
    params: Params,
    edit: Edit,
    /// The field's object.
    object: usize,
    planner: Planner,
    plan: Option<Plan>,
    pyramid: GpuPyramid,
    add: Arc<Pipeline>,
    shade: Arc<Pipeline>,
    /// The field, its columns and rows.
    ground: Option<(Ground, [usize; 2])>,
    seers: Seers,
    views: Views,
    elevations: Resident,
    visibility: Resident,
    results: Resident,
    quantity: Quantity,
}

impl GpuTerrain {
    /// Opens the device, derives lights and tables, compiles.
    pub(crate) fn prepare(variant: &Variant, job: &Job<'_, '_>, meter: &mut dyn Meter, edit: Edit) -> Result<Self> {
        use Access::{Read, Write};
        let gpu = timed(meter, "open device", |_| Gpu::shared(job.backend))?;
        let order = job.params.int(ORDER.name);
        let (object, planner) = (field_of(variant, job)?, Planner::prepare(variant, job, meter)?);
        let compiled = timed(meter, "compile shaders", |_| {
            let [add, shade] = [words::wedges_text(order), words::shade_text(order)].map(&edit);
            let add = gpu.pipeline("wedges", &add, &[Read, Read, Read, Read, Read, Write])?;
            let shade = gpu.pipeline("shade", &shade, &[Read, Read, Read, Write])?;
            Ok::<_, Error>((add, shade, pyramid(&gpu, job.params, &edit)?))
        });
        let (add, shade, pyramid) = compiled?;
        let [elevations, visibility, results] = ["elevations", "visibility", "results"].map(Resident::new);
        Ok(GpuTerrain {
            gpu,
            variant: *variant,
            params: job.params.clone(),
            edit,
            object,
            planner,
            plan: None,
            pyramid,
            add,
            shade,
            ground: None,
            seers: Seers::new(),
            views: Views::default(),
            elevations,
            visibility,
            results,
            quantity: Quantity::Direct,
        })
    }

    /// Uploads how a plan's views are looked at.
    fn set(&mut self, plan: &Plan, meter: &mut dyn Meter) -> Result<()> {
        let order = self.params.int(ORDER.name);
        let window = visibility_window(&self.params, order).unwrap_or_else(|| vec![1.0; order]);
        let wanted = match self.quantity {
            Quantity::Visibility { .. } => self.quantity.channels(),
            _ => coefficients(order),
        };
        let settings = |view: usize| words::view(&plan.views[view], wanted, view > 0, &window);
        self.views.set(&self.gpu, meter, settings)
    }

    /// Runs the passes over all receivers, as many at a time as bindings hold.
    fn run(&mut self, plan: &Plan, meter: &mut dyn Meter) -> Result<()> {
        let size = 4 * coefficients(self.params.int(ORDER.name)) as u64;
        let azimuths = 4 * plan.azimuths.len() as u64;
        let largest = size.max(azimuths).max(seers::BYTES);
        let parts: Vec<Range<u64>> = self.gpu.parts(self.seers.len(), largest).collect();
        let most = parts.first().map_or(0, |first| first.end);
        self.elevations.reserve(&self.gpu, azimuths * most)?;
        match self.quantity {
            Quantity::Visibility { .. } => parts.into_iter().try_for_each(|part| self.see(plan, part, meter)),
            _ => {
                self.visibility.reserve(&self.gpu, size * most)?;
                parts.into_iter().try_for_each(|part| self.light(plan, part, meter))
            }
        }
    }

    /// Visibilities of some receivers through the complete swath, which is the last view.
    fn see(&self, plan: &Plan, part: Range<u64>, meter: &mut dyn Meter) -> Result<()> {
        let (places, results) = (self.seers.places(&part), self.results_of(&part));
        let looks = self.pyramid.buffers(places, self.elevations.whole());
        let sums = self.sum(plan.views.len() - 1, places, results);
        let threads = part.end - part.start;
        let sum = Pass { name: "wedges", pipeline: &self.add, buffers: &sums, threads };
        self.gpu.run(&[self.pyramid.pass(&looks, threads), sum], meter)?;
        self.pyramid.tell_horizons(threads, meter);
        work::tell_seen(plan, threads, self.quantity.channels() as u64, meter);
        Ok(())
    }

    /// Radiance of some receivers by all views.
    fn light(&self, plan: &Plan, part: Range<u64>, meter: &mut dyn Meter) -> Result<()> {
        let (places, visibility) = (self.seers.places(&part), self.visibility.whole());
        let (seers, results) = (self.seers.receivers(&part), self.results_of(&part));
        let looks = self.pyramid.buffers(places, self.elevations.whole());
        let views = 0..plan.views.len();
        let sums: Vec<_> = views.clone().map(|view| self.sum(view, places, visibility)).collect();
        let lights: Vec<_> = views.map(|view| [self.views.parts(view)[0], seers, visibility, results]).collect();
        let threads = part.end - part.start;
        let mut passes = vec![self.pyramid.pass(&looks, threads)];
        for (sum, light) in sums.iter().zip(&lights) {
            passes.push(Pass { name: "wedges", pipeline: &self.add, buffers: sum, threads });
            passes.push(Pass { name: "shade", pipeline: &self.shade, buffers: light, threads });
        }
        self.gpu.run(&passes, meter)?;
        self.pyramid.tell_horizons(threads, meter);
        work::tell_lit(plan, threads, meter);
        Ok(())
    }

    /// Buffers of a view's wedges.
    fn sum<'a>(&'a self, view: usize, places: Part<'a>, out: Part<'a>) -> [Part<'a>; 6] {
        let [settings, wedges, tables] = self.views.parts(view);
        [settings, wedges, tables, places, self.elevations.whole(), out]
    }

    /// Results of some receivers.
    fn results_of(&self, part: &Range<u64>) -> Part<'_> {
        self.results.items(part.clone(), 4 * self.quantity.channels() as u64)
    }
}

fn pyramid(gpu: &Arc<Gpu>, params: &Params, edit: &Edit) -> Result<GpuPyramid> {
    Ok(GpuPyramid::new(gpu, params::settings(params), params::border(params), edit)?)
}

impl Prepared for GpuTerrain {
    fn footprint(&self) -> Footprint {
        let ([tables, lights], (host, receivers)) = (self.planner.bytes(), self.seers.bytes());
        let [uploaded, views] = self.views.bytes();
        Footprint::default()
            .host("wedge tables (shared)", tables)
            .host("lights (shared)", lights)
            .host("receivers", host)
            .device("wedge tables", uploaded)
            .device("wedges and lights", views)
            .device("receivers", receivers)
            .device("pyramid", self.pyramid.bytes())
            .device("horizons", self.elevations.bytes())
            .device("visibility", self.visibility.bytes())
            .device("result", self.results.bytes())
    }

    fn retune(&mut self, params: &Params) -> Result<()> {
        let before = self.params.clone();
        params.retune(&mut self.params, self.variant.info.params)?;
        if params.first_change(&before, self.variant.info.params) == Some(Phase::Update) {
            self.pyramid = pyramid(&self.gpu, &self.params, &self.edit)?;
            self.plan = None;
        }
        Ok(())
    }

    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        let (plan, aimed) = self.planner.renew(self.plan.take(), frame, &self.params, meter);
        let posed = &frame.objects[self.object];
        let shape = posed.in_place();
        let Shape::Heights(field) = &*shape else {
            return Err(Error::Input("the height field became something else".into()));
        };
        let ground = (Ground::new(self.object, field), [field.columns(), field.rows()]);
        timed(meter, "upload and make levels", |meter| {
            if aimed {
                self.views.show(&self.gpu, &plan, meter)?;
            }
            let made = self.pyramid.update(field, posed.revision, &plan.azimuths, meter)?;
            counted(meter, &[("levels made", made.levels as u64), ("azimuths aimed", made.azimuths as u64)]);
            self.seers.sync(&self.gpu, &frame.receivers, ground, meter)
        })?;
        (self.plan, self.ground) = (Some(plan), Some(ground));
        Ok(())
    }

    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        let (Some(plan), Some(ground)) = (self.plan.take(), self.ground) else {
            return Err(Error::Input("evaluate before update".into()));
        };
        let result = self.evaluate_plan(frame, &plan, ground, quantity, meter);
        self.plan = Some(plan);
        result
    }

    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()> {
        let channels = self.quantity.channels();
        let count = self.seers.len() as usize * channels;
        let values: Vec<f32> = self.gpu.download(&self.results, count, meter)?;
        out.fill(self.quantity, &self.seers.spread(&values, channels))
    }
}

impl GpuTerrain {
    fn evaluate_plan(
        &mut self,
        frame: &Frame,
        plan: &Plan,
        ground: (Ground, [usize; 2]),
        quantity: Quantity,
        meter: &mut dyn Meter,
    ) -> Result<()> {
        self.quantity = quantity;
        let receivers = frame.receivers.as_ref();
        if meter.progress("receivers", 0, receivers.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        self.seers.sync(&self.gpu, receivers, ground, meter)?;
        let values = self.seers.len() as usize * quantity.channels();
        if plan.views.is_empty() {
            self.results.upload(&self.gpu, meter, &vec![0.0f32; values])?;
        } else {
            self.results.reserve(&self.gpu, 4 * values as u64)?;
            self.set(plan, meter)?;
            timed(meter, "horizons, wedges and shading", |meter| self.run(plan, meter))?;
        }
        let samples = self.pyramid.samples() * plan.azimuths.len();
        report(receivers, plan, samples as f64, plan.views.len(), &Tally::default(), meter);
        Ok(())
    }
}
