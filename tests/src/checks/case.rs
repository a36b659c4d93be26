//! A case: a method on a scene, with parameters and a quantity; and how checks run it.

use std::sync::Arc;

use halflight_contract::{
    Backend, Cache, Error, Job, Kind, Meter, Method, NoMeter, Output, ParamSpec, Params, Phase, Prepared, Quantity,
    Request, Support,
};
use halflight_scenes::{Frame, Rgb, Scene};

use super::{Breach, Outcome, Verdict, Violation};

/// Frames of a scene that checks walk through: enough to go on, back and jump.
const FRAMES: usize = 3;

/// A method on a scene, with parameters and a quantity.
pub struct Case<'a> {
    /// The method under test.
    pub method: &'a dyn Method,
    /// The scene.
    pub scene: &'a Scene,
    /// Where it runs.
    pub backend: Backend,
    /// What is asked at its receivers.
    pub quantity: Quantity,
    /// Parameters, complete and in range.
    pub params: Params,
    /// Parameters that variants leave as they are.
    pub fixed: &'static [&'static str],
    /// The scene's first frames.
    pub frames: Vec<Frame>,
    /// Shared by all runs of the case, but for those that are about it.
    pub cache: Arc<Cache>,
}

impl<'a> Case<'a> {
    /// A case with default parameters on the CPU.
    pub fn new(method: &'a dyn Method, scene: &'a Scene, quantity: Quantity) -> Self {
        Case {
            method,
            scene,
            backend: Backend::Cpu,
            quantity,
            params: Params::defaults(method.info().params),
            fixed: &[],
            frames: (0..scene.frame_count.min(FRAMES)).map(|index| scene.frame(index)).collect(),
            cache: Arc::default(),
        }
    }

    /// A case for every quantity that the method supports on the scene with default parameters and this backend: the three kinds
    /// of radiance, and visibility at the lowest and the highest order that it has.
    pub fn all(method: &'a dyn Method, scene: &'a Scene, backend: Backend) -> Vec<Self> {
        let orders: Vec<Quantity> = (1..=8).map(|order| Quantity::Visibility { order }).collect();
        let radiance = [Quantity::Direct, Quantity::Indirect { bounces: 1 }, Quantity::Total];
        let whole = Case { backend, ..Case::new(method, scene, Quantity::Direct) };
        let supported = |quantities: &[Quantity]| -> Vec<Quantity> {
            quantities.iter().copied().filter(|quantity| whole.asking(*quantity).is_supported()).collect()
        };
        let mut visibility = supported(&orders);
        if visibility.len() > 2 {
            visibility.drain(1..visibility.len() - 1);
        }
        supported(&radiance).into_iter().chain(visibility).map(|quantity| whole.asking(quantity)).collect()
    }

    /// The same case with another quantity.
    #[must_use]
    pub fn asking(&self, quantity: Quantity) -> Self {
        Case { quantity, params: self.params.clone(), frames: self.frames.clone(), cache: self.cache.clone(), ..*self }
    }

    /// The same case with other parameters.
    #[must_use]
    pub fn tuned(&self, params: Params) -> Self {
        Case { params, ..self.asking(self.quantity) }
    }

