//! What changes its shape, as a scene file has it.

use serde::Deserialize;

/// A body made around captured motion.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CharacterFile {
    /// A Biovision hierarchy.
    pub(crate) file: String,
    pub(crate) sha256: Option<String>,
    #[serde(default)]
    pub(crate) play: PlayFile,
    /// Of the limbs, 1 as the house makes them.
    #[serde(default = "one")]
    pub(crate) thickness: f32,
    /// Cells along the body's longest side.
    #[serde(default = "fine")]
    pub(crate) resolution: usize,
}

/// The meshes of a glTF file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GltfFile {
    pub(crate) file: String,
    pub(crate) sha256: Option<String>,
    /// The name of an animation, or its number from 0; none stands still.
    pub(crate) clip: Option<String>,
    #[serde(default)]
    pub(crate) play: PlayFile,
    #[serde(default)]
    pub(crate) drop_degenerate: bool,
}

/// How a clip is played.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlayFile {
    /// Seconds of the clip at time 0.
    #[serde(default)]
    pub(crate) start: f32,
    #[serde(default = "one")]
    pub(crate) speed: f32,
    /// Begin again at the end.
    #[serde(default)]
    pub(crate) repeat: bool,
}

impl Default for PlayFile {
    fn default() -> Self {
        PlayFile { start: 0.0, speed: 1.0, repeat: false }
    }
}

/// Exactly one form, and its period in seconds.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DeformFile {
    pub(crate) period: f32,
    pub(crate) twist: Option<TwistFile>,
    pub(crate) bend: Option<BendFile>,
    pub(crate) flap: Option<FlapFile>,
    pub(crate) egg: Option<EggFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TwistFile {
    pub(crate) degrees: f32,
    pub(crate) height: f32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BendFile {
    pub(crate) degrees: f32,
    pub(crate) length: f32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FlapFile {
    pub(crate) degrees: f32,
    pub(crate) hinge: f32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EggFile {
    pub(crate) stretch: f32,
    pub(crate) taper: f32,
}

fn one() -> f32 {
    1.0
}

fn fine() -> usize {
    96
}
