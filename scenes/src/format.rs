//! The scene file as it is written: plain data, unknown fields refused. Angles are in degrees here.

mod animation;
mod heights;
mod solids;

use serde::Deserialize;

pub(crate) use animation::{CharacterFile, DeformFile, GltfFile, PlayFile};
pub(crate) use heights::{GrowFile, HeightsFile, WaveFile};
pub(crate) use solids::{BallFile, BlobFile, BlockFile, CylinderFile};

/// A scene file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SceneFile {
    /// One line: what the scene is for.
    pub(crate) purpose: String,
    pub(crate) camera: Option<CameraFile>,
    pub(crate) receivers: ReceiversFile,
    #[serde(default)]
    pub(crate) objects: Vec<ObjectFile>,
    #[serde(default)]
    pub(crate) lights: Vec<LightFile>,
    #[serde(default)]
    pub(crate) frames: FramesFile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CameraFile {
    pub(crate) eye: [f32; 3],
    pub(crate) target: [f32; 3],
    #[serde(default = "z_axis")]
    pub(crate) up: [f32; 3],
    /// Vertical field of view.
    pub(crate) fov: f32,
    pub(crate) width: usize,
    pub(crate) height: usize,
}

/// Exactly one of these.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReceiversFile {
    /// What the camera sees, a receiver a pixel.
    pub(crate) camera: Option<NothingFile>,
    /// The vertices of a mesh.
    pub(crate) vertices: Option<VerticesFile>,
    pub(crate) grid: Option<GridFile>,
    /// Lines of `x,y,z,nx,ny,nz`, albedo 1.
    pub(crate) points: Option<PointsFile>,
    /// The vertices of a height field, as a picture.
    pub(crate) heights: Option<VerticesFile>,
}

/// An empty table.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct NothingFile {}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VerticesFile {
    pub(crate) object: String,
}

/// Cell centres of a rectangle, rows from its far edge (+y where the normal is +z).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GridFile {
    pub(crate) center: [f32; 3],
    pub(crate) size: [f32; 2],
    pub(crate) resolution: [usize; 2],
    #[serde(default = "z_axis")]
    pub(crate) normal: [f32; 3],
    /// The object whose albedo and motion the grid takes; albedo 1 and rest without.
    pub(crate) object: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointsFile {
    pub(crate) file: String,
    pub(crate) sha256: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObjectFile {
    pub(crate) name: String,
    pub(crate) mesh: Option<MeshFile>,
    pub(crate) sphere: Option<SphereFile>,
    pub(crate) random_spheres: Option<RandomSpheresFile>,
    pub(crate) plane: Option<PlaneFile>,
    pub(crate) heights: Option<HeightsFile>,
    pub(crate) ball: Option<BallFile>,
    pub(crate) block: Option<BlockFile>,
    pub(crate) cylinder: Option<CylinderFile>,
    pub(crate) blob: Option<BlobFile>,
    pub(crate) character: Option<CharacterFile>,
    pub(crate) gltf: Option<GltfFile>,
    #[serde(default = "one")]
    pub(crate) scale: f32,
    pub(crate) rotate: Option<Rotation>,
    #[serde(default)]
    pub(crate) translate: [f32; 3],
    /// Needed by all but glTF files, whose materials it replaces.
    pub(crate) albedo: Option<[f32; 3]>,
    /// Radiance that leaves the front of its surface.
    #[serde(default)]
    pub(crate) emission: [f32; 3],
    /// A picture by which `emission` is multiplied.
    pub(crate) emission_map: Option<PictureFile>,
    #[serde(default = "yes")]
    pub(crate) casts: bool,
    #[serde(default)]
    pub(crate) motion: Vec<KeyFile>,
    pub(crate) deform: Option<DeformFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MeshFile {
    pub(crate) file: String,
    pub(crate) sha256: Option<String>,
    #[serde(default)]
    pub(crate) up: Up,
    /// Join vertices at the same position, so that normals run smoothly across open patches. Normals and texture
    /// coordinates of the file are left out.
    #[serde(default)]
    pub(crate) weld: bool,
    /// Leave out triangles without area, which are an error otherwise.
    #[serde(default)]
    pub(crate) drop_degenerate: bool,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PictureFile {
    pub(crate) file: String,
    pub(crate) sha256: Option<String>,
}

/// The axis that points up in a mesh file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// The second.
    Y,
    /// The third, as in scenes.
    #[default]
    Z,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SphereFile {
    pub(crate) center: [f32; 3],
    pub(crate) radius: f32,
}

/// Spheres with centres uniform in a box and radii uniform in a range.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RandomSpheresFile {
    pub(crate) seed: u64,
    pub(crate) count: usize,
    pub(crate) low: [f32; 3],
    pub(crate) high: [f32; 3],
    pub(crate) radius: [f32; 2],
}

/// A rectangle about the origin with normal +z.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlaneFile {
    pub(crate) size: [f32; 2],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Rotation {
    pub(crate) axis: [f32; 3],
    pub(crate) degrees: f32,
}

/// A pose at a time in seconds, on top of the rest position: rotated about the object's `translate`, then moved.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KeyFile {
    pub(crate) time: f32,
    pub(crate) rotate: Option<Rotation>,
    #[serde(default)]
    pub(crate) translate: [f32; 3],
}

/// Exactly one of these.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LightFile {
    pub(crate) environment: Option<EnvironmentFile>,
    pub(crate) sky: Option<SkyFile>,
    pub(crate) key: Option<KeyLightFile>,
    pub(crate) turn: Option<TurnFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EnvironmentFile {
    pub(crate) file: String,
    pub(crate) sha256: Option<String>,
    #[serde(default = "one")]
    pub(crate) scale: f32,
    /// Degrees about +z.
    #[serde(default)]
    pub(crate) rotate: f32,
}

/// Exactly one of these.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SkyFile {
    pub(crate) uniform: Option<[f32; 3]>,
    pub(crate) overcast: Option<[f32; 3]>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KeyLightFile {
    /// Towards the light.
    pub(crate) direction: [f32; 3],
    pub(crate) angular_radius: f32,
    pub(crate) radiance: [f32; 3],
}

/// A steady turn, from second 0 on.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TurnFile {
    #[serde(default = "z_axis")]
    pub(crate) axis: [f32; 3],
    pub(crate) degrees_a_second: f32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FramesFile {
    pub(crate) count: usize,
    #[serde(default = "film")]
    pub(crate) fps: f32,
}

impl Default for FramesFile {
    fn default() -> Self {
        FramesFile { count: 1, fps: film() }
    }
}

fn z_axis() -> [f32; 3] {
    [0.0, 0.0, 1.0]
}

fn one() -> f32 {
    1.0
}

fn yes() -> bool {
    true
}

fn film() -> f32 {
    24.0
}
