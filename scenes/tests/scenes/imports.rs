//! Import: any model becomes a scene that is seen and lit, and an export of it becomes the same scene again.

use std::path::{Path, PathBuf};

use glam::Vec3;
use halflight_scenes::{DistantLight, Import, Imported, Light, Rgb, Scene, Shape, Up, Wanted, export_gltf, import};
use proptest::prelude::*;

use crate::folder::{Folder, cube_ply};
use crate::models::{Builder, model};

fn imported(folder: &Folder, files: &[&str], out: &str, change: impl Fn(&mut Import)) -> Result<Imported, String> {
    let mut request = Import::new(files.iter().map(|file| folder.path(file)).collect());
    change(&mut request);
    import(&request, Some(&folder.path(out)), false).map_err(|error| error.to_string())
}

fn well(folder: &Folder, files: &[&str], out: &str) -> Imported {
    imported(folder, files, out, |_| {}).unwrap()
}

/// Shares of pixels that see each object.
fn seen(scene: &Scene, frame: usize) -> Vec<f32> {
    let receivers = scene.frame(frame).receivers.clone();
    let count = |object: usize| {
        let sees = |i: &usize| receivers.valid[*i] && receivers.place[*i].object == Some(object as u32);
        (0..receivers.len()).filter(sees).count() as f32 / receivers.len() as f32
    };
    (0..scene.objects.len()).map(count).collect()
}

/// A box with corners that are no round numbers, as OBJ.
fn box_obj(center: Vec3, sides: Vec3) -> String {
    let corner = |i: u32| center + sides * (Vec3::from(crate::folder::cube_corner(i)) * 0.5);
    let vertices: String = (0..8).map(corner).map(|v| format!("v {} {} {}\n", v.x, v.y, v.z)).collect();
    let face = |quad: &[u32; 4]| format!("f {} {} {} {}\n", quad[0] + 1, quad[1] + 1, quad[2] + 1, quad[3] + 1);
    vertices + &crate::folder::CUBE_QUADS.iter().map(face).collect::<String>()
}

/// A turned triangle with normals and a texture, a tube, lights of all kinds and a camera.
fn lit_model() -> Vec<u8> {
    let mut file = Builder::default();
    let points = file.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.3, 0.0, 0.1, 0.2, 1.1, 0.0]);
    let normals = file.floats("VEC3", 3, &[0.0, 0.0, 1.0, 0.6, 0.0, 0.8, 0.1, 0.7, 0.7]);
    let uvs = file.floats("VEC2", 2, &[0.1, 0.2, 0.9, 0.2, 0.4, 1.3]);
    let mut png = std::io::Cursor::new(Vec::new());
    let picture = image::RgbImage::from_fn(3, 2, |x, y| image::Rgb([(x * 90) as u8, (y * 200) as u8, 77]));
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = file.view(&png.into_inner());
    file.finish(&format!(
        r#""scene":0,"scenes":[{{"nodes":[0,1,2,3,4]}}],"extensionsUsed":["KHR_lights_punctual"],
        "nodes":[{{"mesh":0,"rotation":[0.1,0.2,0.3,0.9],"translation":[0.1,0.7,-0.3]}},
            {{"rotation":[-0.5,0.1,0.2,0.8],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}},
            {{"translation":[0.3,1.7,0.9],"extensions":{{"KHR_lights_punctual":{{"light":1}}}}}},
            {{"translation":[1,2,3],"extensions":{{"KHR_lights_punctual":{{"light":2}}}}}},
            {{"camera":0,"translation":[0.4,1.2,4.7],"rotation":[-0.05,0.02,0.001,1]}}],
        "cameras":[{{"type":"perspective","perspective":{{"yfov":0.7,"aspectRatio":1.5,"znear":0.1}}}}],
        "extensions":{{"KHR_lights_punctual":{{"lights":[
            {{"type":"directional","color":[1,0.9,0.7],"intensity":3.3}},
            {{"type":"point","color":[0.2,0.5,1],"intensity":40}},
            {{"type":"spot","intensity":7,"spot":{{"outerConeAngle":0.5}}}}]}}}},
        "images":[{{"bufferView":{view},"mimeType":"image/png"}}],"textures":[{{"source":0}}],
        "meshes":[{{"primitives":[{{"material":0,
            "attributes":{{"POSITION":{points},"NORMAL":{normals},"TEXCOORD_0":{uvs}}}}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.3,0.6,0.9,1],"baseColorTexture":{{"index":0}}}},
            "emissiveFactor":[0.3,0.2,0.1]}}]"#
    ))
}

