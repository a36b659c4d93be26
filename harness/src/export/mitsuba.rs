//! Scenes as Mitsuba 3 reads them.

use super::radiance_map::RadianceMap;
use super::{ply, write};
use crate::Error;
use halflight_scenes::{Frame, KeyLight, Light, Mesh, Scene, Shape, Sky};
use std::path::Path;

/// Distance of what is infinitely far, in metres: to receivers some metres apart it seems to shift by 1e-5 rad, and directions
/// towards it keep all the digits that `f32` has.
const FAR: f64 = 1e6;
/// Widest key light in radians: the disc for a wider one would be so large that directions to its middle are rarely sampled.
const WIDEST: f32 = 1.3;
/// A [`RadianceMap`] has y up and azimuth 0 towards −z: to z up and +x.
const UPRIGHT: &str = "0 0 -1 0  -1 0 0 0  0 1 0 0  0 0 0 1";

/// Writes the blockers and one scene a light into a folder; the names of the latter.
pub(super) fn write_scenes(scene: &Scene, frame: &Frame, out: &Path) -> Result<Vec<String>, Error> {
    std::fs::create_dir_all(out).map_err(|source| Error::Io { path: out.to_owned(), source })?;
    write(&out.join("shapes.xml"), document(&shapes(scene, frame, out)?).as_bytes())?;
    let one = |(index, light): (usize, &Light)| {
        let name = format!("light-{index}.xml");
        let content = format!("    <include filename=\"shapes.xml\"/>\n{}", emitter(light, index, out)?);
        write(&out.join(&name), document(&content).as_bytes())?;
        Ok(name)
    };
    scene.lights.iter().enumerate().map(one).collect()
}

fn document(content: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{content}</scene>\n")
}

/// All that casts shadows.
fn shapes(scene: &Scene, frame: &Frame, out: &Path) -> Result<String, Error> {
    let mut text = String::new();
    for posed in &frame.objects {
        let object = &scene.objects[posed.object];
        match &*object.shape.posed(posed.pose) {
            _ if !object.casts => {}
            Shape::Mesh(mesh) => text += &triangles(mesh, posed.object, out)?,
            Shape::Heights(field) => text += &triangles(field.mesh(), posed.object, out)?,
            Shape::Spheres(spheres) => text.extend(spheres.iter().map(|s| sphere(s.center.to_array(), s.radius))),
        }
    }
    Ok(text)
}

fn triangles(mesh: &Mesh, object: usize, out: &Path) -> Result<String, Error> {
    let name = format!("mesh-{object}.ply");
    write(&out.join(&name), &ply::bytes(mesh))?;
    Ok(format!("    <shape type=\"ply\"><string name=\"filename\" value=\"{name}\"/></shape>\n"))
}

fn sphere([x, y, z]: [f32; 3], radius: f32) -> String {
    format!(
        "    <shape type=\"sphere\"><point name=\"center\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>\
         <float name=\"radius\" value=\"{radius}\"/></shape>\n"
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
            Ok(format!("    <emitter type=\"constant\">{}</emitter>\n", rgb(radiance.to_array())))
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
         <emitter type=\"area\">{}</emitter></shape>\n",
        rgb(key.radiance.to_array())
    ))
}

fn rgb([r, g, b]: [f32; 3]) -> String {
    format!("<rgb name=\"radiance\" value=\"{r} {g} {b}\"/>")
}
