//! Pictures for a figure's page: what references and methods make of a scene, and how far apart they are.

use crate::Error;
use crate::budget::{Seen, apart};
use glam::{Vec2, Vec3};
use halflight_reports::{Shown, plus_minus};
use halflight_scenes::{Grid, Placement, Scene};

pub(super) use crate::ledger::direct;

/// A shipped scene seen from `side²` receivers on the plane z = 0, `size` metres wide about a point, from above.
pub(super) fn from_above(name: &str, center: Vec3, size: f32, side: usize) -> Result<Scene, Error> {
    let grid = Grid { center, size: Vec2::splat(size), resolution: [side; 2], normal: Vec3::Z, object: None };
    Ok(Scene { placement: Placement::Grid(grid), ..halflight_scenes::find(name)? }.as_changed())
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
