//! What references and methods answer, asked under a bench's terms.

use super::bench::{Bench, Setting, silent};
use crate::Error;
use crate::budget::chain::What;
use crate::budget::{Asked, Seen};
use crate::probe::Question;
use halflight_contract::Quantity;
use halflight_references::Reference;
use halflight_scenes::Scene;

/// Direct light of a scene at a frame.
pub(crate) fn direct(scene: &Scene, frame: usize) -> Question<'_> {
    Question { scene, frame, quantity: Quantity::Direct, seed: 1 }
}

impl Bench {
    /// The question, under the bench's terms.
    pub(crate) fn ask<'a>(&'a self, question: &'a Question<'a>) -> Result<Asked<'a>, Error> {
        Asked::new(question, &self.terms.quality, &self.terms.cache)
    }
}

impl Asked<'_> {
    /// A reference by its id, such as `sh-light:4+sphere-proxies:64`.
    pub(crate) fn traced(&self, id: &str) -> Result<Seen, Error> {
        let reference = Reference::parse(id).map_err(|error| Error::Other(error.to_string()))?;
        self.see(&What::Reference(reference), &mut silent)
    }

    /// A method with settings, its defaults for the rest.
    pub(crate) fn shaded(&self, method: &str, settings: &[(&str, &str)]) -> Result<Seen, Error> {
        let Setting { method, params } = Setting::new(method, settings)?;
        self.see(&What::Method(method, params), &mut silent)
    }
}
