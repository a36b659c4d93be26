//! Pictures of radiance from disk.

use std::f32::consts::PI;

use glam::Vec3;
use halflight_scenes::{Environment, Light, Rgb, Scene, SceneError};

use crate::folder::Folder;

pub(crate) const WIDTH: usize = 8;
pub(crate) const HEIGHT: usize = 4;

/// A radiance that tells its texel; powers of two, so that half floats and RGBE hold it exactly.
fn value(x: usize, y: usize) -> Rgb {
    Rgb::new(x as f32 + 1.0, (1 << y) as f32, 0.25)
}

pub(crate) fn write_exr(folder: &Folder, name: &str, value: impl Fn(usize, usize) -> Rgb + Sync) {
    let pixel = |x: usize, y: usize| {
        let Rgb { x, y, z } = value(x, y);
        (x, y, z)
    };
    exr::prelude::write_rgb_file(folder.path(name), WIDTH, HEIGHT, pixel).unwrap();
}

pub(crate) fn write_hdr(folder: &Folder, name: &str) {
    let pixels: Vec<_> = (0..WIDTH * HEIGHT).map(|i| image::Rgb(value(i % WIDTH, i / WIDTH).to_array())).collect();
    let file = std::fs::File::create(folder.path(name)).unwrap();
    image::codecs::hdr::HdrEncoder::new(file).encode(&pixels, WIDTH, HEIGHT).unwrap();
}

fn load(folder: &Folder, light: &str) -> Result<Scene, SceneError> {
    folder.load_with(&[("sky = { uniform = [1.0, 1.0, 1.0] }", &format!("environment = {{ {light} }}"))])
}

fn environment(scene: &Scene) -> &Environment {
    match &scene.lights[0].rest {
        Light::Environment(environment) => environment,
        other => panic!("{other:?}"),
    }
}

#[test]
fn pictures_keep_their_texels_and_their_orientation() {
    let folder = Folder::new();
    write_exr(&folder, "map.exr", value);
    write_hdr(&folder, "map.hdr");
    for file in ["map.exr", "map.hdr"] {
        let scene = load(&folder, &format!("file = {file:?}")).unwrap();
        let map = environment(&scene);
        assert_eq!((map.width, map.height), (WIDTH, HEIGHT));
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                // Row 0 at +z, column 0 from +x, columns clockwise seen from above: a photograph is not mirrored.
                let polar = (y as f32 + 0.5) / HEIGHT as f32 * PI;
                let azimuth = -(x as f32 + 0.5) / WIDTH as f32 * 2.0 * PI;
                let direction = Vec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
                assert_eq!(scene.lights[0].rest.radiance(direction), value(x, y), "{file} {x} {y}");
            }
        }
    }
}