    /// The case on another scene, with a cache of its own: what two scenes share is for [`super::shared_derived_data`]
    /// alone.
    #[must_use]
    pub fn on<'b>(&self, scene: &'b Scene) -> Case<'b>
    where
        'a: 'b,
    {
        let fresh = Case::new(self.method, scene, self.quantity);
        Case { params: self.params.clone(), backend: self.backend, fixed: self.fixed, ..fresh }
    }

    /// Whether the method says that it runs this case, exactly or not.
    pub fn is_supported(&self) -> bool {
        let request = Request { quantity: self.quantity, backend: self.backend, params: &self.params };
        !matches!(self.method.supports(&self.scene.facts(), &request), Support::Skip(_))
    }

    /// This case with one parameter at a time set to its least, middle and greatest value, or to every word or switch,
    /// as far as the method supports it. What it is set to already is left out, and what is fixed.
    pub fn variants(&self) -> Vec<(&'static ParamSpec, Self)> {
        let specs = self.method.info().params;
        let vary = |spec: &'static ParamSpec| settings(spec).into_iter().map(move |text| (spec, text));
        let tune = |(spec, text): (&'static ParamSpec, String)| {
            let mine: Vec<_> = self.params.iter().map(|(name, value)| (name, value.to_string())).collect();
            let settings = mine.iter().map(|(name, value)| (*name, value.as_str())).chain([(spec.name, text.as_str())]);
            let params = Params::resolve(specs, settings).expect("settings are in range");
            (spec, self.tuned(params))
        };
        let differs = |case: &Self| case.params != self.params && case.is_supported();
        specs
            .iter()
            .filter(|spec| !self.fixed.contains(&spec.name))
            .flat_map(vary)
            .map(tune)
            .filter(|(_, case)| differs(case))
            .collect()
    }

    /// The method made ready for the scene, deriving from the given cache.
    pub fn prepare(&self, cache: &Cache, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 'a>, Error> {
        let seed = 1;
        self.method.prepare(&Job::new(self.scene, &self.params, seed, self.backend, cache), meter)
    }

    /// Updates, evaluates and reads a frame.
    pub fn run(&self, prepared: &mut dyn Prepared, frame: &Frame) -> Result<Vec<f32>, Error> {
        prepared.update(frame, &mut NoMeter)?;
        self.shade(prepared, frame)
    }

    /// Evaluates and reads a frame that is up to date.
    pub fn shade(&self, prepared: &mut dyn Prepared, frame: &Frame) -> Result<Vec<f32>, Error> {
        prepared.evaluate(frame, self.quantity, &mut NoMeter)?;
        self.read(prepared, frame, 0.0)
    }

    /// Reads a frame's result into an output filled with `dirt`.
    pub fn read(&self, prepared: &mut dyn Prepared, frame: &Frame, dirt: f32) -> Result<Vec<f32>, Error> {
        let receivers = frame.receivers.len();
        if let Quantity::Visibility { .. } = self.quantity {
            let mut out = vec![dirt; receivers * self.quantity.channels()];
            prepared.read(Output::Coefficients(&mut out), &mut NoMeter)?;
            return Ok(out);
        }
        let mut out = vec![Rgb::splat(dirt); receivers];
        prepared.read(Output::Radiance(&mut out), &mut NoMeter)?;
        Ok(out.iter().flat_map(|rgb| rgb.to_array()).collect())
    }

    /// A frame's result from a method made ready for nothing else.
    pub fn fresh(&self, frame: &Frame) -> Result<Vec<f32>, Error> {
        self.run(&mut *self.prepare(&self.cache, &mut NoMeter)?, frame)
    }

    /// The result of a check, as a violation where it fails.
    pub(super) fn judge(&self, check: &'static str, body: impl FnOnce() -> Outcome) -> Result<Verdict, Violation> {
        body().map_err(|Breach(found)| Violation {
            check,
            method: self.method.info().id,
            detail: format!("scene {}, {}, {}: {found}", self.scene.name, self.quantity, self.backend),
        })
    }
}

/// Values worth trying, as text.
fn settings(spec: &ParamSpec) -> Vec<String> {
    match spec.kind {
        Kind::Int { min, max, .. } => [min, min + (max - min) / 2, max].map(|v| v.to_string()).to_vec(),
        Kind::Float { min, max, .. } => [min, 0.5 * (min + max), max].map(|v| v.to_string()).to_vec(),
        Kind::Choice(words) => words.iter().map(|word| word.to_string()).collect(),
        Kind::Flag { .. } => vec![false.to_string(), true.to_string()],
    }
}

/// Whether a parameter may change without a new `prepare`.
pub(super) fn is_live(spec: &ParamSpec) -> bool {
    spec.phase > Phase::Prepare
}
