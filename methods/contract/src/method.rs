//! The trait.

use halflight_scenes::{Frame, Rgb, SceneFacts};

use crate::{Coupling, Error, Info, Job, Meter, Params, Quantity, Request, Result, Support};

/// A way to compute light at receivers.
pub trait Method: Send + Sync {
    /// The name plate.
    fn info(&self) -> &'static Info;

    /// Whether a request can be answered on a scene with these facts; pure and quick.
    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support;

    /// Id of the method whose result this one approximates, from the same scene with the same parameters, if there is one: an
    /// error budget goes through it, so that what this method adds stands apart.
    fn approximates(&self) -> Option<&'static str> {
        None
    }

    /// How receivers couple under these parameters: as [`Info`] says of the default ones, unless a method overrides this.
    fn coupling(&self, _params: &Params) -> Coupling {
        self.info().coupling
    }

    /// All that is done once for a scene.
    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>>;
}

/// A method made ready for one scene.
pub trait Prepared: Send {
    /// Memory held, by purpose.
    fn footprint(&self) -> Footprint;

    /// Takes new parameters that differ only in what their phases allow after `prepare`.
    fn retune(&mut self, params: &Params) -> Result<()>;

    /// All that a moving scene forces, once a frame.
    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()>;

    /// Computes a quantity at the frame's receivers; the result stays where it was made.
    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()>;

    /// Copies the result of the last `evaluate` out. Every element is written; invalid receivers get zeros. An output of
    /// another kind or length than that result is an error ([`Output::fill`]).
    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()>;
}

/// Where results go, one entry a receiver.
#[derive(Debug)]
pub enum Output<'a> {
    /// Outgoing radiance.
    Radiance(&'a mut [Rgb]),
    /// SH coefficients, all of a receiver together.
    Coefficients(&'a mut [f32]),
}

impl Output<'_> {
    /// Copies results that lie as one row of floats, a receiver after the other.
    ///
    /// # Errors
    /// This output is of another kind or length than the quantity's results.
    pub fn fill(self, quantity: Quantity, results: &[f32]) -> Result<()> {
        let visibility = matches!(quantity, Quantity::Visibility { .. });
        let (found, fits) = match &self {
            Output::Radiance(out) => (3 * out.len(), !visibility),
            Output::Coefficients(out) => (out.len(), visibility),
        };
        if !fits || found != results.len() {
            return Err(Error::Output { quantity, expected: results.len(), found });
        }
        match self {
            Output::Radiance(out) => {
                out.iter_mut().zip(results.chunks_exact(3)).for_each(|(out, rgb)| *out = Rgb::from_slice(rgb));
            }
            Output::Coefficients(out) => out.copy_from_slice(results),
        }
        Ok(())
    }
}

/// Memory that a prepared method holds: `(purpose, host bytes, device bytes)`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Entries by purpose.
    pub entries: Vec<(&'static str, u64, u64)>,
}

impl Footprint {
    /// Adds host memory.
    #[must_use]
    pub fn host(mut self, purpose: &'static str, bytes: usize) -> Self {
        self.entries.push((purpose, bytes as u64, 0));
        self
    }

    /// Adds a graphics processor's memory.
    #[must_use]
    pub fn device(mut self, purpose: &'static str, bytes: u64) -> Self {
        self.entries.push((purpose, 0, bytes));
        self
    }

    /// Host bytes altogether.
    pub fn host_bytes(&self) -> u64 {
        self.entries.iter().map(|(_, host, _)| host).sum()
    }
}
