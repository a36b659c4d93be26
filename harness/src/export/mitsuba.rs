//! Scenes as Mitsuba 3 reads them.

use super::radiance_map::RadianceMap;
use super::{ply, write};
use crate::Error;
use halflight_scenes::{Emission, Frame, KeyLight, Light, Mesh, Object, Rgb, Scene, Shape, Sky, Sphere};
use std::collections::BTreeMap;
use std::path::Path;

/// Distance of what is infinitely far, in the farthest receiver's from the origin and at least in 10 m: between receivers it seems to shift by
/// 1e-5 rad, and directions towards it keep all the digits that `f32` has.
const FAR: f64 = 1e5;
/// Widest key light in radians: the disc for a wider one would be so large that directions to its middle are rarely sampled.
const WIDEST: f32 = 1.3;
/// Most shapes that the triangles of one object are sorted into.
const MOST_RADIANCES: usize = 4096;
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
    let farthest = frame.receivers.position.iter().map(|position| position.length()).fold(10.0, f32::max);
    let far = FAR * f64::from(farthest);
    let distant = |(index, light): (usize, &Light)| {
        Ok(format!("    <include filename=\"shapes.xml\"/>\n{}", emitter(light, far, index, out)?))
    };
    let mut lights: Vec<String> = frame.lights().enumerate().map(distant).collect::<Result<_, Error>>()?;
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
        if !object.casts {
            continue;
        }
        let shape = posed.in_place();
        let mesh = match &*shape {
            Shape::Mesh(mesh) => mesh,
            Shape::Heights(field) => field.mesh(),
            Shape::Spheres(spheres) => {
                let surface = surface(object, lit.then(|| object.emission.of(0)));
                text.extend(spheres.iter().map(|s| sphere(s, &surface)));
                continue;
            }
        };
        match &object.emission {
            Emission::Triangles(radiances) if lit => {
                let groups = groups(radiances);
                if groups.len() > MOST_RADIANCES {
                    let message =
                        format!("emits {} different radiances, expected at most {MOST_RADIANCES}", groups.len());
                    return Err(Error::Other(format!("{}: object `{}` {message}", scene.name, object.name)));
                }
                for (number, (radiance, members)) in groups.into_iter().enumerate() {
                    let name = format!("mesh-{}-{number}.ply", posed.object);
                    text += &triangles(&part(mesh, &members), &name, &surface(object, Some(radiance)), out)?;
                }
            }
            emission => {
                let surface = surface(object, lit.then(|| emission.of(0)));
                text += &triangles(mesh, &format!("mesh-{}.ply", posed.object), &surface, out)?;
            }
        }
    }
    Ok(text)
}

/// Triangles of the same radiance together.
fn groups(radiances: &[Rgb]) -> Vec<(Rgb, Vec<usize>)> {
    let mut groups: BTreeMap<[u32; 3], Vec<usize>> = BTreeMap::new();
    for (triangle, radiance) in radiances.iter().enumerate() {
        groups.entry(radiance.to_array().map(f32::to_bits)).or_default().push(triangle);
    }
    groups.into_values().map(|members| (radiances[members[0]], members)).collect()
}

/// Some of a mesh's triangles.
fn part(mesh: &Mesh, members: &[usize]) -> Mesh {
    Mesh {
        positions: members.iter().flat_map(|triangle| mesh.corners(*triangle)).collect(),
        triangles: (0..members.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    }
}

/// Diffuse on both sides; light is emitted from the front alone, as Mitsuba has it too.
fn surface(object: &Object, radiance: Option<Rgb>) -> String {
    let emission = match radiance.filter(|radiance| *radiance != Rgb::ZERO) {
        Some(radiance) => format!("<emitter type=\"area\">{}</emitter>", rgb("radiance", radiance.to_array())),
        None => String::new(),
    };
    let albedo = rgb("reflectance", object.albedo.to_array());
    format!("<bsdf type=\"twosided\"><bsdf type=\"diffuse\">{albedo}</bsdf></bsdf>{emission}")
}

/// With geometric normals, about which surfaces reflect.
fn triangles(mesh: &Mesh, name: &str, surface: &str, out: &Path) -> Result<String, Error> {
    write(&out.join(name), &ply::bytes(mesh))?;
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

fn emitter(light: &Light, far: f64, index: usize, out: &Path) -> Result<String, Error> {
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
        Light::Key(key) => key_light(key, far),
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

/// A disc at the distance `far` that is seen under the light's angle. (Of a sphere of the sun's size Mitsuba has the solid angle half a percent
/// wrong: `1 − cos` in `f32`.)
fn key_light(key: &KeyLight, far: f64) -> Result<String, Error> {
    if key.angular_radius > WIDEST {
        return Err(Error::Other(format!(
            "key light of angular radius {} rad: expected at most {WIDEST}, wider ones cannot be exported",
            key.angular_radius
        )));
    }
    let radius = far * f64::from(key.angular_radius).tan();
    let (x, y, z) = (far * key.direction.as_dvec3()).into();
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
