//! EXR written by us and read by OpenImageIO, and the other way round, bit for bit.

use std::path::{Path, PathBuf};

use ::exr::prelude::f16;
use glam::Vec3;
use halflight_oiio::{File, Numbers};
use halflight_results::{Layout, Picture};

use crate::tools::{colours, copies, run};

const WIDTH: usize = 512;
const HEIGHT: usize = 128;

/// Zeros, denormals, extremes, infinities and NaN with and without sign and payload, then all that a generator gives.
fn floats() -> Picture {
    let special = [
        0.0,
        -0.0,
        f32::from_bits(1),
        -f32::from_bits(0x007f_ffff),
        f32::MIN_POSITIVE,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        f32::from_bits(0xffc1_2345),
        f32::from_bits(0x7f80_0001),
        1.0,
        65504.0,
        65520.0,
    ];
    let mut state = 1_u64;
    let mut any = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f32::from_bits((state >> 32) as u32)
    };
    let mut values = special.to_vec();
    values.resize_with(3 * WIDTH * HEIGHT, &mut any);
    picture(&values)
}

/// Every half there is, in each channel another order.
fn halves() -> Picture {
    let half = |bits: usize| f16::from_bits(bits as u16).to_f32();
    let values: Vec<f32> =
        (0..WIDTH * HEIGHT).flat_map(|i| [half(i), half(i.wrapping_mul(40_503)), half(0xffff - i)]).collect();
    picture(&values)
}

fn picture(values: &[f32]) -> Picture {
    let radiance: Vec<Vec3> = values.chunks_exact(3).map(Vec3::from_slice).collect();
    let valid = (0..radiance.len()).map(|i| i % 3 != 0).collect();
    Picture { layout: Layout::Image { width: WIDTH, height: HEIGHT }, radiance, valid }
}

fn written(picture: &Picture, folder: &Path) -> PathBuf {
    let path = folder.join("ours.exr");
    std::fs::write(&path, picture.to_exr().unwrap()).unwrap();
    path
}

/// How many values differ by a bit.
fn different(picture: &Picture, values: impl IntoIterator<Item = f32>) -> usize {
    let values: Vec<f32> = values.into_iter().collect();
    assert_eq!(values.len(), 3 * picture.radiance.len());
    let ours = picture.radiance.iter().flat_map(|v| v.to_array());
    ours.zip(values).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
}

/// The same where signalling NaN may become quiet, as processors make it when they widen a half.
fn different_but_for_nan(picture: &Picture, values: impl IntoIterator<Item = f32>) -> usize {
    let ours = picture.radiance.iter().flat_map(|v| v.to_array());
    ours.zip(values).filter(|(a, b)| a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan())).count()
}

#[test]
fn ours_is_read_by_openimageio() {
    let folder = tempfile::tempdir().unwrap();
    for picture in [floats(), halves()] {
        let path = written(&picture, folder.path());
        assert_eq!(different(&picture, colours(&path)), 0);
        let mut file = File::open(&path, WIDTH * HEIGHT).unwrap();
        assert_eq!((file.width, file.height, file.numbers), (WIDTH, HEIGHT, Numbers::Floating));
        let valid = file.channels.iter().position(|name| name == "valid").expect("the mask");
        let mask = file.read(valid..valid + 1).unwrap();
        assert!(mask.iter().zip(&picture.valid).all(|(read, valid)| *read == f32::from(u8::from(*valid))));
    }
}

#[test]
fn openimageios_is_read_by_us() {
    let folder = tempfile::tempdir().unwrap();
    for (picture, kind, compressions) in [
        (floats(), "float", &["none", "rle", "zip", "zips", "piz"][..]),
        (halves(), "half", &["none", "rle", "zip", "zips", "piz", "pxr24"][..]),
    ] {
        let tiles = [("lines", vec!["--scanline"]), ("tiles", vec!["--tile", "64", "32"])];
        let ways: Vec<(Vec<&str>, String)> = compressions
            .iter()
            .flat_map(|compression| tiles.iter().map(move |(name, tiles)| (compression, name, tiles)))
            .map(|(compression, name, tiles)| {
                let options = [&tiles[..], &["-d", kind, "--compression", compression]].concat();
                (options, format!("{kind}-{compression}-{name}.exr"))
            })
            .collect();
        let wanted: Vec<(Vec<&str>, &str)> = ways.iter().map(|(options, name)| (options.clone(), &name[..])).collect();
        let Some(theirs) = copies(&written(&picture, folder.path()), &wanted) else { return };
        for path in theirs {
            let read = Picture::load(&path).unwrap();
            let values = read.radiance.iter().flat_map(|v| v.to_array());
            match kind {
                "float" => assert_eq!(different(&picture, values), 0, "{}", path.display()),
                _ => assert_eq!(different_but_for_nan(&picture, values), 0, "{}", path.display()),
            }
            assert!(read.layout == picture.layout && read.valid == picture.valid, "{}", path.display());
        }
    }
}

#[test]
fn mipmapped_textures_give_their_finest_level() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&picture(&vec![0.25; 3 * WIDTH * HEIGHT]), folder.path());
    let mut expected = picture(&(0..3 * WIDTH * HEIGHT).map(|i| (i as f32).sin().abs()).collect::<Vec<_>>());
    expected.valid.fill(true);
    std::fs::write(&path, expected.to_exr().unwrap()).unwrap();
    for name in ["mipmapped.tx", "mipmapped.exr"] {
        let to = folder.path().join(name);
        let Some(output) = run("maketx", &["-d", "float", path.to_str().unwrap(), "-o", to.to_str().unwrap()]) else {
            return;
        };
        assert!(output.status.success(), "{output:?}");
        let info = run("oiiotool", &["--info", "-v", to.to_str().unwrap()]).expect("as maketx");
        assert!(String::from_utf8_lossy(&info.stdout).contains("MIP-map levels: 512x128 256x64"), "{info:?}");
        assert_eq!(different(&expected, colours(&to)), 0, "{name}");
        if name.ends_with(".exr") {
            let read = Picture::load(&to).unwrap();
            assert_eq!(different(&expected, read.radiance.iter().flat_map(|v| v.to_array())), 0, "by us");
        }
    }
}
