//! From a scene to glTF: `halflight export --to gltf`.

mod glb;
mod picture;

use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat, DVec3, Vec3};
use serde_json::{Value, json};

use crate::assets::extras::{self, Afar};
use crate::{
    Camera, Content, Emission, Frame, KeyLight, Light, Mesh, Object, Rgb, Scene, SceneError, Shape, Sky, Sphere, solids,
};

use glb::Glb;

/// Times that the octahedron is cut which stands for a sphere: 2048 triangles.
const CUTS: u32 = 4;

/// A model that was written.
#[derive(Debug)]
pub struct Exported {
    /// The GLB.
    pub file: PathBuf,
    /// What glTF cannot hold, a line each.
    pub notices: Vec<String>,
}

/// Writes a frame of a scene into a folder, which is made if need be: `NAME.glb` with objects in place, lights, camera, and
/// `NAME-environment-N.exr` for each picture of the surroundings, y up, in metres. A key light becomes a directional light of
/// the same irradiance, a lamp that does not cast a point light of the same intensity; what glTF has no words for lies in
/// `extras`. [`import`](crate::import()) of the model gives the same scene.
///
/// # Errors
/// A file that cannot be written.
pub fn export_gltf(scene: &Scene, frame: usize, out: &Path) -> Result<Exported, SceneError> {
    std::fs::create_dir_all(out).map_err(|reason| SceneError::Unwritable { file: out.to_owned(), reason })?;
    let mut export = Export { scene, out, glb: Glb::default(), notices: Vec::new(), textures: HashMap::new() };
    let posed = scene.frame(frame);
    export.objects(&posed)?;
    export.lights(&posed)?;
    if let Some(camera) = &scene.camera {
        export.camera(camera);
    }
    export.say_what_is_lost(frame);
    let file = out.join(format!("{}.glb", scene.name));
    let bytes = export.glb.finish();
    std::fs::write(&file, bytes).map_err(|reason| SceneError::Unwritable { file: file.clone(), reason })?;
    Ok(Exported { file, notices: export.notices })
}

struct Export<'a> {
    scene: &'a Scene,
    out: &'a Path,
    glb: Glb,
    notices: Vec<String>,
    /// Indices of textures by their content.
    textures: HashMap<Content, usize>,
}

