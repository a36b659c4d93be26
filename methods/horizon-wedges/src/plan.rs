//! Which lights are seen through which swath.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::Vec3;
use halflight_contract::{Job, Meter, Params, Result, counted, timed};
use halflight_horizons::{Azimuth, Purpose};
use halflight_light::{EachLightOf, SceneLight};
use halflight_scenes::{Frame, KeyLight, Light, Revision, Rgb};
use halflight_sh::{apply_bands, coefficients};

use crate::key::{self, Level, Opening};
use crate::params::{AZIMUTHS, KEY_AZIMUTHS, KEY_LEVEL, ORDER, SWATH, WINDOW_VISIBILITY};
use crate::swath::{Swath, Wedge};
use crate::table::{Wedges, WedgesOf};
use crate::{Keys, Variant};

/// Lights that share a swath.
pub(crate) struct View {
    /// Number of its first azimuth among all.
    pub(crate) first: usize,
    pub(crate) azimuths: usize,
    pub(crate) wedges: Vec<Wedge>,
    pub(crate) tables: Arc<Wedges>,
    /// Radiance in SH, each colour.
    pub(crate) light: [Vec<f32>; 3],
}

/// A key light that its centre stands for.
pub(crate) struct Sun {
    /// Number of its azimuth.
    pub(crate) azimuth: usize,
    /// Radians.
    pub(crate) elevation: f32,
    pub(crate) direction: Vec3,
    /// Over π, at a receiver that faces it.
    pub(crate) irradiance: Rgb,
}

/// All views of a frame.
#[derive(Default)]
pub(crate) struct Plan {
    /// Of the lights that they are for.
    pub(crate) lights: Vec<Revision>,
    /// Tables that were made for it, since no frame of the scene has such a light.
    pub(crate) tables: u64,
    pub(crate) azimuths: Vec<Azimuth>,
    pub(crate) views: Vec<View>,
    pub(crate) suns: Vec<Sun>,
}

/// What makes plans.
pub(crate) struct Planner {
    keys: Keys,
    order: usize,
    complete: Swath,
    key_azimuths: usize,
    /// Radians; 0: as each light asks.
    extent: f64,
    /// Whether the complete swath is for all lights.
    whole: bool,
    each: Arc<Vec<SceneLight>>,
    window: Option<Vec<f32>>,
    /// By the bits of the wedges' extents.
    tables: HashMap<u64, Arc<Wedges>>,
}

