//! What glTF has no words for, as `extras` under the key `halflight`: exports write it, imports read it.

use gltf::json::Extras;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::SceneError;
use crate::check::Checker;

const KEY: &str = "halflight";

/// Of a node, or of the camera or light that it carries.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Node {
    /// Whether its mesh takes part in light transport.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) casts: Option<bool>,
    /// The point about which its object would turn, in the file's space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pivot: Option<[f32; 3]>,
    /// Of a directional light, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) angular_radius: Option<f32>,
    /// Of the ball that stands for a point light, in the file's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) radius: Option<f32>,
    /// The point that a camera looks at, in the file's space.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) target: Option<[f32; 3]>,
    /// Pixels across and down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size: Option<[usize; 2]>,
}

/// Of a scene: light from afar that is no directional light.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Scene {
    pub(crate) lights: Vec<Afar>,
}

#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Afar {
    Uniform([f32; 3]),
    Overcast([f32; 3]),
    /// A picture beside the file, turned by degrees about the vertical.
    Environment {
        file: String,
        rotate: f32,
    },
}

/// What somebody's extras hold of ours.
pub(super) fn of<T: DeserializeOwned>(check: Checker, place: &str, extras: &Extras) -> Result<Option<T>, SceneError> {
    let all = extras.as_ref().and_then(|raw| serde_json::from_str::<Value>(raw.get()).ok());
    let ours = all.and_then(|mut all| all.get_mut(KEY).map(Value::take));
    let malformed = |error| check.malformed(format!("{place}.extras.{KEY}"), format!("{error}"));
    ours.map(|ours| serde_json::from_value(ours).map_err(malformed)).transpose()
}

/// Extras that hold it.
pub(crate) fn holding<T: Serialize>(ours: &T) -> Value {
    serde_json::json!({ KEY: ours })
}
