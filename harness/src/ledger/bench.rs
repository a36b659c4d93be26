//! What rows measure with: figures, interleaved rounds, methods made ready.

use crate::Error;
use crate::execute::{Runner, Shaded, Task, evaluate, prepare_once, update};
use crate::recorder::{Recorded, Recorder};
use halflight_contract::{Backend, Cache, Method, Params, Quantity};
use halflight_metrics::median_interval;
use halflight_references::Quality;
use halflight_results::Key;
use halflight_scenes::{Frame, Rgb, Scene};
use std::path::PathBuf;
use std::time::Instant;

/// Under what terms rows are measured.
#[derive(Clone, Debug)]
pub struct Terms {
    /// Where derived data and references are kept.
    pub cache: PathBuf,
    /// How good references are to be.
    pub quality: Quality,
    /// Rounds of every timing.
    pub rounds: usize,
}

/// A figure that was taken.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    pub(crate) quantity: String,
    pub(crate) unit: &'static str,
    pub(crate) value: f64,
    pub(crate) interval: Option<[f64; 2]>,
    pub(crate) samples: u64,
}

impl Figure {
    /// A figure without spread, of so many receivers or cases.
    pub(crate) fn exact(quantity: impl Into<String>, unit: &'static str, value: f64, samples: usize) -> Figure {
        Figure { quantity: quantity.into(), unit, value, interval: None, samples: samples as u64 }
    }

    /// The median of rounds.
    ///
    /// # Panics
    /// If there are none.
    pub(crate) fn median(quantity: impl Into<String>, unit: &'static str, rounds: &[f64]) -> Figure {
        let found = median_interval(rounds).expect("rounds");
        let interval = Some([found.low, found.high]);
        Figure { quantity: quantity.into(), unit, value: found.median, interval, samples: found.count as u64 }
    }

    /// A figure with its standard error, over so many receivers.
    pub(crate) fn estimate(quantity: impl Into<String>, value: f64, error: f64, receivers: usize) -> Figure {
        let interval = Some([value - 1.96 * error, value + 1.96 * error]);
        Figure { quantity: quantity.into(), unit: "", value, interval, samples: receivers as u64 }
    }
}

/// The terms, with what is opened under them.
pub(crate) struct Bench {
    pub(crate) terms: Terms,
    pub(crate) cache: Cache,
}

/// Work that is timed.
pub(crate) type Work<'a> = Box<dyn FnMut() -> Result<(), Error> + 'a>;

impl Bench {
    pub(crate) fn new(terms: &Terms) -> Bench {
        Bench { terms: terms.clone(), cache: Cache::in_folder(&terms.cache.join("derived")) }
    }

    /// Nanoseconds of each work, round by round; every round does each once, after a round that is not timed.
    pub(crate) fn interleaved(&self, works: &mut [Work<'_>]) -> Result<Vec<Vec<f64>>, Error> {
        let mut times = vec![Vec::new(); works.len()];
        for round in 0..=self.terms.rounds {
            for (work, times) in works.iter_mut().zip(&mut times) {
                let start = Instant::now();
                work()?;
                if round > 0 {
                    times.push(start.elapsed().as_nanos() as f64);
                }
            }
        }
        Ok(times)
    }

    /// Direct light by a method on a frame.
    pub(crate) fn task<'a>(&'a self, scene: &'a Scene, method: &'static dyn Method, params: &'a Params) -> Task<'a> {
        let (quantity, backend) = (Quantity::Direct, Backend::Cpu);
        Task { scene, method, params, quantity, backend, seed: 1, cache: &self.cache }
    }

    /// One method's picture with what it counted.
    pub(crate) fn shaded(&self, scene: &Scene, frame: &Frame, setting: &Setting) -> Result<Shaded, Error> {
        let task = self.task(scene, setting.method, &setting.params);
        Runner::new(task).picture(frame, &mut silent).map_err(|error| setting.failed(scene, &error))
    }

    /// The method's shading as work to be timed, with everything before it done.
    pub(crate) fn shading<'a>(
        &'a self,
        scene: &'a Scene,
        frame: &'a Frame,
        setting: &'a Setting,
    ) -> Result<Work<'a>, Error> {
        self.work(scene, frame, setting, false)
    }

    /// A whole frame of the method as work to be timed: update and shading.
    pub(crate) fn framing<'a>(
        &'a self,
        scene: &'a Scene,
        frame: &'a Frame,
        setting: &'a Setting,
    ) -> Result<Work<'a>, Error> {
        self.work(scene, frame, setting, true)
    }

    fn work<'a>(
        &'a self,
        scene: &'a Scene,
        frame: &'a Frame,
        setting: &'a Setting,
        whole: bool,
    ) -> Result<Work<'a>, Error> {
        let failed = |error: String| setting.failed(scene, &error);
        let task = self.task(scene, setting.method, &setting.params);
        let mut ready = prepare_once(&task, &Key::of_bytes(b"no cell"), &mut silent).map_err(failed)?;
        update(&mut ready, frame, &mut Recorder::new(&mut silent), &mut Recorded::default()).map_err(failed)?;
        let mut radiance = vec![Rgb::ZERO; frame.receivers.len()];
        Ok(Box::new(move || {
            let (mut recorded, mut silent) = (Recorded::default(), silent);
            let mut recorder = Recorder::new(&mut silent);
            if whole {
                update(&mut ready, frame, &mut recorder, &mut recorded)
                    .map_err(|error| setting.failed(scene, &error))?;
            }
            evaluate(&task, ready.method.as_mut(), frame, &mut recorder, &mut recorded, &mut radiance)
                .map_err(|error| setting.failed(scene, &error))
        }))
    }
}

/// A method with its parameters.
pub(crate) struct Setting {
    pub(crate) method: &'static dyn Method,
    pub(crate) params: Params,
}

impl Setting {
    /// # Errors
    /// There is no such method, or it does not take such a parameter.
    pub(crate) fn new(method: &str, settings: &[(&str, &str)]) -> Result<Setting, Error> {
        let method = crate::plan::method(method)?;
        let params = Params::resolve(method.info().params, settings.iter().copied())
            .map_err(|source| Error::Param { method: method.info().id, source })?;
        Ok(Setting { method, params })
    }

    pub(crate) fn failed(&self, scene: &Scene, error: &str) -> Error {
        Error::Other(format!("{} failed on {}: {error}", self.method.info().id, scene.name))
    }
}

/// Ratios round by round.
pub(crate) fn ratios(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a / b).collect()
}

/// Nobody is told of steps.
pub(crate) fn silent(_: &str, _: u64, _: u64) {}
