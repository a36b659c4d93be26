//! Headers that declare gigantic sizes: refused at once, whatever memory they ask for.

use std::path::{Path, PathBuf};

use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};

use crate::child::{Verdict, load};

/// Most MiB that the process may grow by for all files of a test, where a header asks for hundreds and more.
const MOST_GROWTH: u64 = 64;

fn scene(folder: &Path, object: &str, light: &str) {
    let text = format!(
        "purpose = \"One file\"\n[receivers.grid]\ncenter = [0.0, 0.0, 0.0]\nsize = [1.0, 1.0]\nresolution = [2, 2]\n\
         [[objects]]\nname = \"it\"\n{object}\nalbedo = [0.5, 0.5, 0.5]\n[[lights]]\n{light}\n"
    );
    std::fs::write(folder.join("scene.toml"), text).unwrap();
}

/// A file's name and bytes, and whether a picture is one of heights.
type Case = (&'static str, Vec<u8>, bool);

/// What is said of files, each as an environment, a height map or a model by its extension; nothing of those that load.
fn told(cases: &[Case]) -> Vec<Option<String>> {
    let sky = "sky = { uniform = [1.0, 1.0, 1.0] }";
    let folders = cases.iter().map(|(file, bytes, as_heights)| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(file), bytes).unwrap();
        let heights = |more: &str| format!("heights = {{ file = {file:?}, cell = [1.0, 1.0]{more} }}");
        let (object, light) = match file.rsplit_once('.').unwrap().1 {
            "ply" | "off" => (format!("mesh = {{ file = {file:?} }}"), sky.to_owned()),
            "glb" | "gltf" => (format!("gltf = {{ file = {file:?} }}"), sky.to_owned()),
            "bvh" => (format!("character = {{ file = {file:?}, resolution = 8 }}"), sky.to_owned()),
            "exr" if *as_heights => (heights(""), sky.to_owned()),
            "png" if *as_heights => (heights(", range = [0.0, 1.0]"), sky.to_owned()),
            _ => ("plane = { size = [1.0, 1.0] }".into(), format!("environment = {{ file = {file:?} }}")),
        };
        scene(folder.path(), &object, &light);
        folder
    });
    let folders: Vec<tempfile::TempDir> = folders.collect();
    let scenes: Vec<PathBuf> = folders.iter().map(|folder| folder.path().join("scene.toml")).collect();
    let verdicts = load(&scenes).into_iter().zip(cases);
    let error = |(verdict, (file, ..)): (Verdict, &Case)| {
        assert!(verdict.error.iter().all(|error| error.contains(file) && !error.contains("\\n")), "{verdict:?}");
        assert!(verdict.grown <= MOST_GROWTH, "{file}: {verdict:?}");
        verdict.error
    };
    verdicts.map(error).collect()
}

fn all_refused(cases: &[Case]) -> Vec<String> {
    let errors = told(cases).into_iter().zip(cases);
    errors
        .map(|(error, (file, bytes, _))| error.unwrap_or_else(|| panic!("{file} of {} bytes loads", bytes.len())))
        .collect()
}

/// A small EXR whose windows and tiles say otherwise.
fn exr(width: i32, height: i32, tile: Option<u32>) -> Vec<u8> {
    let channels = SpecificChannels::rgb(|_: Vec2<usize>| (1f32, 1f32, 1f32));
    let mut image = Image::from_channels((8, 4), channels);
    if tile.is_some() {
        image.layer_data.encoding.blocks = exr::image::Blocks::Tiles(Vec2(8, 4));
    }
    let mut bytes = Vec::new();
    image.write().to_buffered(std::io::Cursor::new(&mut bytes)).unwrap();
    let mut replace = |name: &[u8], skip: usize, from: &[u8], to: &[u8]| {
        let at = bytes.windows(name.len()).position(|found| found == name).expect("the attribute") + name.len() + skip;
        assert_eq!(&bytes[at..at + from.len()], from);
        bytes[at..at + to.len()].copy_from_slice(to);
    };
    let corner = |x: i32, y: i32| [x.to_le_bytes(), y.to_le_bytes()].concat();
    // Type, size and the first corner of the box lie before its second.
    replace(b"dataWindow\0box2i\0", 4 + 8, &corner(7, 3), &corner(width - 1, height - 1));
    replace(b"displayWindow\0box2i\0", 4 + 8, &corner(7, 3), &corner(width - 1, height - 1));
    if let Some(side) = tile {
        let sides = [side.to_le_bytes(), side.to_le_bytes()].concat();
        replace(b"tiles\0tiledesc\0", 4, &corner(8, 4), &sides);
    }
    bytes
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    image::GrayImage::new(8, 4).write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let sum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    bytes
}