/// Exports a scene and imports that.
fn again(folder: &Folder, scene: &Scene, out: &str) -> Scene {
    let exported = export_gltf(scene, 0, &folder.path(&format!("{out}-export"))).unwrap();
    assert_eq!(exported.notices, Vec::<String>::new());
    let made = import(&Import::new(vec![exported.file]), Some(&folder.path(out)), false).unwrap();
    // What was written is what was loaded on the way.
    assert_eq!(Scene::load(&made.file).unwrap().content, made.scene.content);
    made.scene
}

#[test]
fn an_export_of_an_import_is_imported_as_the_same_scene() {
    let folder = Folder::new();
    folder.write("lit.glb", lit_model());
    folder.write("box.obj", box_obj(Vec3::new(0.1, 0.0, -0.3), Vec3::new(0.7, 1.1, 0.3)));
    folder.write("sky.exr", exr(8, 4));
    for (index, files) in
        [&["lit.glb"][..], &["box.obj"], &["cube.ply", "sky.exr"], &["lit.glb", "box.obj", "cube.ply", "sky.exr"]]
            .iter()
            .enumerate()
    {
        let first = well(&folder, files, &format!("first-{index}")).scene;
        assert_eq!(
            Scene::load(&folder.path(&format!("first-{index}/{}.toml", first.name))).unwrap().content,
            first.content
        );
        let second = again(&folder, &first, &format!("second-{index}"));
        assert_eq!(second.objects.len(), first.objects.len(), "{files:?}");
        for (a, b) in first.objects.iter().zip(&second.objects) {
            assert_eq!(
                (a.content, a.albedo, a.emission.clone(), a.casts),
                (b.content, b.albedo, b.emission.clone(), b.casts),
                "{files:?}"
            );
        }
        assert_eq!(first.camera, second.camera, "{files:?}");
        assert_eq!(first.content, second.content, "{files:?}");
    }
}

