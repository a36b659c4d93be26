//! Scenes as Mitsuba 3 reads them.

use super::radiance_map::RadianceMap;
use super::{ply, write};
use crate::Error;
use halflight_scenes::{Frame, KeyLight, Light, Mesh, Object, Scene, Shape, Sky, Sphere};
use std::path::Path;

/// Distance of what is infinitely far, in metres: to receivers some metres apart it seems to shift by 1e-5 rad, and directions
/// towards it keep all the digits that `f32` has.
const FAR: f64 = 1e6;
/// Widest key light in radians: the disc for a wider one would be so large that directions to its middle are rarely sampled.
const WIDEST: f32 = 1.3;
/// A [`RadianceMap`] has y up and azimuth 0 towards −z: to z up and +x.
const UPRIGHT: &str = "0 0 -1 0  -1 0 0 0  0 1 0 0  0 0 0 1";

/// Of what is only a light.
const BLACK: &str = "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0\"/></bsdf>";

/// Writes one scene a distant light and one with all objects that emit, each with all that takes part in light transport: light
/// adds up, and Mitsuba takes no two environments. Their file names.
pub(super) fn write_scenes(scene: &Scene, frame: &Frame, out: &Path) -> Result<Vec<String>, Error> {
    if let Some(lamp) = scene.objects.iter().find(|object| object.emits() && !object.casts) {
        let message = "emits but does not cast, which no shape of Mitsuba can; expected `casts = true`";
        return Err(Error::Other(format!("{}: object `{}` {message}", scene.name, lamp.name)));
    }
    if let Some(object) = scene.objects.iter().find(|object| object.casts && object.texture.is_some()) {
        let message = "reflects through a texture, which is not exported; expected one albedo";
        return Err(Error::Other(format!("{}: object `{}` {message}", scene.name, object.name)));
    }
    std::fs::create_dir_all(out).map_err(|source| Error::Io { path: out.to_owned(), source })?;
    write(&out.join("shapes.xml"), document(&shapes(scene, frame, false, out)?).as_bytes())?;
    let distant = |(index, light): (usize, &Light)| {
        Ok(format!("    <include filename=\"shapes.xml\"/>\n{}", emitter(light, index, out)?))
    };
    let mut lights: Vec<String> = scene.lights.iter().enumerate().map(distant).collect::<Result<_, Error>>()?;
    if scene.objects.iter().any(Object::emits) {
        lights.push(shapes(scene, frame, true, out)?);
    }
    let one = |(index, content): (usize, String)| {
        let name = format!("light-{index}.xml");
        write(&out.join(&name), document(&content).as_bytes())?;
        Ok(name)
    };
    lights.into_iter().enumerate().map(one).collect()
}

fn document(content: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{content}</scene>\n")
}

/// All that casts shadows, and so reflects; `lit` with what it emits.
fn shapes(scene: &Scene, frame: &Frame, lit: bool, out: &Path) -> Result<String, Error> {
    let mut text = String::new();
    for posed in &frame.objects {
        let object = &scene.objects[posed.object];
        let surface = surface(object, lit);
        match &*posed.in_place() {
            _ if !object.casts => {}
            Shape::Mesh(mesh) => text += &triangles(mesh, posed.object, &surface, out)?,
            Shape::Heights(field) => text += &triangles(field.mesh(), posed.object, &surface, out)?,
            Shape::Spheres(spheres) => text.extend(spheres.iter().map(|s| sphere(s, &surface))),
        }
    }
    Ok(text)
}

/// Diffuse on both sides; light is emitted from the front alone, as Mitsuba has it too.
fn surface(object: &Object, lit: bool) -> String {
    let emission = match lit && object.emits() {
        true => format!("<emitter type=\"area\">{}</emitter>", rgb("radiance", object.emission.to_array())),
        false => String::new(),
    };
    let albedo = rgb("reflectance", object.albedo.to_array());
    format!("<bsdf type=\"twosided\"><bsdf type=\"diffuse\">{albedo}</bsdf></bsdf>{emission}")
}

/// With geometric normals, about which surfaces reflect.
fn triangles(mesh: &Mesh, object: usize, surface: &str, out: &Path) -> Result<String, Error> {
    let name = format!("mesh-{object}.ply");
    write(&out.join(&name), &ply::bytes(mesh))?;
    Ok(format!(
        "    <shape type=\"ply\"><string name=\"filename\" value=\"{name}\"/>\
         <boolean name=\"face_normals\" value=\"true\"/>{surface}</shape>\n"
    ))
}

fn sphere(sphere: &Sphere, surface: &str) -> String {
    let ([x, y, z], radius) = (sphere.center.to_array(), sphere.radius);
    format!(
        "    <shape type=\"sphere\"><point name=\"center\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>\
         <float name=\"radius\" value=\"{radius}\"/>{surface}</shape>\n"
    )
}

fn emitter(light: &Light, index: usize, out: &Path) -> Result<String, Error> {
    match light {
        Light::Environment(map) => {
            let turn = f64::from(map.rotation).to_degrees();
            let turn = format!("<matrix value=\"{UPRIGHT}\"/><rotate z=\"1\" angle=\"{turn}\"/>");
            envmap(&RadianceMap::of_environment(map), &turn, index, out)
        }
        Light::Sky(Sky::Uniform(radiance)) => {
            Ok(format!("    <emitter type=\"constant\">{}</emitter>\n", rgb("radiance", radiance.to_array())))
        }
        Light::Sky(Sky::Overcast(_)) => {
            let map = RadianceMap::of_elevation(|direction| light.radiance(direction));
            envmap(&map, &format!("<matrix value=\"{UPRIGHT}\"/>"), index, out)
        }
        Light::Key(key) => key_light(key),
    }
}

fn envmap(map: &RadianceMap, to_world: &str, index: usize, out: &Path) -> Result<String, Error> {
    let name = format!("environment-{index}.exr");
    let path = out.join(&name);
    map.write(&path).map_err(|error| Error::Other(format!("{}: {error}", path.display())))?;
    Ok(format!(
        "    <emitter type=\"envmap\" id=\"environment\"><string name=\"filename\" value=\"{name}\"/>\
         <transform name=\"to_world\">{to_world}</transform></emitter>\n"
    ))
}

/// A far disc that is seen under the light's angle. (Of a sphere of the sun's size Mitsuba has the solid angle half a percent
/// wrong: `1 − cos` in `f32`.)
fn key_light(key: &KeyLight) -> Result<String, Error> {
    if key.angular_radius > WIDEST {
        return Err(Error::Other(format!(
            "key light of angular radius {} rad: expected at most {WIDEST}, wider ones cannot be exported",
            key.angular_radius
        )));
    }
    let radius = FAR * f64::from(key.angular_radius).tan();
    let (x, y, z) = (FAR * key.direction.as_dvec3()).into();
    let (u, v, w) = key.direction.as_dvec3().any_orthonormal_vector().into();
    let look = format!("<lookat origin=\"{x}, {y}, {z}\" target=\"0, 0, 0\" up=\"{u}, {v}, {w}\"/>");
    Ok(format!(
        "    <shape type=\"disk\"><transform name=\"to_world\"><scale value=\"{radius}\"/>{look}</transform>\
         {BLACK}<emitter type=\"area\">{}</emitter></shape>\n",
        rgb("radiance", key.radiance.to_array())
    ))
}

fn rgb(name: &str, [r, g, b]: [f32; 3]) -> String {
    format!("<rgb name=\"{name}\" value=\"{r} {g} {b}\"/>")
}
