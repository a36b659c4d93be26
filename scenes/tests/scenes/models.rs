//! glTF models: poses against a stranger's evaluation, and what is wrong with files.

use std::process::Command;

use glam::Vec3;
use halflight_scenes::{Rgb, Scene, Shape};

use crate::folder::Folder;

/// A GLB under construction: views and accessors over one binary chunk.
#[derive(Default)]
pub(crate) struct Builder {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Builder {
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}}}"#));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize, more: &str) -> usize {
        let view = self.view(bytes);
        let head = format!(r#""bufferView":{view},"componentType":{component},"type":"{kind}","count":{count}"#);
        self.accessors.push(format!("{{{head}{more}}}"));
        self.accessors.len() - 1
    }

    pub(crate) fn floats(&mut self, kind: &str, width: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        // Bounds are only needed of positions, where they are not looked at but must be there.
        let more = if kind == "VEC3" { r#","min":[-9,-9,-9],"max":[9,9,9]"# } else { "" };
        self.accessor(&bytes, 5126, kind, values.len() / width, more)
    }

    fn times(&mut self, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let more = format!(r#","min":[{}],"max":[{}]"#, values[0], values[values.len() - 1]);
        self.accessor(&bytes, 5126, "SCALAR", values.len(), &more)
    }

    pub(crate) fn finish(mut self, rest: &str) -> Vec<u8> {
        let (views, accessors, length) = (self.views.join(","), self.accessors.join(","), self.bytes.len());
        let mut json = format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{length}}}],"bufferViews":[{views}],"accessors":[{accessors}],{rest}}}"#
        );
        json.extend(std::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend(((28 + json.len() + self.bytes.len()) as u32).to_le_bytes());
        file.extend((json.len() as u32).to_le_bytes());
        file.extend(b"JSON");
        file.extend(json.as_bytes());
        file.extend((self.bytes.len() as u32).to_le_bytes());
        file.extend(b"BIN\0");
        file.append(&mut self.bytes);
        file
    }
}

const SIDES: usize = 7;
const RINGS: usize = 5;

/// A tube on two joints under a turned and scaled root, and a flag that the second joint carries.
pub(crate) fn model() -> Vec<u8> {
    let mut file = Builder::default();
    let (mut points, mut joints, mut weights, mut corners) = (Vec::new(), Vec::new(), Vec::new(), Vec::<u16>::new());
    for (ring, side) in (0..RINGS).flat_map(|ring| (0..SIDES).map(move |side| (ring, side))) {
        let (angle, up) = (side as f32 / SIDES as f32 * std::f32::consts::TAU, ring as f32 * 0.5);
        points.extend([0.3 * angle.cos(), up, 0.3 * angle.sin()]);
        joints.extend([1u8, 0, 1, 0]);
        let upper = (ring * 255 / (RINGS - 1)) as u8;
        weights.extend([upper, 255 - upper, 0, 0]);
        if ring + 1 < RINGS {
            let [a, b] = [ring * SIDES + side, ring * SIDES + (side + 1) % SIDES];
            corners.extend([a, a + SIDES, b, b, a + SIDES, b + SIDES].map(|i| i as u16));
        }
    }
    let count = points.len() / 3;
    let positions = file.floats("VEC3", 3, &points);
    let joints = file.accessor(&joints, 5121, "VEC4", count, "");
    let weights = file.accessor(&weights, 5121, "VEC4", count, r#","normalized":true"#);
    let corner_bytes: Vec<u8> = corners.iter().flat_map(|i| i.to_le_bytes()).collect();
    let indices = file.accessor(&corner_bytes, 5123, "SCALAR", corners.len(), "");
    // Columns; the second undoes the upper joint's place and half a turn about y.
    let lower = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let upper = [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.1, -1.0, 0.2, 1.0];
    let inverse = file.floats("MAT4", 16, &[lower, upper].concat());
    let flag = file.floats("VEC3", 3, &[0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.5, 0.1]);
    let times = file.times(&[0.0, 0.5, 1.25]);
    let turns = file.floats("VEC4", 4, &[0.0, 0.0, 0.0, 1.0, 0.5, 0.5, -0.5, 0.5, 0.0, 0.6, 0.0, -0.8]);
    let spline: Vec<f32> = (0..27).map(|i| (i as f32 * 0.7).sin()).collect();
    let moves = file.floats("VEC3", 3, &spline);
    let scales = file.floats("VEC3", 3, &[1.0, 1.0, 1.0, 1.5, 0.5, 1.0, 0.7, 0.7, 2.0]);
    let spin: Vec<f32> = (0..36).map(|i| (i as f32 * 0.9).cos()).collect();
    let spins = file.floats("VEC4", 4, &spin);
    file.finish(&format!(
        r#""scene":0,"scenes":[{{"nodes":[0,4]}}],
        "nodes":[{{"translation":[0.2,0.1,-0.3],"rotation":[0,0.28,0,0.96],"scale":[1.2,0.8,1.1],"children":[1]}},
            {{"translation":[0,0.1,0],"children":[2,3]}},
            {{"translation":[0,1,0],"rotation":[0,1,0,0],"children":[5]}},
            {{"matrix":[1,0,0,0,0,0,1,0,0,-1,0,0,0.5,0,0.25,1]}},
            {{"mesh":0,"skin":0,"translation":[5,5,5]}},
            {{"mesh":1,"matrix":[1,0,0,0,0,0,1,0,0,-1,0,0,0.5,0,0.25,1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},
            "indices":{indices},"material":0}}]}},{{"primitives":[{{"attributes":{{"POSITION":{flag}}}}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.25,0.125,1]}},"emissiveFactor":[0,0,1]}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":{inverse}}}],
        "animations":[{{"name":"wave","samplers":[
            {{"input":{times},"output":{turns}}},
            {{"input":{times},"output":{moves},"interpolation":"CUBICSPLINE"}},
            {{"input":{times},"output":{scales},"interpolation":"STEP"}},
            {{"input":{times},"output":{spins},"interpolation":"CUBICSPLINE"}}],
          "channels":[
            {{"sampler":0,"target":{{"node":1,"path":"rotation"}}}},
            {{"sampler":1,"target":{{"node":2,"path":"translation"}}}},
            {{"sampler":2,"target":{{"node":0,"path":"scale"}}}},
            {{"sampler":3,"target":{{"node":2,"path":"rotation"}}}}]}}]"#
    ))
}

