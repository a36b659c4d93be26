//! Numbers at their limits: what sphere-blocker methods do under heavy overlap, at extreme sizes, in deep shadow and under strong light.
//!
//! `cargo run --release -p halflight-tests --example stress` writes what [`measure`] finds to `docs/stress.md`, with plots.

mod page;
mod plot;
mod scenes;

pub use page::markdown;
pub use plot::{irradiance, onsets};

use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, Output, Params, Quantity};
use halflight_scenes::{Rgb, Scene};

/// Orders that are tried.
pub const ORDERS: std::ops::RangeInclusive<usize> = 2..=8;

/// Coincident circles that are tried.
pub const COUNTS: [usize; 15] = [1, 2, 3, 5, 7, 10, 15, 20, 30, 60, 100, 200, 300, 500, 1000];

/// Angular radius of coincident circles, in degrees.
pub const ANGLE: f32 = 15.0;

/// Irradiance that coincident circles overhead leave of a uniform sky's, however many they are: `1 − sin²15°`.
pub const TRUTH: f64 = 0.933_012_7;

/// Irradiance beyond what any visibility leaves, shares from 0 to 1, by more than this has diverged.
pub const BEYOND: f64 = 0.05;

/// The light of all cases.
pub const RADIANCE: f32 = 1e5;

/// Everything that was found.
#[derive(Clone, Debug, Default)]
pub struct Stress {
    /// A method and an order each.
    pub overlaps: Vec<Overlap>,
    /// A method, an order and a case each.
    pub cases: Vec<Case>,
    /// Cases whose truth is known, and the most that a receiver truly gets of the open sky there.
    pub brightest: Vec<(&'static str, f64)>,
}

/// Coincident circles overhead.
#[derive(Clone, Debug)]
pub struct Overlap {
    /// The method's id.
    pub method: &'static str,
    /// SH order.
    pub order: usize,
    /// Irradiance as a share of the open sky's for each of [`COUNTS`]: guard off, guard on.
    pub irradiance: [Vec<f64>; 2],
}

impl Overlap {
    /// The first of [`COUNTS`] at which irradiance has diverged, see [`BEYOND`]; guard off or on.
    pub fn onset(&self, guard: bool) -> Option<usize> {
        let possible = -BEYOND..=1.0 + BEYOND;
        let found = self.irradiance[usize::from(guard)].iter().position(|value| !possible.contains(value));
        found.map(|at| COUNTS[at])
    }
}

/// A case of the table.
#[derive(Clone, Debug)]
pub struct Case {
    /// The case's name.
    pub name: &'static str,
    /// The method's id.
    pub method: &'static str,
    /// SH order.
    pub order: usize,
    /// Guard off, guard on.
    pub found: [Found; 2],
}

/// What receivers got.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Receivers whose radiance is not finite.
    pub not_finite: usize,
    /// Receivers whose visibility the guard changed.
    pub guarded: u64,
    /// Receivers.
    pub receivers: usize,
    /// The largest magnitude of radiance as a share of the open sky's.
    pub worst: f64,
    /// The largest error of that share, where the truth is known.
    pub error: Option<f64>,
}

impl Found {
    fn and(self, other: Found) -> Found {
        Found {
            not_finite: self.not_finite + other.not_finite,
            guarded: self.guarded + other.guarded,
            receivers: self.receivers + other.receivers,
            worst: self.worst.max(other.worst),
            error: self.error.into_iter().chain(other.error).reduce(f64::max),
        }
    }
}

/// Those of the methods given that multiply or sum up the circles of spheres.
pub fn sphere_blockers(methods: Vec<&'static dyn Method>) -> Vec<&'static dyn Method> {
    let families = ["sh-product", "shexp"];
    methods.into_iter().filter(|method| families.contains(&method.info().family())).collect()
}

/// Tries the methods given, at every order, with and without the overlap guard.
pub fn measure(methods: &[&'static dyn Method]) -> Stress {
    let (cache, mut stress) = (Cache::in_memory(), Stress::default());
    let coincident = COUNTS.map(scenes::coincident);
    for &method in methods {
        for order in ORDERS {
            let irradiance = [false, true].map(|guard| {
                let setting = Setting { method, order, guard, cache: &cache };
                coincident.iter().map(|scene| f64::from(setting.radiance(scene).0[0].x)).collect()
            });
            stress.overlaps.push(Overlap { method: method.info().id, order, irradiance });
        }
    }
    for scenes::Case { name, scenes, truth } in scenes::cases() {
        if let Some(truth) = &truth {
            stress.brightest.push((name, truth.iter().copied().fold(0.0, f64::max)));
        }
        for &method in methods {
            for order in ORDERS {
                let found = [false, true].map(|guard| {
                    let setting = Setting { method, order, guard, cache: &cache };
                    let found = scenes.iter().map(|scene| setting.found(scene, truth.as_deref()));
                    found.fold(Found::default(), Found::and)
                });
                stress.cases.push(Case { name, method: method.info().id, order, found });
            }
        }
    }
    stress
}

struct Setting<'a> {
    method: &'static dyn Method,
    order: usize,
    guard: bool,
    cache: &'a Cache,
}

impl Setting<'_> {
    /// Radiance at all receivers, and how many were guarded.
    fn radiance(&self, scene: &Scene) -> (Vec<Rgb>, u64) {
        let (order, guard) = (self.order.to_string(), self.guard.to_string());
        let settings = [("order", order.as_str()), ("guard", guard.as_str())];
        let params = Params::resolve(self.method.info().params, settings).expect("all take order and guard");
        let job = Job::new(scene, &params, 1, Backend::Cpu, self.cache);
        let mut guarded = Guarded(0);
        let mut prepared = self.method.prepare(&job, &mut guarded).expect("spheres need no preparation");
        let frame = scene.frame(0);
        prepared.update(&frame, &mut guarded).expect("a frame");
        prepared.evaluate(&frame, Quantity::Direct, &mut guarded).expect("direct light");
        let mut radiance = vec![Rgb::NAN; frame.receivers.len()];
        prepared.read(Output::Radiance(&mut radiance), &mut guarded).expect("as many as receivers");
        (radiance, guarded.0)
    }

    fn found(&self, scene: &Scene, truth: Option<&[f64]>) -> Found {
        let (radiance, guarded) = self.radiance(scene);
        let largest = |colour: &Rgb| f64::from(colour.abs().max_element() / RADIANCE);
        let error = |(colour, truth): (&Rgb, &f64)| (f64::from(colour.x / RADIANCE) - truth).abs();
        Found {
            not_finite: radiance.iter().filter(|colour| !colour.is_finite()).count(),
            guarded,
            receivers: radiance.len(),
            worst: radiance.iter().filter(|colour| colour.is_finite()).map(largest).fold(0.0, f64::max),
            error: truth.map(|truth| radiance.iter().zip(truth).map(error).fold(0.0, f64::max)),
        }
    }
}

/// Counts receivers that were guarded.
struct Guarded(u64);

impl Meter for Guarded {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        self.0 += if counter == "receivers guarded" { amount } else { 0 };
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}
