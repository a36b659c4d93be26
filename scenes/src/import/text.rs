//! Pieces of a scene file.

use glam::DVec3;

use super::digits;
use super::view::Bounds;

/// Text in quotes, as TOML has it.
pub(super) fn string(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A comment of one line.
pub(super) fn comment(text: &str) -> String {
    format!("# {}\n", one_line(text))
}

/// File names may hold anything.
pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A square below the models, which only receives, as in the shipped scenes.
pub(super) struct Ground {
    center: [f32; 3],
    side: f32,
}

/// Sides of the ground and of the receivers on it, in units of the longest side of the models.
const GROUND: f64 = 8.0;
const RECEIVERS: f64 = 3.0;
/// How far below the models the ground lies, in units of their size: what is flat below would lie in it otherwise.
const GAP: f64 = 1e-4;

impl Ground {
    pub(super) fn below(bounds: &Bounds) -> Self {
        let (center, size) = (bounds.center(), bounds.size());
        let center = DVec3::new(center.x, center.y, bounds.low.z - GAP * size);
        Ground { center: digits::within(center, size), side: digits::number(longest(bounds)) }
    }

    pub(super) fn entry(&self) -> String {
        let side = digits::number(GROUND * f64::from(self.side));
        format!(
            "\n[[objects]]\nname = \"ground\"\nplane = {{ size = [{side:?}, {side:?}] }}\ntranslate = {:?}\n\
             albedo = [0.7, 0.7, 0.7]\ncasts = false # as in the papers: the ground receives shadow but blocks nothing\n",
            self.center
        )
    }

    /// Receivers on its middle.
    pub(super) fn receivers(&self) -> String {
        let side = digits::number(RECEIVERS * f64::from(self.side));
        format!(
            "grid = {{ center = {:?}, size = [{side:?}, {side:?}], resolution = [128, 128], object = \"ground\" }}\n",
            self.center
        )
    }
}

fn longest(bounds: &Bounds) -> f64 {
    bounds.sides().max_element()
}