pub(crate) fn scene(entry: &str) -> String {
    format!(
        "purpose = \"A model\"\n[receivers.grid]\ncenter = [0.0, 0.0, 0.0]\nsize = [1.0, 1.0]\nresolution = [2, 2]\n\
         [[objects]]\nname = \"model\"\ngltf = {{ file = \"model.glb\", {entry} }}\n[[lights]]\n\
         sky = {{ uniform = [1.0, 1.0, 1.0] }}\n[frames]\ncount = 31\nfps = 20.0\n"
    )
}

fn loaded(file: &[u8], entry: &str) -> Result<Scene, String> {
    let folder = Folder::new();
    folder.write("model.glb", file);
    folder.load(&scene(entry)).map_err(|error| error.to_string())
}

fn points(scene: &Scene, frame: usize, object: usize) -> Vec<Vec3> {
    match &*scene.frame(frame).objects[object].in_place() {
        Shape::Mesh(mesh) => mesh.positions.clone(),
        _ => panic!("a mesh"),
    }
}

/// The Python that `HALFLIGHT_PYTHON` names, or `python3` if that has what the script needs.
fn python() -> Option<String> {
    if let Ok(named) = std::env::var("HALFLIGHT_PYTHON") {
        return Some(named);
    }
    let imports = Command::new("python3").args(["-c", "import numpy, pygltflib"]).output();
    imports.is_ok_and(|said| said.status.success()).then(|| "python3".to_owned())
}

