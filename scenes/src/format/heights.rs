//! Height fields as a scene file writes them.

use serde::Deserialize;

/// A picture of heights, or a resolution and exactly one generator.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HeightsFile {
    /// Distances between neighbours along x and y.
    pub(crate) cell: [f32; 2],
    pub(crate) file: Option<String>,
    pub(crate) sha256: Option<String>,
    /// Heights of the black and the white of a PNG.
    pub(crate) range: Option<[f32; 2]>,
    /// What a picture holds where it lacks a height, in metres or NaN.
    pub(crate) nodata: Option<f32>,
    /// Vertices along x and y.
    pub(crate) resolution: Option<[usize; 2]>,
    pub(crate) ramp: Option<RampFile>,
    pub(crate) trench: Option<TrenchFile>,
    pub(crate) wall: Option<WallFile>,
    pub(crate) cone: Option<ConeFile>,
    pub(crate) bump: Option<BumpFile>,
    pub(crate) waves: Option<Vec<WaveFile>>,
    pub(crate) fractal: Option<FractalFile>,
    pub(crate) grow: Option<GrowFile>,
}

/// All heights grow from second 0 on.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GrowFile {
    /// Share of the heights at second 0.
    pub(crate) from: f32,
    pub(crate) seconds: f32,
}

/// A plane through the origin.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RampFile {
    /// Inclination.
    pub(crate) slope: f32,
    /// Where it rises, from +x towards +y.
    #[serde(default)]
    pub(crate) azimuth: f32,
}

/// Along y, cut into the plane z = 0.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TrenchFile {
    pub(crate) depth: f32,
    /// Inclination of its walls.
    pub(crate) wall: f32,
    /// Width of its floor.
    #[serde(default)]
    pub(crate) width: f32,
}

/// Along y, on the plane z = 0.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WallFile {
    pub(crate) height: f32,
    #[serde(default)]
    pub(crate) width: f32,
}

/// On the plane z = 0.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ConeFile {
    pub(crate) height: f32,
    pub(crate) radius: f32,
}

/// A Gaussian.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BumpFile {
    pub(crate) height: f32,
    /// Standard deviation.
    pub(crate) sigma: f32,
}

/// A sine.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WaveFile {
    pub(crate) amplitude: f32,
    pub(crate) wavelength: f32,
    /// Along which it runs, from +x towards +y.
    #[serde(default)]
    pub(crate) azimuth: f32,
    /// At the origin.
    #[serde(default)]
    pub(crate) phase: f32,
    /// Metres a second along its azimuth.
    #[serde(default)]
    pub(crate) speed: f32,
}

/// A sum of gradient noises, each of half the wavelength of the one before.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FractalFile {
    pub(crate) seed: u64,
    /// Of the first.
    pub(crate) amplitude: f32,
    /// Of the first.
    pub(crate) wavelength: f32,
    pub(crate) octaves: usize,
    /// From each amplitude to the next.
    #[serde(default = "half")]
    pub(crate) gain: f32,
}

fn half() -> f32 {
    0.5
}