/// Radiance that differs from texel to texel, as OpenEXR.
fn exr(width: usize, height: usize) -> Vec<u8> {
    use exr::prelude::*;
    let texel = |at: Vec2<usize>| (0.1 + at.x() as f32, 1.5 * at.y() as f32, 0.3);
    let layer =
        Layer::new((width, height), LayerAttributes::named("x"), Encoding::UNCOMPRESSED, SpecificChannels::rgb(texel));
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn lights_keep_their_irradiance_and_intensity_and_cameras_their_view() {
    let folder = Folder::new();
    folder.write("lit.glb", lit_model());
    let made = well(&folder, &["lit.glb"], "out");
    let scene = &made.scene;
    let [DistantLight { rest: Light::Key(key), .. }] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    // Along the +z axis of its node, turned upright; quaternion (x, y, z, w) = (-0.5, 0.1, 0.2, 0.8).
    let turn = glam::Quat::from_xyzw(-0.5, 0.1, 0.2, 0.8).normalize();
    let towards = turn * Vec3::Z;
    assert!(key.direction.distance(Vec3::new(towards.x, -towards.z, towards.y)) < 2e-5);
    let irradiance = key.radiance * std::f32::consts::PI * key.angular_radius.sin().powi(2);
    assert!(irradiance.distance(Rgb::new(1.0, 0.9, 0.7) * 3.3) < 1e-4, "{irradiance}");
    let lamps: Vec<_> = scene.objects.iter().filter(|object| !object.casts && object.emits()).collect();
    for (lamp, (at, candela)) in lamps
        .iter()
        .zip([(Vec3::new(0.3, -0.9, 1.7), Rgb::new(8.0, 20.0, 40.0)), (Vec3::new(1.0, -3.0, 2.0), Rgb::splat(7.0))])
    {
        let Shape::Spheres(spheres) = &*lamp.shape else { panic!("a lamp is a ball") };
        assert_eq!(spheres[0].center, at);
        let intensity = lamp.emission.of(0) * std::f32::consts::PI * spheres[0].radius.powi(2);
        assert!(intensity.distance(candela) < 1e-3, "{intensity}");
    }
    let camera = scene.camera.unwrap();
    assert_eq!((camera.eye, camera.width, camera.height), (Vec3::new(0.4, -4.7, 1.2), 170, 113));
    assert!((camera.vertical_fov - 0.7).abs() < 1e-6);
    let turn = glam::Quat::from_xyzw(-0.05, 0.02, 0.001, 1.0).normalize();
    let forward = turn * -Vec3::Z;
    let found = (camera.target - camera.eye).normalize();
    assert!(found.distance(Vec3::new(forward.x, -forward.z, forward.y)) < 1e-5);
    let rolled = turn * Vec3::Y;
    let up = camera.up.reject_from_normalized(found).normalize();
    assert!(up.distance(Vec3::new(rolled.x, -rolled.z, rolled.y)) < 3e-3);
    assert!(made.told.iter().any(|line| line.contains("spot light without its cone")), "{:?}", made.told);
}

#[test]
fn clips_become_frames_and_stay_in_view() {
    let folder = Folder::new();
    folder.write("model.glb", model());
    let made = well(&folder, &["model.glb"], "out");
    // 1.25 s at 24 frames a second.
    assert_eq!(made.scene.frame_count, 30);
    let low = |frame: usize| {
        let frame = made.scene.frame(frame);
        let bottom = |shape: &Shape| match shape {
            Shape::Mesh(mesh) => mesh.positions.iter().fold(f32::INFINITY, |low, p| low.min(p.z)),
            _ => f32::INFINITY,
        };
        frame.objects[..2].iter().map(|object| bottom(&object.in_place())).fold(f32::INFINITY, f32::min)
    };
    let Shape::Mesh(ground) = &*made.scene.objects[2].shape else { panic!("the ground is a mesh") };
    assert!((0..30).step_by(2).all(|frame| low(frame) >= ground.positions[0].z), "the model sinks into the ground");
    for frame in [0, 10, 29] {
        assert!(seen(&made.scene, frame)[0] > 0.002, "{:?}", seen(&made.scene, frame));
    }
    assert_eq!(imported(&folder, &["model.glb"], "few", |r| r.frames = 7).unwrap().scene.frame_count, 7);
    let still = imported(&folder, &["model.glb"], "still", |r| r.clip = Some("none".into())).unwrap();
    assert_eq!((still.scene.frame_count, still.scene.facts().deforming), (1, 0));
}

#[test]
fn what_is_asked_for_is_done() {
    let folder = Folder::new();
    folder.write("box.obj", box_obj(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)));
    let sides = |scene: &Scene| match &*scene.objects[0].shape {
        Shape::Mesh(mesh) => {
            let high = mesh.positions.iter().fold(Vec3::NEG_INFINITY, |high, p| high.max(*p));
            high - mesh.positions.iter().fold(Vec3::INFINITY, |low, p| low.min(*p))
        }
        _ => Vec3::ZERO,
    };
    assert_eq!(sides(&well(&folder, &["box.obj"], "y").scene), Vec3::new(1.0, 3.0, 2.0));
    let asked = imported(&folder, &["box.obj"], "z", |r| {
        (r.up, r.unit, r.name, r.size) = (Some(Up::Z), Some(0.5), Some("other".into()), Some([30, 20]));
        (r.receivers, r.ground) = (Wanted::Vertices, false);
    });
    let asked = asked.unwrap();
    assert_eq!((sides(&asked.scene), asked.scene.objects.len()), (Vec3::new(0.5, 1.0, 1.5), 1));
    assert_eq!((asked.scene.name.as_str(), asked.scene.facts().receivers), ("other", 8));
    assert_eq!(asked.file, folder.path("z/other.toml"));
    let ground = imported(&folder, &["box.obj"], "g", |r| r.receivers = Wanted::Ground).unwrap().scene;
    assert_eq!(ground.facts().receivers, 128 * 128);
    assert_eq!(imported(&folder, &["box.obj", "cube.ply"], "two", |_| {}).unwrap().scene.objects.len(), 3);
}

