//! What our decoders and OpenImageIO both read, they read alike: results do not depend on the feature.

use std::path::{Path, PathBuf};

use crate::assets::Asset;
use crate::check::Checker;

fn asset(path: &Path) -> Asset {
    Asset { path: path.to_owned(), bytes: std::fs::read(path).unwrap() }
}

fn agree(path: &Path) {
    let (ours, check) = (asset(path).image(&mut Vec::new()).unwrap(), Checker { file: path });
    let theirs = super::image(check, &mut Vec::new()).unwrap();
    assert_eq!((ours.width, ours.height), (theirs.width, theirs.height), "{}", path.display());
    let differ = ours
        .texels
        .iter()
        .zip(&theirs.texels)
        .position(|(a, b)| a.to_array().map(f32::to_bits) != b.to_array().map(f32::to_bits));
    assert_eq!(differ.map(|at| (at, ours.texels[at], theirs.texels[at])), None, "{}", path.display());
}

fn agree_on_heights(path: &Path) {
    let ours = asset(path).height_map().unwrap();
    let theirs = super::heights(Checker { file: path }).unwrap();
    assert!(ours.heights.len() > 4 && ours == theirs, "{}", path.display());
}

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data")
}

#[test]
fn on_shipped_pictures() {
    for name in ["bl_courtyard.exr", "bl_interior.exr", "bl_studio.exr", "bl_sunset.exr"] {
        agree(&data().join(name));
    }
    agree_on_heights(&data().join("jacksboro_fault.exr"));
}

/// Numbers that look random.
fn noise(index: u32) -> u32 {
    (index ^ 0x9e37_79b9).wrapping_mul(0x85eb_ca6b).rotate_left(13).wrapping_mul(0xc2b2_ae35)
}

#[test]
fn on_radiance_hdr() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hdr");
    // Every exponent that a radiance within bounds may have, run-length coded and plain.
    for width in [64, 5] {
        let value = |i: u32| (noise(i) >> 8) as f32 * f32::exp2(f32::from((noise(i + 1) % 136) as u8) - 130.0);
        let pixels: Vec<_> =
            (0..width * 40).map(|i| image::Rgb([value(3 * i), value(3 * i + 1), value(3 * i + 2)])).collect();
        let file = std::fs::File::create(&path).unwrap();
        image::codecs::hdr::HdrEncoder::new(file).encode(&pixels, width as usize, 40).unwrap();
        agree(&path);
    }
}

#[test]
fn on_png() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let (bytes, words) = (|i: u32| (noise(i) >> 24) as u8, |i: u32| (noise(i) >> 16) as u16);
    let of = |x: u32, y: u32| 4 * (16 * y + x);
    image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([0, 1, 2].map(|c| bytes(of(x, y) + c)))).save(&path).unwrap();
    agree(&path);
    image::RgbaImage::from_fn(16, 16, |x, y| image::Rgba([0, 1, 2, 3].map(|c| bytes(of(x, y) + c))))
        .save(&path)
        .unwrap();
    agree(&path);
    let deep: image::ImageBuffer<image::Rgb<u16>, Vec<u16>> =
        image::ImageBuffer::from_fn(16, 16, |x, y| image::Rgb([0, 1, 2].map(|c| words(of(x, y) + c))));
    deep.save(&path).unwrap();
    agree(&path);
    image::GrayImage::from_fn(16, 16, |x, y| image::Luma([bytes(of(x, y))])).save(&path).unwrap();
    agree(&path);
    agree_on_heights(&path);
    let deep: image::ImageBuffer<image::Luma<u16>, Vec<u16>> =
        image::ImageBuffer::from_fn(16, 16, |x, y| image::Luma([words(of(x, y))]));
    deep.save(&path).unwrap();
    agree(&path);
    agree_on_heights(&path);
}
