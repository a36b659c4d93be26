//! A GLB under construction: JSON, and one chunk of bytes that it points into.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};

/// Kinds of numbers, as glTF counts them.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;
/// What views are for.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

#[derive(Default)]
pub(super) struct Glb {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    pub(super) meshes: Vec<Value>,
    pub(super) materials: Vec<Value>,
    pub(super) images: Vec<Value>,
    pub(super) textures: Vec<Value>,
    pub(super) nodes: Vec<Value>,
    pub(super) cameras: Vec<Value>,
    pub(super) lights: Vec<Value>,
    pub(super) extensions: Vec<&'static str>,
    /// Of the scene.
    pub(super) extras: Value,
}

impl Glb {
    pub(super) fn view(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset }));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, bytes: impl IntoIterator<Item = u8>, component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.views[view]["target"] = if component == UNSIGNED { INDICES } else { VERTICES }.into();
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "type": kind, "count": count }));
        self.accessors.len() - 1
    }

    pub(super) fn vectors(&mut self, values: &[Vec3]) -> usize {
        let bytes = values.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes);
        self.accessor(bytes, FLOAT, "VEC3", values.len())
    }

    /// With the bounds that the format asks for of positions.
    pub(super) fn positions(&mut self, values: &[Vec3]) -> usize {
        let accessor = self.vectors(values);
        let low = values.iter().fold(Vec3::INFINITY, |low, v| low.min(*v));
        let high = values.iter().fold(Vec3::NEG_INFINITY, |high, v| high.max(*v));
        self.accessors[accessor]["min"] = json!(low.to_array());
        self.accessors[accessor]["max"] = json!(high.to_array());
        accessor
    }

    pub(super) fn pairs(&mut self, values: &[Vec2]) -> usize {
        let bytes = values.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes);
        self.accessor(bytes, FLOAT, "VEC2", values.len())
    }

    pub(super) fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes = triangles.iter().flatten().flat_map(|i| i.to_le_bytes());
        self.accessor(bytes, UNSIGNED, "SCALAR", 3 * triangles.len())
    }

    /// The bytes of the file.
    pub(super) fn finish(mut self) -> Vec<u8> {
        let nodes: Vec<usize> = (0..self.nodes.len()).collect();
        let mut scene = json!({ "nodes": nodes });
        if !self.extras.is_null() {
            scene["extras"] = self.extras;
        }
        let mut document =
            json!({ "asset": { "version": "2.0", "generator": "Halflight" }, "scene": 0, "scenes": [scene] });
        if !self.lights.is_empty() {
            self.extensions.push("KHR_lights_punctual");
            document["extensions"] = json!({ "KHR_lights_punctual": { "lights": self.lights } });
        }
        self.extensions.sort_unstable();
        self.extensions.dedup();
        let buffers = match self.bytes.len() {
            0 => Vec::new(),
            length => vec![json!({ "byteLength": length })],
        };
        // The format wants no empty lists.
        let lists = [
            ("buffers", buffers),
            ("bufferViews", self.views),
            ("accessors", self.accessors),
            ("meshes", self.meshes),
            ("materials", self.materials),
            ("images", self.images),
            ("textures", self.textures),
            ("nodes", self.nodes),
            ("cameras", self.cameras),
            ("extensionsUsed", self.extensions.into_iter().map(Value::from).collect()),
        ];
        for (name, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            document[name] = Value::Array(list);
        }
        assembled(document.to_string(), &self.bytes)
    }
}

/// Header and chunks (glTF 2.0, 4.4).
fn assembled(mut json: String, bytes: &[u8]) -> Vec<u8> {
    let padding = json.len().next_multiple_of(4) - json.len();
    json.extend(std::iter::repeat_n(' ', padding));
    let length = 12 + 8 + json.len() + if bytes.is_empty() { 0 } else { 8 + bytes.len() };
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((length as u32).to_le_bytes());
    file.extend((json.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(json.as_bytes());
    if !bytes.is_empty() {
        file.extend((bytes.len() as u32).to_le_bytes());
        file.extend(b"BIN\0");
        file.extend(bytes);
    }
    file
}