impl Export<'_> {
    fn objects(&mut self, frame: &Frame) -> Result<(), SceneError> {
        for posed in &frame.objects {
            let object = &self.scene.objects[posed.object];
            match &*posed.in_place() {
                Shape::Mesh(mesh) => self.mesh(object, mesh)?,
                Shape::Heights(field) => self.mesh(object, field.mesh())?,
                Shape::Spheres(spheres) if object.emits() && !object.casts => {
                    spheres.iter().for_each(|sphere| self.lamp(object, sphere));
                }
                Shape::Spheres(spheres) => {
                    self.notices.push(format!("{}: spheres became triangles", object.name));
                    self.mesh(object, &tessellated(spheres))?;
                }
            }
        }
        Ok(())
    }

    fn mesh(&mut self, object: &Object, mesh: &Mesh) -> Result<(), SceneError> {
        let lying = |vectors: &[Vec3]| vectors.iter().map(|v| lying(*v)).collect::<Vec<_>>();
        let mut attributes = json!({
            "POSITION": self.glb.positions(&lying(&mesh.positions)),
            "NORMAL": self.glb.vectors(&lying(&mesh.normals)),
        });
        if !mesh.uvs.is_empty() {
            attributes["TEXCOORD_0"] = self.glb.pairs(&mesh.uvs).into();
        }
        let (indices, material) = (self.glb.triangles(&mesh.triangles), self.material(object, mesh)?);
        self.glb.meshes.push(json!({
            "name": object.name,
            "primitives": [{ "attributes": attributes, "indices": indices, "material": material }],
        }));
        let pivot = (object.pivot != Vec3::ZERO).then(|| self::lying(object.pivot).to_array());
        let ours = extras::Node { casts: (!object.casts).then_some(false), pivot, ..extras::Node::default() };
        self.node(&object.name, json!({ "mesh": self.glb.meshes.len() - 1 }), &ours);
        Ok(())
    }

    fn material(&mut self, object: &Object, mesh: &Mesh) -> Result<usize, SceneError> {
        let [r, g, b] = object.albedo.to_array();
        let mut base = json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0 });
        if let Some(texture) = self.texture(object)? {
            base["baseColorTexture"] = json!({ "index": texture });
        }
        let mut material = json!({ "name": object.name, "pbrMetallicRoughness": base });
        let emission = self.mean_emission(object, mesh);
        if emission != Rgb::ZERO {
            // A power of two, so that no digit is lost.
            let strength = emission.max_element().log2().ceil().max(0.0).exp2();
            material["emissiveFactor"] = json!((emission / strength).to_array());
            if strength > 1.0 {
                material["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
                self.glb.extensions.push("KHR_materials_emissive_strength");
            }
        }
        self.glb.materials.push(material);
        Ok(self.glb.materials.len() - 1)
    }

    /// Over its surface.
    fn mean_emission(&mut self, object: &Object, mesh: &Mesh) -> Rgb {
        match &object.emission {
            Emission::Even(radiance) => *radiance,
            Emission::Triangles(triangles) => {
                self.notices.push(format!("{}: what its triangles emit became one mean", object.name));
                let area = |triangle: usize| {
                    let [a, b, c] = mesh.corners(triangle).map(Vec3::as_dvec3);
                    (b - a).cross(c - a).length()
                };
                let all: f64 = (0..triangles.len()).map(area).sum();
                let sum: DVec3 = triangles.iter().enumerate().map(|(i, light)| light.as_dvec3() * area(i)).sum();
                (sum / all).as_vec3()
            }
        }
    }

    fn texture(&mut self, object: &Object) -> Result<Option<usize>, SceneError> {
        let Some(texture) = &object.texture else { return Ok(None) };
        if let Some(known) = self.textures.get(&texture.content()) {
            return Ok(Some(*known));
        }
        let png = picture::png(texture).map_err(|error| self.unwritten(&object.name, error))?;
        let view = self.glb.view(png);
        self.glb.images.push(json!({ "bufferView": view, "mimeType": "image/png" }));
        self.glb.textures.push(json!({ "source": self.glb.images.len() - 1 }));
        let index = self.glb.textures.len() - 1;
        self.textures.insert(texture.content(), index);
        Ok(Some(index))
    }

    fn lights(&mut self, frame: &Frame) -> Result<(), SceneError> {
        let mut afar = Vec::new();
        for light in frame.lights() {
            match light {
                Light::Sky(Sky::Uniform(radiance)) => afar.push(Afar::Uniform(radiance.to_array())),
                Light::Sky(Sky::Overcast(zenith)) => afar.push(Afar::Overcast(zenith.to_array())),
                Light::Key(key) => self.key(key),
                Light::Environment(map) => {
                    let file = format!("{}-environment-{}.exr", self.scene.name, afar.len());
                    let path = self.out.join(&file);
                    picture::write_exr(map, &path).map_err(|error| self.unwritten(&file, error))?;
                    afar.push(Afar::Environment { file, rotate: shown(map.rotation.to_degrees()) });
                }
            }
        }
        self.glb.extras = extras::holding(&extras::Scene { lights: afar });
        Ok(())
    }

    fn key(&mut self, key: &KeyLight) {
        let irradiance = key.radiance.as_dvec3() * PI * f64::from(key.angular_radius).sin().powi(2);
        let light = self.light("directional", irradiance);
        let turn = DQuat::from_rotation_arc(DVec3::Z, lying(key.direction).as_dvec3().normalize());
        let degrees = shown(key.angular_radius.to_degrees());
        let ours = extras::Node { angular_radius: Some(degrees), ..extras::Node::default() };
        self.node("key", json!({ "rotation": turn.as_quat().to_array(), "extensions": light }), &ours);
    }

    fn lamp(&mut self, object: &Object, sphere: &Sphere) {
        let intensity = object.emission.of(0).as_dvec3() * PI * f64::from(sphere.radius).powi(2);
        let light = self.light("point", intensity);
        let ours = extras::Node { radius: Some(sphere.radius), ..extras::Node::default() };
        let center = lying(sphere.center).to_array();
        self.node(&object.name, json!({ "translation": center, "extensions": light }), &ours);
    }

    fn light(&mut self, kind: &str, intensity: DVec3) -> Value {
        let most = intensity.max_element().max(f64::MIN_POSITIVE);
        let color = (intensity / most).as_vec3().to_array();
        self.glb.lights.push(json!({ "type": kind, "color": color, "intensity": most as f32 }));
        json!({ "KHR_lights_punctual": { "light": self.glb.lights.len() - 1 } })
    }

    fn camera(&mut self, camera: &Camera) {
        let [eye, target, up] = [camera.eye, camera.target, camera.up].map(|v| lying(v).as_dvec3());
        let back = (eye - target).normalize();
        let right = up.cross(back).normalize();
        let turn = DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back));
        let near = 1e-3 * eye.distance(target) as f32;
        self.glb.cameras.push(json!({ "type": "perspective", "perspective": {
            "yfov": camera.vertical_fov, "aspectRatio": camera.width as f32 / camera.height as f32, "znear": near,
        } }));
        let (target, size) = (lying(camera.target).to_array(), [camera.width, camera.height]);
        let ours = extras::Node { target: Some(target), size: Some(size), ..extras::Node::default() };
        let rotation = turn.as_quat().to_array();
        self.node(
            "camera",
            json!({ "camera": 0, "translation": lying(camera.eye).to_array(), "rotation": rotation }),
            &ours,
        );
    }

    fn node(&mut self, name: &str, mut node: Value, ours: &extras::Node) {
        node["name"] = name.into();
        if *ours != extras::Node::default() {
            node["extras"] = extras::holding(ours);
        }
        self.glb.nodes.push(node);
    }

    fn say_what_is_lost(&mut self, frame: usize) {
        let moving = self.scene.objects.iter().filter(|object| !object.rests()).count();
        let turning = self.scene.facts().turning;
        if moving + turning > 0 {
            let all = format!("{moving} objects move and {turning} lights turn");
            self.notices.push(format!("{all}: written as they are in frame {frame}"));
        }
    }

    fn unwritten(&self, what: &str, error: impl std::fmt::Display) -> SceneError {
        let reason = std::io::Error::other(error.to_string());
        SceneError::Unwritable { file: self.out.join(what), reason }
    }
}

/// z up to y up, x stays.
fn lying(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// Degrees as they were before they became radians, if somebody wrote them in few digits.
fn shown(degrees: f32) -> f32 {
    format!("{degrees:.5e}").parse().unwrap_or(degrees)
}

fn tessellated(spheres: &[Sphere]) -> Mesh {
    let mut all = Mesh::default();
    for sphere in spheres {
        let ball = solids::ball(sphere.radius, CUTS);
        let first = all.positions.len() as u32;
        all.positions.extend(ball.positions.iter().map(|p| *p + sphere.center));
        all.normals.extend(ball.normals);
        all.triangles.extend(ball.triangles.iter().map(|triangle| triangle.map(|i| i + first)));
    }
    all
}
