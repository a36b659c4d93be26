//! Scenes: what is lit, by what, and where it is asked.
//!
//! A scene file (TOML) becomes a [`Scene`]: objects, lights, a receiver layout and frames. A [`Frame`] is the
//! scene posed at one time with its receivers in structure-of-arrays form; it is all that methods and
//! references ever see. Space is right-handed, z up, in metres; radiance is linear Rec. 709.
#![doc = include_str!("../README.md")]

mod animation;
mod assets;
mod bodies;
mod camera;
mod check;
mod content;
mod emission;
mod error;
mod export;
mod facts;
mod format;
mod frame;
mod heights;
mod import;
mod light;
mod load;
mod mesh;
mod object;
mod placement;
mod random;
mod receivers;
mod resolution;
mod scene;
mod shipped;
mod solids;
mod texture;

pub use animation::{Carried, Deformation, Form, Palette, Procedural};
pub use assets::{open_image_io, read_points_csv};
pub use bodies::Bodies;
pub use camera::Camera;
pub use content::{Content, Revision};
pub use emission::Emission;
pub use error::SceneError;
pub use export::{Exported, export_gltf};
pub use facts::SceneFacts;
pub use format::Up;
pub use frame::{Frame, PosedLight, PosedObject};
pub use halflight_trace::Sphere;
pub use heights::HeightField;
pub use import::{Import, Imported, Wanted, import};
pub use light::{DistantLight, Environment, KeyLight, Light, Sky, Turn};
pub use mesh::Mesh;
pub use object::{Object, Pose, Shape};
pub use placement::{Grid, Placement};
pub use receivers::{Layout, Place, Receivers};
pub use scene::{Scene, Which};
pub use shipped::{find, shipped};
pub use texture::Texture;

/// Linear Rec. 709 red, green and blue.
pub type Rgb = glam::Vec3;