#[test]
fn scale_and_rotation_apply() {
    let folder = Folder::new();
    write_exr(&folder, "map.exr", value);
    let scene = load(&folder, r#"file = "map.exr", scale = 0.5, rotate = 90.0"#).unwrap();
    let plain = load(&folder, r#"file = "map.exr""#).unwrap();
    assert_ne!(plain.content, load(&folder, r#"file = "map.exr", scale = 0.5"#).unwrap().content);
    assert_ne!(plain.content, load(&folder, r#"file = "map.exr", rotate = 90.0"#).unwrap().content);
    // Column 0 began at +x; a quarter turn towards +y puts its centre to 67.5°.
    let azimuth = 67.5f32.to_radians();
    let direction = Vec3::new(azimuth.cos(), azimuth.sin(), 2.0).normalize();
    assert_eq!(scene.lights[0].rest.radiance(direction), value(0, 0) * 0.5);
    assert_eq!(scene.frame(0).radiance(-Vec3::Z).y, value(0, HEIGHT - 1).y * 0.5);
}

#[test]
fn texels_that_are_no_numbers_are_refused() {
    let folder = Folder::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 2e9] {
        write_exr(&folder, "bad.exr", |x, y| if (x, y) == (3, 2) { Rgb::new(1.0, bad, 1.0) } else { Rgb::ONE });
        let error = load(&folder, r#"file = "bad.exr""#).unwrap_err().to_string();
        assert!(error.contains("bad.exr: texel (3, 2): expected finite radiance of at most 1e9"), "{error}");
    }
}

#[test]
fn negative_texels_are_raised_and_told() {
    let folder = Folder::new();
    write_exr(&folder, "ringing.exr", |x, y| if y == 0 { Rgb::new(x as f32, -0.25, 2.0) } else { Rgb::ONE });
    let scene = load(&folder, r#"file = "ringing.exr""#).unwrap();
    let map = environment(&scene);
    // Columns are mirrored.
    assert_eq!(map.texels[WIDTH - 1], Rgb::new(0.0, 0.0, 2.0));
    assert_eq!(map.texels[WIDTH - 3], Rgb::new(2.0, 0.0, 2.0));
    assert!(map.texels[WIDTH..].iter().all(|texel| *texel == Rgb::ONE));
    let [notice] = &scene.notices[..] else { panic!("{:?}", scene.notices) };
    assert!(
        notice.ends_with("ringing.exr: 8 of 32 texels had negative radiance, down to -0.25: raised to 0"),
        "{notice}"
    );
    write_exr(&folder, "plain.exr", value);
    assert!(load(&folder, r#"file = "plain.exr""#).unwrap().notices.is_empty());
}

#[test]
fn primaries_become_those_of_rec_709() {
    use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};
    let folder = Folder::new();
    let write = |name: &str, blue: (f32, f32)| {
        let channels =
            SpecificChannels::rgb(|at: Vec2<usize>| if at.x() == 0 { (1f32, 1f32, 1f32) } else { (0.0, 2.0, 0.0) });
        let mut image = Image::from_channels((WIDTH, HEIGHT), channels);
        let xy = |x, y| Vec2(x, y);
        image.attributes.chromaticities = Some(exr::meta::attribute::Chromaticities {
            red: xy(0.713, 0.293),
            green: xy(0.165, 0.83),
            blue: Vec2(blue.0, blue.1),
            white: xy(0.32168, 0.33767),
        });
        image.write().to_file(folder.path(name)).unwrap();
    };
    write("acescg.exr", (0.128, 0.044));
    let scene = load(&folder, r#"file = "acescg.exr""#).unwrap();
    let map = environment(&scene);
    assert!(map.texels[WIDTH - 1].distance(Rgb::ONE) < 1e-5, "white stays white");
    // Twice the second column of the Academy's matrix from AP1 to Rec. 709, but for negative numbers.
    assert!(map.texels[0].distance(Rgb::new(0.0, 2.2816, 0.0)) < 1e-4, "{}", map.texels[0]);
    assert!(scene.notices[0].contains("28 of 32 texels had negative radiance"), "{:?}", scene.notices);
    write("broken.exr", (0.713, 0.293));
    let error = load(&folder, r#"file = "broken.exr""#).unwrap_err().to_string();
    assert!(error.contains("broken.exr: chromaticities: expected CIE xy"), "{error}");
}

#[test]
fn photographs_are_srgb() {
    let folder = Folder::new();
    let picture = image::RgbaImage::from_fn(4, 2, |x, _| image::Rgba([0, 188, 255, (x * 80) as u8]));
    picture.save(folder.path("map.png")).unwrap();
    let scene = load(&folder, r#"file = "map.png""#).unwrap();
    // What alpha covers has its colour.
    for texel in environment(&scene).texels.iter() {
        assert!(texel.distance(Rgb::new(0.0, 0.5029, 1.0)) < 1e-4, "{texel}");
    }
}

#[test]
fn other_channels_and_files_are_refused() {
    let folder = Folder::new();
    let luminance = exr::prelude::SpecificChannels::build().with_channel::<f32>("Y").with_pixel_fn(|_| (1.0f32,));
    use exr::prelude::WritableImage;
    exr::prelude::Image::from_channels((WIDTH, HEIGHT), luminance).write().to_file(folder.path("grey.exr")).unwrap();
    let error = load(&folder, r#"file = "grey.exr""#).unwrap_err().to_string();
    assert!(error.contains("grey.exr: OpenEXR: expected a whole file with channels R, G, B"), "{error}");
    for (file, expected) in [("map.png", "expected a PNG or JPEG"), ("map.hdr", "expected a whole file")] {
        folder.write(file, "");
        let error = load(&folder, &format!("file = {file:?}")).unwrap_err().to_string();
        assert!(error.contains(file) && error.contains(expected), "{error}");
    }
}

#[test]
fn lights_turn_with_the_frames() {
    let folder = Folder::new();
    write_exr(&folder, "map.exr", value);
    let frames = ("purpose", "frames = { count = 5, fps = 2.0 }\npurpose");
    let (sky, key) = ("sky = { uniform = [1.0, 1.0, 1.0] }", "angular_radius = 5.0, radiance = [10.0, 9.0, 8.0] }");
    let map = "environment = { file = \"map.exr\" }\nturn = { degrees_a_second = 45.0 }";
    let turning_key = format!("{key}\nturn = {{ axis = [0.0, 1.0, 0.0], degrees_a_second = -30.0 }}");
    let scene = folder.load_with(&[frames, (sky, map), (key, &turning_key)]).unwrap();
    assert_eq!(scene.facts().turning, 2);
    // Half a second a frame: after four a quarter turn, and the key light, at 45° in the xz plane, has gone down to -15°.
    let (first, last) = (scene.frame(0), scene.frame(4));
    let [mapped, lit] = [&last.lights[0].light, &last.lights[1].light];
    let (before, after) = (Vec3::new(1.0, -0.2, 0.3).normalize(), Vec3::new(0.2, 1.0, 0.3).normalize());
    assert_eq!(first.lights[0].light.radiance(before), mapped.radiance(after));
    assert_ne!(mapped.radiance(before), mapped.radiance(after));
    let Light::Key(lit) = lit else { panic!("a key light") };
    let expected = Vec3::new(-(15f32.to_radians().sin()), 0.0, 15f32.to_radians().cos());
    assert!(lit.direction.distance(expected) < 1e-6, "{}", lit.direction);
    let revisions = |frame: usize| scene.frame(frame).lights.iter().map(|posed| posed.revision).collect::<Vec<_>>();
    assert!(revisions(0)[0] != revisions(1)[0] && revisions(0)[1] != revisions(1)[1]);
    assert_eq!(revisions(2), revisions(2));
    for (light, to, expected) in [
        (sky, format!("{sky}\nturn = {{ degrees_a_second = 1.0 }}"), "lights[0].turn: expected beside an environment"),
        (
            sky,
            format!("{map}\n").replace("{ d", "{ axis = [0.1, 0.0, 1.0], d"),
            "lights[0].turn.axis: expected a vertical",
        ),
        (key, format!("{key}\nturn = {{ degrees_a_second = inf }}"), "lights[1].turn.degrees_a_second"),
        (key, format!("{key}\nturn = {{ axis = [0.0, 0.0, 0.0], degrees_a_second = 1.0 }}"), "lights[1].turn.axis"),
    ] {
        let error = folder.load_with(&[(light, &to)]).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
