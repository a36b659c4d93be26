//! Pictures that OpenImageIO reads, or one line that says that it is not built in.

use halflight_scenes::{Environment, Light, Object, Rgb, Scene, SceneError, Shape, open_image_io};

use crate::folder::Folder;

const WIDTH: usize = 4;
const HEIGHT: usize = 2;

/// A portable float map, which runs from its bottom row up; `PF` has colours, `Pf` one value a texel.
fn pfm(kind: &str, rows: &[Vec<f32>]) -> Vec<u8> {
    let channels = if kind == "PF" { 3 } else { 1 };
    let mut bytes = format!("{kind}\n{} {}\n-1.0\n", rows[0].len() / channels, rows.len()).into_bytes();
    bytes.extend(rows.iter().rev().flatten().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// A Targa file of 2 × 1 texels in blue, green, red.
const TARGA: [u8; 24] = [0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 24, 0, 0, 188, 255, 255, 0, 0];

/// A triangle whose image is `look.tga`.
const TRIANGLE: &str = r#"{ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
"meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
"materials": [{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }],
"textures": [{ "source": 0 }], "images": [{ "uri": "look.tga" }],
"accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
{ "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2" }],
"bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 24 }],
"buffers": [{ "uri": "triangle.bin", "byteLength": 60 }] }"#;

fn folder() -> Folder {
    let folder = Folder::new();
    let triangle = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    folder.write("triangle.bin", triangle.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>());
    folder.write("triangle.gltf", TRIANGLE);
    folder.write("look.tga", TARGA);
    folder
}

fn lit_by(folder: &Folder, file: &str) -> Result<Scene, SceneError> {
    folder.load_with(&[("sky = { uniform = [1.0, 1.0, 1.0] }", &format!("environment = {{ file = {file:?} }}"))])
}

fn on_heights(folder: &Folder, file: &str, range: &str) -> Result<Scene, SceneError> {
    folder.load_with(&[(
        "plane = { size = [20.0, 20.0] }",
        &format!("heights = {{ file = {file:?}, cell = [1.0, 1.0]{range} }}"),
    )])
}

