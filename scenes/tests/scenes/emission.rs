//! Pictures on what emits.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec3;
use halflight_scenes::{Emission, Object, Rgb, Shape};

use crate::folder::Folder;
use crate::lights::{HEIGHT, WIDTH, write_exr};

const PANEL: &str = r#"purpose = "a panel"
[receivers]
grid = { center = [0.0, 0.0, 0.0], size = [1.0, 1.0], resolution = [1, 1] }
[[objects]]
name = "panel"
plane = { size = [8.0, 4.0] }
albedo = [0.5, 0.5, 0.5]
emission = [2.0, 1.0, 0.5]
emission_map = { file = "panel.exr" }
"#;

fn value(x: usize, y: usize) -> Rgb {
    if x == 3 { Rgb::ZERO } else { Rgb::new(x as f32 + 1.0, y as f32 + 1.0, 4.0) }
}

/// The middle of each triangle and its radiance.
fn shining(object: &Object) -> Vec<(Vec3, Rgb)> {
    let Shape::Mesh(mesh) = &*object.shape else { panic!("a mesh") };
    let middle = |triangle: usize| mesh.corners(triangle).iter().sum::<Vec3>() / 3.0;
    (0..mesh.triangles.len()).map(|triangle| (middle(triangle), object.emission.of(triangle))).collect()
}

#[test]
fn a_plane_shows_its_picture_upright_from_the_front() {
    let folder = Folder::new();
    write_exr(&folder, "panel.exr", value);
    let scene = folder.load(PANEL).unwrap();
    let shining = shining(&scene.objects[0]);
    assert_eq!(shining.len(), 2 * WIDTH * HEIGHT);
    for (at, radiance) in shining {
        let (x, y) = ((at.x + 4.0) as usize, (2.0 - at.y) as usize);
        assert_eq!(radiance, value(x, y) * Rgb::new(2.0, 1.0, 0.5), "{at}");
    }
    assert_eq!(scene.facts().emitters, 1);
    let brighter = folder.load(&PANEL.replace("[2.0,", "[2.5,")).unwrap();
    assert_ne!(scene.content, brighter.content);
    assert_ne!(scene.frame(0).objects[0].revision, brighter.frame(0).objects[0].revision);
}

#[test]
fn pngs_are_made_linear_and_meshes_emit_the_mean_over_each_triangle() {
    let folder = Folder::new();
    let grey = image::RgbImage::from_pixel(4, 4, image::Rgb([188, 188, 0]));
    grey.save(folder.path("panel.png")).unwrap();
    folder.write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    let on_mesh = PANEL.replace("plane = { size = [8.0, 4.0] }", r#"mesh = { file = "quad.obj" }"#);
    for text in [PANEL, &on_mesh] {
        let scene = folder.load(&text.replace("panel.exr", "panel.png")).unwrap();
        for (_, radiance) in shining(&scene.objects[0]) {
            // 188 of 255 in sRGB is 0.5029 of the light.
            assert!((radiance - Rgb::new(1.0058, 0.5029, 0.0)).length() < 1e-3, "{radiance}");
        }
    }
}

#[test]
fn gltf_materials_emit_through_their_pictures() {
    let mut png = std::io::Cursor::new(Vec::new());
    // The left half is bright, the right one dark; the triangle lies in the left.
    let halves = image::RgbImage::from_fn(16, 16, |x, _| image::Rgb(if x < 8 { [255, 255, 255] } else { [0; 3] }));
    halves.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let floats = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.1, 0.1, 0.4, 0.1, 0.1, 0.9];
    let bytes: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).collect();
    let (bytes, png) = (STANDARD.encode(bytes), STANDARD.encode(png.into_inner()));
    let model = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],
        "materials":[{{"emissiveFactor":[1.0,0.5,0.0],"emissiveTexture":{{"index":0}}}}],
        "textures":[{{"source":0}}],"images":[{{"uri":"data:image/png;base64,{png}"}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
        {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}}],
        "buffers":[{{"byteLength":60,"uri":"data:application/octet-stream;base64,{bytes}"}}]}}"#
    );
    let folder = Folder::new();
    folder.write("lamp.gltf", &model);
    let entry = "gltf = { file = \"lamp.gltf\" }";
    let text = PANEL.replace("plane = { size = [8.0, 4.0] }\nalbedo = [0.5, 0.5, 0.5]\n", &format!("{entry}\n"));
    let text = text.replace("emission = [2.0, 1.0, 0.5]\nemission_map = { file = \"panel.exr\" }\n", "");
    let scene = folder.load(&text).unwrap();
    assert_eq!(scene.objects[0].emission, Emission::Triangles(vec![Rgb::new(1.0, 0.5, 0.0)].into()));
    folder.write("lamp.gltf", model.replace("0.5,0.0]", "0.0,0.0]").replace("[1.0,", "[0.0,"));
    assert!(folder.load(&text).unwrap_err().to_string().contains("lights"), "what is black is no light");
}

#[test]
fn errors_name_file_and_field() {
    let folder = Folder::new();
    write_exr(&folder, "panel.exr", value);
    image::RgbImage::new(512, 256).save(folder.path("large.png")).unwrap();
    for (from, to, expected) in [
        ("emission = [2.0, 1.0, 0.5]\n", "", "objects[0].emission: expected what the picture is multiplied by"),
        ("panel.exr", "none.exr", "none.exr"),
        ("panel.exr", "large.png", "emission_map: expected at most 65536 texels on a plane, found 131072"),
        ("[2.0,", "[1e9,", "objects[0].emission: expected"),
        ("plane = { size = [8.0, 4.0] }", "ball = { radius = 1.0 }", "emission_map: expected a plane, or a mesh"),
        ("plane = { size = [8.0, 4.0] }", "gltf = { file = \"x.glb\" }", "emission_map: expected beside a plane"),
    ] {
        let error = folder.load(&PANEL.replace(from, to)).unwrap_err().to_string();
        assert!(error.contains(expected) && !error.contains('\n'), "{error}");
    }
}