/// ISO 3309, as PNG has it.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 })
    })
}

#[test]
fn pictures() {
    let sizes = [(16_384, 16_384), (1 << 25, 2), (2_000_000_000, 2_000_000_000)];
    let mut cases = Vec::new();
    for (width, height) in sizes {
        for as_heights in [false, true] {
            cases.push(("a.exr", exr(width, height, None), as_heights));
            cases.push(("a.exr", exr(width, height, Some(8)), as_heights));
            cases.push(("a.png", png(width as u32, height as u32), as_heights));
        }
        let hdr = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\nabc");
        cases.push(("a.hdr", hdr.into_bytes(), false));
    }
    let errors = all_refused(&cases);
    assert!(errors[..7].iter().all(|error| error.contains("expected a picture of 1 to 33554432 texels")), "{errors:?}");
}

/// Tiles larger than their picture are cut off at its border.
#[test]
fn pictures_that_may_load() {
    let whole = [("a.exr", exr(8, 4, None), false), ("a.png", png(8, 4), true), ("a.exr", exr(8, 4, Some(8)), true)];
    assert_eq!(told(&whole), [None, None, None]);
    told(&[1 << 14, 1 << 20, u32::MAX >> 1].map(|side| ("a.exr", exr(8, 4, Some(side)), false)));
}

#[test]
fn models() {
    let ply = |vertices: &str, kind: &str| {
        format!(
            "ply\nformat {kind} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
             element face 4294967295\nproperty list uint int vertex_indices\nend_header\n0 0 0"
        )
    };
    let mut cases: Vec<Case> = Vec::new();
    for vertices in ["4294967295", "99999999999999999999"] {
        for kind in ["ascii", "binary_little_endian"] {
            cases.push(("a.ply", ply(vertices, kind).into_bytes(), false));
        }
    }
    let list = ply("0", "binary_little_endian").replace("end_header\n0 0 0", "end_header\n\u{7f}\u{7f}\u{7f}\u{7f}");
    cases.push(("a.ply", list.into_bytes(), false));
    cases.push(("a.off", b"OFF\n4294967295 4294967295 0\n0 0 0\n".to_vec(), false));
    cases.push((
        "a.bvh",
        b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\nFrames: 1048576\nFrame Time: 1\n0\n"
            .to_vec(),
        false,
    ));
    let chunk =
        |length: u32| [&b"glTF\x02\0\0\0"[..], &length.to_le_bytes(), &length.to_le_bytes(), b"JSON{}"].concat();
    cases.push(("a.glb", chunk(u32::MAX), false));
    cases.push(("a.glb", chunk(1 << 30), false));
    let accessor = |count: u64, view: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{{view}"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}],
            "bufferViews":[{{"buffer":0,"byteLength":{count}}}],"buffers":[{{"uri":"data:;base64,AAAA","byteLength":{count}}}]}}"#
        )
    };
    for count in [1 << 26, 1 << 40, u64::MAX >> 1] {
        cases.push(("a.gltf", accessor(count, "\"bufferView\":0,").into_bytes(), false));
    }
    all_refused(&cases);
}
