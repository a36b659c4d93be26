//! Height fields: generators, pictures of heights, receivers, and what is refused.

use std::collections::HashSet;

use exr::prelude::{SpecificChannels, WritableImage};
use glam::{Vec2, Vec3};
use halflight_scenes::{HeightField, Layout, Revision, Scene, Shape, Which};
use halflight_trace::Ray;

use crate::folder::Folder;

/// A scene of one height field, its vertices the receivers.
fn scene(object: &str) -> String {
    format!(
        "purpose = \"terrain\"\n[receivers]\nheights = {{ object = \"terrain\" }}\n[[lights]]\nsky = {{ overcast = [1, 1, 1] }}\n\
         [[objects]]\nname = \"terrain\"\nalbedo = [0.5, 0.5, 0.5]\n{object}\n"
    )
}

/// The heights of a generator on 9 × 7 vertices of 0.5 m × 1 m.
fn generated(generator: &str) -> String {
    scene(&format!("heights = {{ resolution = [9, 7], cell = [0.5, 1.0], {generator} }}"))
}

fn field(scene: &Scene) -> &HeightField {
    match &*scene.objects[0].shape {
        Shape::Heights(field) => field,
        other => panic!("{other:?}"),
    }
}

fn load(text: &str) -> Scene {
    Folder::new().load(text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn generators_are_their_formulas_about_the_origin() {
    type Formula = fn(f64, f64) -> f64;
    let slope: Formula =
        |x, y| 30f64.to_radians().tan() * (60f64.to_radians().cos() * x + 60f64.to_radians().sin() * y);
    let waves: Formula = |x, y| {
        use std::f64::consts::PI;
        2.0 * (2.0 * PI * x / 3.0).sin() + 0.5 * (2.0 * PI * y / 7.0 + PI / 2.0).sin()
    };
    let cases: [(&str, Formula); 8] = [
        ("ramp = { slope = 45 }", |x, _| x),
        ("ramp = { slope = 30, azimuth = 60 }", slope),
        ("trench = { width = 1, depth = 1.25, wall = 45 }", |x, _| (x.abs() - 0.5).clamp(0.0, 1.25) - 1.25),
        ("wall = { height = 3 }", |x, _| if x == 0.0 { 3.0 } else { 0.0 }),
        ("wall = { height = 3, width = 2 }", |x, _| if x.abs() <= 1.0 { 3.0 } else { 0.0 }),
        ("cone = { height = 4, radius = 2 }", |x, y| (4.0 - 2.0 * x.hypot(y)).max(0.0)),
        ("bump = { height = 2, sigma = 0.7 }", |x, y| 2.0 * (-(x * x + y * y) / (2.0 * 0.7 * 0.7)).exp()),
        (
            "waves = [{ amplitude = 2, wavelength = 3 }, { amplitude = 0.5, wavelength = 7, azimuth = 90, phase = 90 }]",
            waves,
        ),
    ];
    for (generator, formula) in cases {
        let scene = load(&generated(generator));
        let field = field(&scene);
        assert_eq!((field.columns(), field.rows(), field.origin()), (9, 7, Vec2::new(-2.0, -3.0)));
        for (i, j) in (0..7).flat_map(|j| (0..9).map(move |i| (i, j))) {
            let at = field.position(i, j);
            let expected = formula(f64::from(at.x), f64::from(at.y));
            assert!((f64::from(at.z) - expected).abs() < 1e-6, "{generator} at {at}: expected {expected}");
        }
    }
}

#[test]
fn a_wall_stands_between_even_columns_too() {
    let scene = load(&scene("heights = { resolution = [4, 2], cell = [0.5, 1.0], wall = { height = 3 } }"));
    assert_eq!(field(&scene).heights(), [0.0, 3.0, 3.0, 0.0, 0.0, 3.0, 3.0, 0.0]);
}

#[test]
fn fractals_repeat_and_follow_their_seed() {
    let fractal = "fractal = { seed = 7, amplitude = 3, wavelength = 4, octaves = 6 }";
    let one = load(&generated(fractal));
    assert_eq!(one.content, load(&generated(fractal)).content);
    let other = load(&generated(&fractal.replace("seed = 7", "seed = 8")));
    assert_ne!(field(&one).heights(), field(&other).heights());
    let mean_square = |scene: &Scene| field(scene).heights().iter().map(|h| h * h).sum::<f32>() / 63.0;
    assert!((0.1..9.0).contains(&mean_square(&one)), "{}", mean_square(&one));
}

#[test]
fn a_field_is_scaled_then_moved_and_says_so_in_its_content() {
    let text = generated("cone = { height = 4, radius = 2 }");
    let (plain, placed) = (load(&text), load(&format!("{text}scale = 2.0\ntranslate = [10, 20, 30]\n")));
    for (i, j) in [(0, 0), (4, 3), (8, 6)] {
        assert_eq!(field(&placed).position(i, j), 2.0 * field(&plain).position(i, j) + Vec3::new(10.0, 20.0, 30.0));
    }
    assert_eq!(field(&placed).cell(), Vec2::new(1.0, 2.0));
    assert_ne!(plain.content, placed.content);
    let facts = plain.facts();
    assert_eq!((facts.height_fields, facts.triangles, facts.receivers), (1, 2 * 8 * 6, 63));
    assert_eq!(load(&format!("{text}casts = false\n")).facts().height_fields, 0);
}

#[test]
fn receivers_are_a_picture_of_the_vertices_with_north_at_the_top() {
    let moving = "motion = [{ time = 0, translate = [0, 0, 0] }, { time = 1, translate = [0, 0, 2] }]\n\
                  [frames]\ncount = 2\nfps = 1.0\n";
    let scene = load(&format!("{}{moving}", generated("ramp = { slope = 45, azimuth = 90 }")));
    for (frame, raised) in [(0, 0.0), (1, 2.0)] {
        let receivers = scene.frame(frame).receivers;
        assert_eq!(receivers.layout, Layout::Image { width: 9, height: 7 });
        assert_eq!(receivers.position[0], Vec3::new(-2.0, 3.0, 3.0 + raised));
        assert_eq!(receivers.position[62], Vec3::new(2.0, -3.0, -3.0 + raised));
        assert_eq!((receivers.place[0].uv, receivers.place[0].primitive), (Vec2::new(0.0, 6.0), 54));
        assert_eq!((receivers.place[62].uv, receivers.place[62].object), (Vec2::new(8.0, 0.0), Some(0)));
        for normals in [&receivers.normal, &receivers.geometric_normal] {
            assert!(normals.iter().all(|normal| normal.distance(Vec3::new(0.0, -1.0, 1.0).normalize()) < 1e-6));
        }
        assert!(receivers.valid.iter().all(|valid| *valid));
    }
}

#[test]
fn cameras_see_fields_from_above_with_their_grid_coordinates() {
    let camera =
        "[camera]\neye = [0.3, 0.2, 20]\ntarget = [0.3, 0.2, 0]\nup = [0, 1, 0]\nfov = 8\nwidth = 8\nheight = 8\n";
    let text =
        generated("cone = { height = 1, radius = 4 }").replace("heights = { object = \"terrain\" }", "camera = {}");
    let scene = load(&format!("{text}{camera}"));
    let (receivers, field) = (scene.frame(0).receivers, field(&scene));
    assert!(receivers.valid.iter().all(|valid| *valid));
    for (position, place) in receivers.position.iter().zip(&receivers.place) {
        let grid = (position.truncate() - field.origin()) / field.cell();
        assert!(place.uv.distance(grid) < 1e-5);
        assert!((field.surface(f64::from(grid.x), f64::from(grid.y)) - f64::from(position.z)).abs() < 1e-5);
    }
    assert!(receivers.geometric_normal.iter().all(|normal| normal.z > 0.5));
}

/// An EXR of 3 × 2 texels whose channels all hold `10·row + column`, changed by `change`.
fn write_exr(folder: &Folder, name: &str, channels: &[&str], change: impl Fn(usize, usize, f32) -> f32 + Sync) {
    let value = |at: exr::prelude::Vec2<usize>| change(at.x(), at.y(), (10 * at.y() + at.x()) as f32);
    let path = folder.path(name);
    let size = (3, 2);
    match channels {
        [one] => {
            let channels = SpecificChannels::build().with_channel(*one).with_pixel_fn(|at| (value(at),));
            exr::prelude::Image::from_channels(size, channels).write().to_file(path).unwrap();
        }
        [one, two] => {
            let build = SpecificChannels::build().with_channel(*one).with_channel(*two);
            let channels = build.with_pixel_fn(|at| (-1f32, value(at)));
            exr::prelude::Image::from_channels(size, channels).write().to_file(path).unwrap();
        }
        _ => unreachable!(),
    }
}

#[test]
fn pictures_of_heights_have_north_at_the_top() {
    let folder = Folder::new();
    for (name, channels) in [("y.exr", &["Y"][..]), ("z.exr", &["Z"]), ("ay.exr", &["A", "Y"]), ("gr.exr", &["G", "R"])]
    {
        write_exr(&folder, name, channels, |_, _, value| value);
        let scene = folder.load(&scene(&format!("heights = {{ file = \"{name}\", cell = [1, 1] }}"))).unwrap();
        assert_eq!(field(&scene).heights(), [10.0, 11.0, 12.0, 0.0, 1.0, 2.0], "{name}");
        let top_left = scene.frame(0).receivers.position[0];
        assert_eq!(top_left, Vec3::new(-1.0, 0.5, 0.0), "{name}");
    }
}

#[test]
fn waves_run_and_ground_grows_with_the_frames() {
    let frames = "[frames]\ncount = 5\nfps = 4.0\n";
    let wave =
        "waves = [{ amplitude = 0.5, wavelength = 4, speed = 2 }, { amplitude = 0.1, wavelength = 3, azimuth = 90 }]";
    let scene = load(&format!("{}translate = [0, 0, 7]\n{frames}", generated(wave)));
    assert_eq!((scene.facts().deforming, scene.facts().moving), (1, true));
    let expected = |position: Vec3, time: f64| {
        let turn = std::f64::consts::TAU;
        let run = 0.5 * (turn * (f64::from(position.x) - 2.0 * time) / 4.0).sin();
        7.0 + run + 0.1 * (turn * f64::from(position.y) / 3.0).sin()
    };
    for index in 0..5 {
        let frame = scene.frame(index);
        for position in &frame.receivers.position {
            let expected = expected(*position, index as f64 / 4.0);
            assert!((f64::from(position.z) - expected).abs() < 1e-5, "{index}: {position} for {expected}");
        }
        let mut hit = [None];
        let down = Ray { origin: Vec3::new(0.1, 0.2, 20.0), direction: -Vec3::Z, t_min: 0.0, t_max: f32::INFINITY };
        scene.world(&frame, Which::All).closest(&[down], &mut hit);
        let Shape::Heights(now) = &*frame.objects[0].shape else { panic!("a field") };
        let surface = now.surface(2.1 / 0.5, 3.2) as f32;
        assert!((20.0 - hit[0].expect("a hit").t - surface).abs() < 1e-4, "rays meet the field as it is");
    }
    let still = load(&format!("{}{frames}", generated(&wave.replace(", speed = 2", ""))));
    assert_eq!((still.facts().deforming, still.facts().moving), (0, false));

    let grow = "cone = { height = 4, radius = 2 }, grow = { from = 0.5, seconds = 0.5 }";
    let scene = load(&format!("{}{frames}", generated(grow)));
    let top = |index: usize| scene.frame(index).receivers.position.iter().map(|p| p.z).fold(0.0, f32::max);
    assert_eq!([0, 1, 2, 3].map(top), [2.0, 3.0, 4.0, 4.0]);
}

/// Per frame the field's heights, and its object's revision.
fn heights_and_revisions(scene: &Scene) -> Vec<(Vec<f32>, Revision)> {
    let of = |index| {
        let frame = scene.frame(index);
        let Shape::Heights(field) = &*frame.objects[0].shape else { panic!("a field") };
        (field.heights().to_vec(), frame.objects[0].revision)
    };
    (0..scene.frame_count).map(of).collect()
}

#[test]
fn revisions_change_exactly_when_heights_do() {
    let frames = "[frames]\ncount = 6\nfps = 4.0\n";
    let cone = "cone = { height = 4, radius = 2 }";
    let cases = [
        (cone.to_owned(), 1),
        (format!("{cone}, grow = {{ from = 0, seconds = 0.75 }}"), 4),
        (format!("{cone}, grow = {{ from = 1, seconds = 0.75 }}"), 1),
        ("waves = [{ amplitude = 0.5, wavelength = 4 }]".to_owned(), 1),
        ("waves = [{ amplitude = 0.5, wavelength = 4, speed = 2.1 }]".to_owned(), 6),
    ];
    for (generator, different) in cases {
        let scene = load(&format!("{}{frames}", generated(&generator)));
        let all = heights_and_revisions(&scene);
        for (one, other) in all.iter().flat_map(|one| all.iter().map(move |other| (one, other))) {
            assert_eq!(one.0 == other.0, one.1 == other.1, "{generator}");
        }
        let kinds: HashSet<u64> = all.iter().map(|(_, revision)| revision.0).collect();
        assert_eq!(kinds.len(), different, "{generator}");
        assert_eq!(heights_and_revisions(&load(&format!("{}{frames}", generated(&generator)))), all, "anew the same");
    }
}

#[test]
fn the_shipped_hills_grow_out_of_the_plane_and_then_stand() {
    let scene = halflight_scenes::find("growing").unwrap();
    let all = heights_and_revisions(&scene);
    let most: Vec<f32> = all.iter().map(|(heights, _)| heights.iter().fold(0.0, |most, z| z.abs().max(most))).collect();
    assert_eq!(most[0], 0.0);
    for (frame, height) in most.iter().enumerate() {
        let share = (frame as f32 / 4.0).min(1.0);
        assert!((height - share * most[7]).abs() < 1e-4 && most[7] > 30.0, "{most:?}");
    }
    let still: Vec<bool> = all.windows(2).map(|pair| pair[0].1 == pair[1].1).collect();
    assert_eq!(still, [false, false, false, false, true, true, true]);
}

fn refused(folder: &Folder, text: &str, place: &str, expected: &str) {
    let error = folder.load(text).expect_err(text).to_string();
    assert!(
        !error.contains('\n') && error.contains(place) && error.contains(expected),
        "{error} lacks {place} {expected}"
    );
}

#[test]
fn values_that_cannot_be() {
    let cone = generated("cone = { height = 4, radius = 2 }");
    let replaced = |from: &str, to: &str| {
        assert!(cone.contains(from));
        cone.replace(from, to)
    };
    let turned = format!("{cone}rotate = {{ axis = [0, 0, 1], degrees = 90 }}\n");
    let turning =
        format!("{cone}motion = [{{ time = 0 }}, {{ time = 1, rotate = {{ axis = [0, 0, 1], degrees = 9 }} }}]\n");
    let cases = [
        (turned, "objects[0].rotate: ", "height fields stand upright"),
        (turning, "objects[0].motion[1].rotate: ", "height fields stand upright"),
        (replaced("[9, 7]", "[1, 7]"), "objects[0].heights.resolution: ", "2..=16384"),
        (replaced("[9, 7]", "[16384, 16384]"), "objects[0].heights.resolution: ", "product is at most"),
        (replaced("resolution = [9, 7], ", ""), "objects[0].heights.resolution: ", "no file is given"),
        (replaced("[0.5, 1.0]", "[0.5, 0.0]"), "objects[0].heights.cell: ", "positive"),
        (replaced("[0.5, 1.0]", "[0.5, nan]"), "objects[0].heights.cell: ", "positive"),
        (replaced("[0.5, 1.0]", "[-0.5, 1.0]"), "objects[0].heights.cell: ", "positive"),
        (replaced("[0.5, 1.0]", "[inf, 1.0]"), "objects[0].heights.cell: ", "positive"),
        (replaced("height = 4", "height = inf"), "objects[0].heights.cone.height: ", "finite"),
        (replaced("height = 4", "height = nan"), "objects[0].heights.cone.height: ", "finite"),
        (replaced("radius = 2", "radius = -2"), "objects[0].heights.cone.radius: ", "positive"),
        (
            replaced("cone = { height = 4, radius = 2 }", ""),
            "objects[0].heights: ",
            "exactly one of file, ramp, trench",
        ),
        (
            replaced("cone", "grow = { from = 2, seconds = 1 }, cone"),
            "objects[0].heights.grow.from: ",
            "share in 0..=1",
        ),
        (replaced("cone", "grow = { from = 0, seconds = 0 }, cone"), "objects[0].heights.grow.seconds: ", "positive"),
        (
            format!("{cone}deform = {{ period = 1, twist = {{ degrees = 9, height = 1 }} }}\n"),
            "objects[0].deform: ",
            "mesh or a solid",
        ),
        (replaced("cone", "wall = { height = 1 }, cone"), "objects[0].heights: ", "found [\"wall\", \"cone\"]"),
        (replaced("cone", "sha256 = \"00\", cone"), "objects[0].heights.sha256: ", "beside a file"),
        (replaced("cone", "range = [0, 1], cone"), "objects[0].heights.range: ", "beside a file"),
        (replaced("cone", "nodata = 0, cone"), "objects[0].heights.nodata: ", "beside a file"),
        (replaced("cone", "file = \"a.exr\", cone"), "objects[0].heights: ", "either a file or a resolution"),
        (replaced("cone = { height = 4", "cone = { hight = 4"), "", "unknown field `hight`"),
        (generated("ramp = { slope = 90 }"), "heights.ramp.slope: ", "below 90"),
        (generated("ramp = { slope = 89.9999999 }"), "heights.ramp.slope: ", "below 90"),
        (generated("trench = { depth = 1, wall = 45, width = -1 }"), "heights.trench.width: ", "not negative"),
        (generated("waves = []"), "heights.waves: ", "1..=64"),
        (generated("waves = [{ amplitude = 1, wavelength = 0 }]"), "heights.waves[0].wavelength: ", "positive"),
        (
            generated("fractal = { seed = 1, amplitude = 1, wavelength = 1, octaves = 33 }"),
            "heights.fractal.octaves: ",
            "1..=32",
        ),
        (
            generated("fractal = { seed = 1, amplitude = 1e9, wavelength = 1, octaves = 32, gain = 1e9 }"),
            "objects[0].heights: ",
            "at most 1e9",
        ),
        (format!("{cone}translate = [1e8, 0, 0]\n"), "objects[0]: ", "no two vertices fall together"),
        (format!("{cone}scale = 1e9\ntranslate = [0, 0, 0]\n"), "objects[0]: ", "at most 1e9"),
        (
            replaced("heights = { object = \"terrain\" }", "vertices = { object = \"terrain\" }"),
            "receivers.vertices",
            "mesh",
        ),
        (replaced("object = \"terrain\"", "object = \"hill\""), "receivers.heights.object: ", "\"terrain\""),
    ];
    let folder = Folder::new();
    for (text, place, expected) in cases {
        refused(&folder, &text, place, expected);
    }
    let ball = cone.replace(
        "heights = { resolution = [9, 7], cell = [0.5, 1.0], cone = { height = 4, radius = 2 } }",
        "plane = { size = [1, 1] }",
    );
    refused(&folder, &ball, "receivers.heights.object: ", "an object with heights");
}

#[test]
fn the_narrowest_fields_have_receivers_and_are_hit() {
    for (size, cell) in [([2, 2], [1.0, 1.0]), ([2, 40], [0.25, 8.0]), ([40, 2], [8.0, 0.25])] {
        let scene =
            load(&scene(&format!("heights = {{ resolution = {size:?}, cell = {cell:?}, ramp = {{ slope = 30 }} }}")));
        let (field, frame) = (field(&scene), scene.frame(0));
        assert_eq!(([field.columns(), field.rows()], frame.receivers.len()), (size, size[0] * size[1]));
        let mut hit = [None];
        let ray = Ray { origin: Vec3::new(0.01, 0.02, 99.0), direction: -Vec3::Z, t_min: 0.0, t_max: f32::INFINITY };
        scene.world(&frame, Which::All).closest(&[ray], &mut hit);
        let height = 99.0 - hit[0].expect("a hit").t;
        assert!((height - 0.01 * 30f32.to_radians().tan()).abs() < 1e-4, "{size:?}: {height}");
    }
}

#[test]
fn holes_are_filled_where_the_scene_says_what_they_hold() {
    let folder = Folder::new();
    for (hole, nodata) in
        [(f32::NAN, "nan"), (-9999.0, "-9999"), (f32::MIN, "-3.4028234663852886e38"), (f32::INFINITY, "inf")]
    {
        write_exr(&folder, "holes.exr", &["Y"], |x, y, height| if (x, y) == (1, 0) { hole } else { height });
        let text = |more: &str| scene(&format!("heights = {{ file = \"holes.exr\", cell = [1, 1]{more} }}"));
        let filled = folder.load(&text(&format!(", nodata = {nodata}"))).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(field(&filled).heights(), [10.0, 11.0, 12.0, 0.0, 7.0, 2.0]);
        let told = "holes.exr: 1 of 6 heights without data: filled from their neighbours";
        assert!(filled.notices.len() == 1 && filled.notices[0].ends_with(told), "{:?}", filled.notices);
        if nodata == "-9999" {
            assert_eq!(field(&folder.load(&text("")).unwrap()).heights()[4], hole, "a depth like others unless told");
        } else {
            refused(&folder, &text(""), "holes.exr: texel (1, 0): ", "`nodata` is that");
            refused(&folder, &text(", nodata = -1"), "holes.exr: texel (1, 0): ", "a finite height");
        }
    }
    write_exr(&folder, "nothing.exr", &["Y"], |_, _, _| f32::NAN);
    let text = scene("heights = { file = \"nothing.exr\", cell = [1, 1], nodata = nan }");
    refused(&folder, &text, "objects[0].heights.nodata: ", "not all of the picture has");
    write_exr(&folder, "whole.exr", &["Y"], |_, _, value| value);
    let text = scene("heights = { file = \"whole.exr\", cell = [1, 1], nodata = nan }");
    assert!(folder.load(&text).unwrap().notices.is_empty());
}

#[test]
fn pictures_that_cannot_be() {
    let folder = Folder::new();
    let text = |name: &str| scene(&format!("heights = {{ file = \"{name}\", cell = [1, 1] }}"));
    for (value, name) in [(f32::NAN, "nan.exr"), (f32::INFINITY, "inf.exr"), (-2e9, "far.exr")] {
        write_exr(&folder, name, &["Y"], |x, y, height| if (x, y) == (2, 1) { value } else { height });
        refused(&folder, &text(name), &format!("{name}: texel (2, 1): "), "a finite height");
    }
    write_exr(&folder, "two.exr", &["A", "B"], |_, _, value| value);
    refused(&folder, &text("two.exr"), "two.exr: channels: ", "Y or R, or one channel alone");
    write_exr(&folder, "whole.exr", &["Y"], |_, _, value| value);
    let bytes = std::fs::read(folder.path("whole.exr")).unwrap();
    for end in [0, 3, 50, bytes.len() / 2, bytes.len() - 1] {
        folder.write("cut.exr", &bytes[..end]);
        refused(&folder, &text("cut.exr"), "cut.exr: OpenEXR: ", "expected a whole file");
    }
    refused(&folder, &text("gone.exr"), "gone.exr: ", "expected a readable file");
}