/// Largest distance of our vertices from the script's over some frames.
fn farthest(python: &str, clip: &str) -> f32 {
    let folder = Folder::new();
    folder.write("model.glb", model());
    let scene = folder.load(&scene(&format!("clip = \"{clip}\""))).expect("it loads");
    let frames = [0, 3, 10, 11, 24, 25, 30];
    let times = frames.map(|frame| scene.frame(frame).time.to_string());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/poses/gltf.py");
    let said = Command::new(python).arg(script).arg(folder.path("model.glb")).arg("wave").args(times).output();
    let said = said.expect("Python runs");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let posed: Vec<Vec<Vec<[f32; 3]>>> = serde_json::from_slice(&said.stdout).expect("JSON");
    let mut farthest = 0f32;
    for (frame, meshes) in frames.iter().zip(posed) {
        assert_eq!(meshes.len(), scene.objects.len());
        for (object, expected) in meshes.iter().enumerate() {
            let ours = points(&scene, *frame, object);
            assert_eq!(ours.len(), expected.len());
            let upright = expected.iter().map(|[x, y, z]| Vec3::new(*x, -z, *y));
            farthest = ours.iter().zip(upright).map(|(ours, theirs)| ours.distance(theirs)).fold(farthest, f32::max);
        }
    }
    farthest
}

#[test]
fn posed_vertices_are_those_of_a_strangers_evaluation() {
    let Some(python) = python() else { return eprintln!("skipped: no Python with numpy and pygltflib") };
    assert!(farthest(&python, "wave") < 1e-5, "{}", farthest(&python, "wave"));
}

#[test]
fn what_the_file_says_of_looks_and_motion_is_taken_over() {
    let scene = loaded(&model(), "clip = \"0\", play = { start = 0.5, speed = 2.0, repeat = true }").unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["model.0", "model.1"]);
    let looks = (scene.objects[0].albedo, &scene.objects[0].emission);
    assert_eq!(looks, (Rgb::new(0.5, 0.25, 0.125), &Rgb::Z.into()));
    assert_eq!(scene.facts().deforming, 2);
    // Twice as fast, 1.25 s long: from 0.5 s over the end to the beginning.
    let plain = loaded(&model(), "clip = \"wave\"").unwrap();
    for (sped, plain_frame) in [(0, 10), (4, 18), (10, 5)] {
        let (a, b) = (points(&scene, sped, 0), points(&plain, plain_frame, 0));
        let farthest = a.iter().zip(&b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(farthest < 1e-5, "frame {sped}: {farthest}");
    }
    let revisions = |frame: usize| scene.frame(frame).objects.iter().map(|posed| posed.revision).collect::<Vec<_>>();
    assert_ne!(revisions(0), revisions(1));
    assert_eq!(revisions(3), revisions(3));
    let still = loaded(&model(), "").unwrap();
    assert_eq!((still.facts().deforming, still.facts().moving), (0, false));
    assert_eq!(points(&still, 0, 0), points(&still, 30, 0));
}

#[test]
fn errors_name_file_and_field() {
    for (entry, expected) in [
        ("clip = \"fly\"", "model.glb: animations: expected one of [\"wave\"], found \"fly\""),
        ("play = { speed = inf }", "objects[0].gltf.play.speed: expected a finite number"),
        ("play = { sped = 1.0 }", "unknown field `sped`"),
    ] {
        let error = loaded(&model(), entry).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
    let whole = model();
    for end in (0..whole.len()).step_by(97) {
        let error = loaded(&whole[..end], "clip = \"wave\"").unwrap_err();
        assert!(error.contains("model.glb") && !error.contains('\n'), "{end}: {error}");
    }
    let text = String::from_utf8_lossy(&whole).into_owned();
    assert!(text.contains("\"children\":[2,3]"));
    for (from, to, expected) in [
        (r#""children":[2,3]"#, r#""children":[2,0]"#, "nodes: expected a hierarchy without circles"),
        (r#""children":[2,3]"#, r#""children":[2,5]"#, "expected at most one parent"),
        (r#""joints":[1,2]"#, r#""joints":[1]  "#, "expected joints below 1, found 1"),
        (r#""scene":0"#, r#""scene":9"#, "glTF"),
        (r#""rotation":[0,0.28,0,0.96]"#, r#""rotation":[0,0.00,0,0.00]"#, "a rotation that is not zero"),
    ] {
        let bytes = replaced(&whole, from.as_bytes(), to.as_bytes());
        let error = loaded(&bytes, "clip = \"wave\"").unwrap_err();
        assert!(error.contains(expected), "{to}: {error}");
    }
}

/// The bytes with the first occurrence of some others replaced by as many.
fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|window| window == from).expect("it is there");
    let padded = [to, &vec![b' '; from.len().saturating_sub(to.len())]].concat();
    [&bytes[..at], &padded[..], &bytes[at + from.len()..]].concat()
}
