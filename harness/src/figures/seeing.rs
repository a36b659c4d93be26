//! Pictures for a figure's page: what references and methods make of a scene, and how far apart they are.

use crate::Error;
use crate::budget::chain::What;
use crate::budget::{Asked, Seen, apart};
use crate::ledger::{Bench, Setting, silent};
use crate::probe::Question;
use glam::{Vec2, Vec3};
use halflight_contract::Quantity;
use halflight_references::Reference;
use halflight_reports::{Shown, plus_minus};
use halflight_scenes::{Grid, Placement, Scene};

/// Direct light of a scene at a frame.
pub(super) fn direct(scene: &Scene, frame: usize) -> Question<'_> {
    Question { scene, frame, quantity: Quantity::Direct, seed: 1 }
}

/// A shipped scene seen from `side²` receivers on the plane z = 0, `size` metres wide about a point, from above.
pub(super) fn from_above(name: &str, center: Vec3, size: f32, side: usize) -> Result<Scene, Error> {
    let grid = Grid { center, size: Vec2::splat(size), resolution: [side; 2], normal: Vec3::Z, object: None };
    Ok(Scene { placement: Placement::Grid(grid), ..halflight_scenes::find(name)? }.as_changed())
}

impl Bench {
    /// The question, under the bench's terms.
    pub(super) fn ask<'a>(&'a self, question: &'a Question<'a>) -> Result<Asked<'a>, Error> {
        Asked::new(question, &self.terms.quality, &self.terms.cache)
    }
}

impl Asked<'_> {
    /// A reference by its id, such as `sh-light:4+sphere-proxies:64`.
    pub(super) fn traced(&self, id: &str) -> Result<Seen, Error> {
        let reference = Reference::parse(id).map_err(|error| Error::Other(error.to_string()))?;
        self.see(&What::Reference(reference), &mut silent)
    }

    /// A method with settings, its defaults for the rest.
    pub(super) fn shaded(&self, method: &str, settings: &[(&str, &str)]) -> Result<Seen, Error> {
        let Setting { method, params } = Setting::new(method, settings)?;
        self.see(&What::Method(method, params), &mut silent)
    }
}

/// A picture by itself.
pub(super) fn alone<'a>(name: impl Into<String>, seen: &'a Seen) -> Shown<'a> {
    Shown { name: name.into(), caption: String::new(), picture: &seen.picture, against: None }
}

/// A picture held against another, with its RMSE and bias from it.
pub(super) fn beside<'a>(name: impl Into<String>, seen: &'a Seen, against: &'a Seen) -> Result<Shown<'a>, Error> {
    let found = apart(seen, against)?;
    let caption =
        format!("RMSE {}, bias {}", plus_minus(found.rmse, found.rmse_error), plus_minus(found.bias, found.bias_error));
    Ok(Shown { name: name.into(), caption, picture: &seen.picture, against: Some(&against.picture) })
}