#[test]
fn buffers_and_pictures_beside_a_model_come_along() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("in/parts")).unwrap();
    let numbers = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat();
    folder.write("in/parts/a b.bin", numbers);
    let gltf = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36,"uri":"{uri}"}}],"scenes":[{{"nodes":[0]}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"nodes":[{{"mesh":0}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[1,1,0]}}],
            "images":[{{"uri":"absent.png"}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]}}"#
        )
    };
    folder.write("in/model.gltf", gltf("parts/a%20b.bin"));
    let made = well(&folder, &["in/model.gltf"], "out");
    assert!(folder.path("out/parts/a b.bin").is_file());
    assert_eq!(Scene::load(&made.file).unwrap().content, made.scene.content);
    folder.write("in/parts/model.gltf", gltf("../parts/a%20b.bin"));
    let error = imported(&folder, &["in/parts/model.gltf"], "led", |_| {}).unwrap_err();
    assert!(error.contains("inside the scene's folder") && !folder.path("led").exists(), "{error}");
}

#[test]
fn errors_name_file_and_expectation_and_leave_nothing() {
    let folder = Folder::new();
    folder.write("nan.ply", cube_ply().replace("-1 -1 -1", "-1 nan -1"));
    folder.write("empty.obj", "# nothing\n");
    folder.write("notes.txt", "x");
    folder.write("sky.exr", exr(4, 2));
    folder.write("other.exr", exr(4, 2));
    folder.write("model.glb", model());
    let before = names(&folder.path("."));
    let fails = |files: &[&str], change: fn(&mut Import), parts: &[&str]| {
        let error = imported(&folder, files, "out", change).unwrap_err();
        for part in parts {
            assert!(error.contains(part) && !error.contains('\n'), "{part}: {error}");
        }
        assert_eq!(names(&folder.path(".")), before, "{error}");
    };
    fails(&["nan.ply"], |_| {}, &["nan.ply", "vertex 0", "finite"]);
    fails(&["empty.obj"], |_| {}, &["empty.obj", "at least one triangle"]);
    fails(&["absent.obj"], |_| {}, &["absent.obj", "readable"]);
    fails(&["notes.txt"], |_| {}, &["notes.txt", "gltf", "hdr"]);
    fails(&["sky.exr"], |_| {}, &["sky.exr", "at least one of"]);
    fails(&["cube.ply", "sky.exr", "other.exr"], |_| {}, &["other.exr", "at most one"]);
    fails(&["model.glb"], |r| r.up = Some(Up::Z), &["model.glb", "--up", "y up by their format"]);
    fails(&["model.glb"], |r| r.clip = Some("fly".into()), &["--clip", "wave", "fly"]);
    fails(&["cube.ply"], |r| r.name = Some("../x".into()), &["--name", "without slashes"]);
    fails(&["cube.ply"], |r| (r.receivers, r.ground) = (Wanted::Ground, false), &["--receivers", "no ground"]);
    fails(&["cube.ply"], |r| r.size = Some([1 << 20, 2]), &["out/cube.toml", "camera.width"]);
    fails(&["cube.ply"], |r| r.unit = Some(f32::NAN), &["--unit"]);
    well(&folder, &["cube.ply"], "out");
    let error = imported(&folder, &["cube.ply"], "out", |_| {}).unwrap_err();
    assert!(error.contains("out") && error.contains("--force"), "{error}");
    let request = Import::new(vec![folder.path("cube.ply")]);
    import(&request, Some(&folder.path("out")), true).unwrap();
}

fn names(folder: &Path) -> Vec<PathBuf> {
    let mut names: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    names
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn boxes_of_any_size_are_in_view_and_come_back_the_same(
        size in -3.0f32..3.0,
        shape in prop::array::uniform3(-1.0f32..0.0),
        offset in prop::array::uniform3(-3.0f32..3.0),
        picture in (16usize..80, 16usize..80),
    ) {
        let folder = Folder::new();
        let size = 10f32.powf(size);
        let sides = Vec3::from(shape.map(|exponent| size * 10f32.powf(exponent)));
        folder.write("box.obj", box_obj(Vec3::from(offset) * size, sides));
        let made = imported(&folder, &["box.obj"], "out", |r| r.size = Some([picture.0, picture.1])).unwrap();
        let share = seen(&made.scene, 0);
        prop_assert!(share[0] > 0.0 && share[0] < 0.9, "{:?}", share);
        prop_assert_eq!(again(&folder, &made.scene, "again").content, made.scene.content);
    }
}
