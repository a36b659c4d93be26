//! Closed meshes by formula, as a scene file has them.

use serde::Deserialize;

/// A triangulated sphere about the origin.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BallFile {
    pub(crate) radius: f32,
    /// How often the triangles of an octahedron are cut in four.
    #[serde(default = "smooth")]
    pub(crate) cuts: usize,
}

/// A box about the origin.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BlockFile {
    pub(crate) size: [f32; 3],
    /// Cells along x, y and z.
    #[serde(default = "whole")]
    pub(crate) cells: [usize; 3],
}

/// A cylinder about z, from z = 0 up.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CylinderFile {
    pub(crate) radius: f32,
    pub(crate) height: f32,
    #[serde(default = "round")]
    pub(crate) sides: usize,
    #[serde(default = "single")]
    pub(crate) rings: usize,
}

/// Capsules blended into one surface.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BlobFile {
    pub(crate) capsules: Vec<CapsuleFile>,
    #[serde(default)]
    pub(crate) blend: f32,
    /// Cells along the longest side.
    #[serde(default = "fine")]
    pub(crate) resolution: usize,
}

/// A ball swept from one point to another while its radius changes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CapsuleFile {
    pub(crate) from: [f32; 3],
    pub(crate) to: [f32; 3],
    pub(crate) radii: [f32; 2],
}

fn smooth() -> usize {
    4
}

fn whole() -> [usize; 3] {
    [1; 3]
}

fn round() -> usize {
    48
}

fn single() -> usize {
    1
}

fn fine() -> usize {
    64
}