impl Planner {
    /// Derives the lights, and tables for all swaths of the scene's frames.
    pub(crate) fn prepare(variant: &Variant, job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Planner> {
        let order = job.params.int(ORDER.name);
        let partial = variant.keys == Keys::Partial;
        let degrees = if partial { job.params.float(SWATH.name) } else { 0.0 };
        let mut planner = Planner {
            keys: variant.keys,
            order,
            complete: Swath::complete(job.params.int(AZIMUTHS.name)),
            key_azimuths: if partial { job.params.int(KEY_AZIMUTHS.name) } else { 1 },
            extent: degrees.to_radians(),
            whole: variant.keys == Keys::Complete || degrees >= 360.0,
            each: job.derive(&EachLightOf { order }, meter)?,
            window: job.params.flag(halflight_blockers::params::WINDOW_LIGHT.name).then(|| bands(order)),
            tables: HashMap::new(),
        };
        let times = (0..job.scene.frame_count).map(|frame| frame as f32 / job.scene.fps);
        let lights = job.scene.lights.iter();
        let partial = lights.flat_map(|light| times.clone().map(move |time| light.at(time)));
        let swaths: Vec<Swath> = partial.filter_map(|light| planner.swath(&light)).collect();
        for swath in swaths.into_iter().chain([planner.complete]) {
            if let Entry::Vacant(slot) = planner.tables.entry(swath.step.to_bits()) {
                slot.insert(job.derive(&WedgesOf { order, extent: swath.step }, meter)?);
            }
        }
        Ok(planner)
    }

    /// The swath of a light that is seen apart.
    fn swath(&self, light: &Light) -> Option<Swath> {
        match light {
            Light::Key(key) if self.keys == Keys::Partial && !self.whole => {
                key::swath(key, self.extent, self.key_azimuths)
            }
            _ => None,
        }
    }

    /// Tables for a swath, made now where a light stands as at no frame of the scene, and whether they were.
    fn tables(&mut self, swath: &Swath) -> (Arc<Wedges>, bool) {
        match self.tables.entry(swath.step.to_bits()) {
            Entry::Occupied(known) => (known.get().clone(), false),
            Entry::Vacant(slot) => (slot.insert(Arc::new(Wedges::new(self.order, swath.step))).clone(), true),
        }
    }

    /// The plan of a frame, the last one if it still fits, and whether it is new.
    pub(crate) fn renew(
        &mut self,
        last: Option<Plan>,
        frame: &Frame,
        params: &Params,
        meter: &mut dyn Meter,
    ) -> (Plan, bool) {
        if let Some(kept) = last.filter(|plan| plan.fits(frame)) {
            return (kept, false);
        }
        let plan = timed(meter, "aim at lights", |_| self.plan(frame, params));
        counted(meter, &[("wedges aimed", plan.wedges() as u64), ("wedge tables made", plan.tables)]);
        (plan, true)
    }

    /// The views of a frame's lights.
    fn plan(&mut self, frame: &Frame, params: &Params) -> Plan {
        let mut plan = Plan { lights: revisions(frame).collect(), ..Plan::default() };
        let mut around = [0; 3].map(|_| vec![0.0; coefficients(self.order)]);
        let each = self.each.clone();
        let visibility_window = visibility_window(params, self.order);
        for (light, sh) in frame.lights().zip(each.iter()) {
            match (light, self.swath(light)) {
                (Light::Key(key), Some(swath)) => {
                    let level = Level::named(params.choice(KEY_LEVEL.name));
                    let (tables, made) = self.tables(&swath);
                    plan.tables += u64::from(made);
                    let wedges = swath.wedges(self.order);
                    let opening = Opening {
                        tables: &tables,
                        wedges: &wedges,
                        light_window: self.window.as_deref(),
                        visibility_window: visibility_window.as_deref(),
                    };
                    let light = key::light(key, level, &opening);
                    plan.view(&swath, Purpose::Key, wedges, tables, light);
                }
                (Light::Key(key), None) if self.keys == Keys::Hard => plan.sun(key),
                _ => {
                    for (sum, channel) in around.iter_mut().zip(&sh.at(frame.time).rgb) {
                        sum.iter_mut().zip(channel).for_each(|(sum, value)| *sum += value);
                    }
                }
            }
        }
        if self.whole || around.iter().flatten().any(|value| *value != 0.0) {
            let (swath, light) = (self.complete, self.windowed(around));
            let purpose = if self.whole { Purpose::Key } else { Purpose::Environment };
            let (tables, made) = self.tables(&swath);
            plan.tables += u64::from(made);
            plan.view(&swath, purpose, swath.wedges(self.order), tables, light);
        }
        plan
    }

    fn windowed(&self, mut light: [Vec<f32>; 3]) -> [Vec<f32>; 3] {
        if let Some(window) = &self.window {
            light.iter_mut().for_each(|channel| apply_bands(window, channel));
        }
        light
    }

    /// Bytes of tables and of lights.
    pub(crate) fn bytes(&self) -> [usize; 2] {
        let tables = self.tables.values().map(|tables| tables.bytes()).sum();
        [tables, self.each.iter().map(SceneLight::bytes).sum()]
    }
}

fn revisions(frame: &Frame) -> impl Iterator<Item = Revision> {
    frame.lights.iter().map(|light| light.revision)
}

impl Plan {
    /// Whether it is for lights as a frame has them.
    pub(crate) fn fits(&self, frame: &Frame) -> bool {
        self.lights.iter().copied().eq(revisions(frame))
    }

    /// The number of wedges of all views.
    pub(crate) fn wedges(&self) -> usize {
        self.views.iter().map(|view| view.wedges.len()).sum()
    }

    fn view(&mut self, swath: &Swath, purpose: Purpose, wedges: Vec<Wedge>, tables: Arc<Wedges>, light: [Vec<f32>; 3]) {
        let first = self.azimuths.len();
        self.azimuths.extend(swath.azimuths().map(|angle| Azimuth { angle, purpose }));
        self.views.push(View { first, azimuths: swath.count, wedges, tables, light });
    }

    fn sun(&mut self, key: &KeyLight) {
        let (azimuth, direction) = (self.azimuths.len(), key.direction);
        let elevation = direction.z.atan2(direction.truncate().length());
        let sine = f64::from(key.angular_radius).min(FRAC_PI_2).sin();
        self.azimuths.push(Azimuth { angle: direction.y.atan2(direction.x), purpose: Purpose::Key });
        self.suns.push(Sun { azimuth, elevation, direction, irradiance: key.radiance * (sine * sine) as f32 });
    }
}

/// The factors by which bands of visibility are attenuated, if they are.
pub(crate) fn visibility_window(params: &Params, order: usize) -> Option<Vec<f32>> {
    params.flag(WINDOW_VISIBILITY.name).then(|| bands(order))
}

/// The factors of windows.
fn bands(order: usize) -> Vec<f32> {
    halflight_sh::window(order, 2.0 * order as f64).iter().map(|alpha| *alpha as f32).collect()
}
