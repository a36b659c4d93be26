//! Lights as the latitude–longitude maps of Mitsuba.
//!
//! Mitsuba's `envmap` is bilinear between nodes: of `height` rows the first lies on the upper pole and the last on the lower,
//! of `width` columns the first lies half a column from azimuth 0. Azimuth grows clockwise seen from above. (Measured on single
//! bright texels, Mitsuba 3.9.)

use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage};
use glam::Vec3;
use halflight_scenes::{Environment, Rgb};
use std::f32::consts::PI;
use std::path::Path;

/// Radiance at the nodes of a map.
pub(super) struct RadianceMap {
    width: usize,
    height: usize,
    nodes: Vec<Rgb>,
}

/// Columns that a map is refined to, as far as [`MOST_FINE`] allows.
const COLUMNS: usize = 4096;
/// Most nodes a texel of ours, each way.
const MOST_FINE: usize = 8;
/// Intervals from pole to pole for what depends on elevation alone; even, so that one node lies on the horizon.
const ELEVATIONS: usize = 2048;

impl RadianceMap {
    /// Our texels are constant. With `k` nodes each way a texel, what bilinear interpolation blends is a strip of `1/k` texel about
    /// each border; it is centred there, so that the light of two neighbours together stays the same to second order in `1/k`.
    pub(super) fn of_environment(map: &Environment) -> Self {
        let fine = (COLUMNS / map.width).clamp(1, MOST_FINE);
        let (width, height) = (map.width * fine, map.height * fine + 1);
        let texel = |row: usize, column: usize| map.texels[row * map.width + column];
        let node = |i: usize| {
            let (row, column) = (i / width, map.width - 1 - i % width / fine);
            // Nodes on the border of two rows take their mean; those on the poles have one row.
            let (above, below) = (row.saturating_sub(1) / fine, (row / fine).min(map.height - 1));
            0.5 * (texel(above, column) + texel(below, column))
        };
        RadianceMap { width, height, nodes: (0..width * height).map(node).collect() }
    }

    /// A function of the direction's elevation alone, z up; a jump on the horizon is met halfway.
    pub(super) fn of_elevation(radiance: impl Fn(Vec3) -> Rgb) -> Self {
        let (width, height) = (4, ELEVATIONS + 1);
        let at = |polar: f32| radiance(Vec3::new(polar.sin(), 0.0, polar.cos()));
        let row = |row: usize| match PI * row as f32 / ELEVATIONS as f32 {
            horizon if 2 * row == ELEVATIONS => 0.5 * (at(horizon - 1e-6) + at(horizon + 1e-6)),
            polar => at(polar),
        };
        RadianceMap { width, height, nodes: (0..height).flat_map(|i| [row(i); 4]).collect() }
    }

    /// Writes it as OpenEXR, in 32-bit floats.
    pub(super) fn write(&self, path: &Path) -> Result<(), exr::error::Error> {
        let node = |at: Vec2<usize>| {
            let [r, g, b] = self.nodes[at.y() * self.width + at.x()].to_array();
            (r, g, b)
        };
        let layer = Layer::new(
            (self.width, self.height),
            LayerAttributes::named("radiance"),
            Encoding::SMALL_FAST_LOSSLESS,
            SpecificChannels::rgb(node),
        );
        Image::from_layer(layer).write().to_file(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn nodes_carry_our_texels() {
        let texels = Arc::new((0..8).map(|i| Rgb::splat(i as f32)).collect());
        let map = RadianceMap::of_environment(&Environment { width: 4, height: 2, texels, rotation: 0.0 });
        assert_eq!([map.width, map.height], [32, 17]);
        let row = |row: usize| (0..4).map(|i| map.nodes[row * 32 + 8 * i + 7].x).collect::<Vec<_>>();
        assert_eq!([row(0), row(7), row(8)], [[3.0, 2.0, 1.0, 0.0], [3.0, 2.0, 1.0, 0.0], [5.0, 4.0, 3.0, 2.0]]);
        assert_eq!([row(9), row(16)], [[7.0, 6.0, 5.0, 4.0]; 2]);
    }

    #[test]
    fn a_jump_on_the_horizon_is_met_halfway() {
        let map = RadianceMap::of_elevation(|direction| Rgb::splat(if direction.z >= 0.0 { 1.0 } else { 0.0 }));
        let rows = [ELEVATIONS / 2 - 1, ELEVATIONS / 2, ELEVATIONS / 2 + 1];
        assert_eq!(rows.map(|row| map.nodes[4 * row].x), [1.0, 0.5, 0.0]);
    }
}