fn textured(folder: &Folder) -> Result<Scene, SceneError> {
    let model = r#"gltf = { file = "triangle.gltf" }"#;
    folder.load_with(&[(r#"mesh = { file = "cube.ply" }"#, model), ("albedo = [0.9, 0.2, 0.2]", "")])
}

fn environment(scene: &Scene) -> &Environment {
    match &scene.lights[0].rest {
        Light::Environment(environment) => environment,
        other => panic!("{other:?}"),
    }
}

#[test]
fn without_it_the_error_names_the_feature() {
    if open_image_io().is_some() {
        return;
    }
    let folder = folder();
    let complaints = [
        (lit_by(&folder, "look.tga"), "a picture as .exr, .hdr, .png or .jpg"),
        (on_heights(&folder, "look.tga", ""), "a picture of heights as .exr or .png"),
        (textured(&folder), "a picture as PNG or JPEG"),
    ];
    for (found, expected) in complaints {
        let error = found.unwrap_err().to_string();
        let expected =
            format!("look.tga: format: expected {expected} (others need Halflight built with the feature `oiio`)");
        assert!(error.contains(&expected) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn with_it_floats_keep_their_bits() {
    if open_image_io().is_none() {
        return eprintln!("skipped: the feature `oiio` is off");
    }
    let folder = folder();
    let value = |x: usize, y: usize| Rgb::new(x as f32 + 1e-3, (1.0 + y as f32) / 3.0, 1e-41);
    let row = |y| (0..WIDTH).flat_map(|x| value(x, y).to_array()).collect();
    folder.write("map.pfm", pfm("PF", &(0..HEIGHT).map(row).collect::<Vec<_>>()));
    let scene = lit_by(&folder, "map.pfm").unwrap();
    let map = environment(&scene);
    assert_eq!((map.width, map.height), (WIDTH, HEIGHT));
    for (index, texel) in map.texels.iter().enumerate() {
        assert_eq!(*texel, value(WIDTH - 1 - index % WIDTH, index / WIDTH));
    }
    let bad = |value: f32| pfm("PF", &[vec![1.0; 6], vec![1.0, 1.0, 1.0, 1.0, value, 1.0]]);
    folder.write("bad.pfm", bad(f32::NAN));
    let error = lit_by(&folder, "bad.pfm").unwrap_err().to_string();
    assert!(error.contains("bad.pfm: texel (1, 1): expected finite radiance"), "{error}");
    folder.write("ringing.pfm", bad(-0.5));
    let scene = lit_by(&folder, "ringing.pfm").unwrap();
    assert!(scene.notices[0].contains("1 of 4 texels had negative radiance, down to -0.5"), "{:?}", scene.notices);
}

#[test]
fn with_it_heights_are_metres_or_shares() {
    if open_image_io().is_none() {
        return eprintln!("skipped: the feature `oiio` is off");
    }
    let folder = folder();
    let heights = |scene: &Scene| match &*scene.objects[0].shape {
        Shape::Heights(field) => field.heights().to_vec(),
        _ => panic!("a height field"),
    };
    folder.write("land.pfm", pfm("Pf", &[vec![10.0, 11.0], vec![0.0, -1.5]]));
    assert_eq!(heights(&on_heights(&folder, "land.pfm", "").unwrap()), [0.0, -1.5, 10.0, 11.0]);
    let error = on_heights(&folder, "land.pfm", ", range = [0.0, 1.0]").unwrap_err().to_string();
    assert!(error.contains("heights.range: expected the heights of black and white"), "{error}");
    folder.write("land.pgm", b"P5\n2 2\n255\n\xff\x00\x33\x66");
    assert_eq!(heights(&on_heights(&folder, "land.pgm", ", range = [0.0, 5.0]").unwrap()), [1.0, 2.0, 5.0, 0.0]);
    let error = on_heights(&folder, "land.pgm", "").unwrap_err().to_string();
    assert!(error.contains("heights.range: expected the heights of black and white"), "{error}");
    folder.write("hole.pfm", pfm("Pf", &[vec![10.0, 11.0], vec![f32::NAN, -1.5]]));
    let error = on_heights(&folder, "hole.pfm", "").unwrap_err().to_string();
    assert!(error.contains("hole.pfm: texel (0, 1): expected a finite height"), "{error}");
    let error =
        on_heights(&folder, "look.tga", ", range = [0.0, 1.0]").map(|scene| heights(&scene)).unwrap_err().to_string();
    assert!(error.contains("at least 2 x 2 heights"), "{error}");
}

#[test]
fn with_it_textures_and_photographs_are_srgb() {
    if open_image_io().is_none() {
        return eprintln!("skipped: the feature `oiio` is off");
    }
    let folder = folder();
    let expected = Rgb::new(1.0, 0.5029, 0.0);
    let scene = textured(&folder).unwrap();
    let textured = |object: &Object| object.texture.as_ref().unwrap().at(glam::Vec2::new(0.25, 0.5));
    assert!(textured(&scene.objects[1]).distance(expected) < 1e-4);
    let scene = lit_by(&folder, "look.tga").unwrap();
    assert!(environment(&scene).texels[1].distance(expected) < 1e-4);
}

#[test]
fn with_it_broken_pictures_are_one_line() {
    if open_image_io().is_none() {
        return eprintln!("skipped: the feature `oiio` is off");
    }
    let folder = folder();
    let whole = pfm("PF", &[vec![1.0; 6], vec![1.0; 6]]);
    let cases: [(&str, &[u8]); 6] = [
        ("empty.pfm", b""),
        ("cut.pfm", &whole[..whole.len() - 20]),
        ("huge.pfm", b"PF\n70000 70000\n-1.0\nabc"),
        ("empty.tif", b"II*\0"),
        ("a.unknown", b"what?"),
        ("text.dds", b"DDS "),
    ];
    for (file, bytes) in cases {
        folder.write(file, bytes);
        for error in [lit_by(&folder, file).map(drop), on_heights(&folder, file, "").map(drop)] {
            let error = error.expect_err(file).to_string();
            assert!(error.contains(&format!("{file}: ")) && !error.contains('\n'), "{error}");
        }
    }
}
