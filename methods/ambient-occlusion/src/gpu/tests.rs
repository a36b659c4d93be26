//! The shaders against walks in f64 over what they were given, uploads, and faults planted in every file.

use glam::Vec3;
use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, NoMeter, Params, Quantity};
use halflight_scenes::{Light, Mesh, Object, Placement, Rgb, Scene, Shape, Sky};
use halflight_tests::checks::{Case, Fault, planted};
use halflight_tests::fixtures;

use super::*;
use crate::Elements;
use oracle::{ROUNDING, Walk};

mod oracle;

/// The fixture under a white sky, so that radiance is accessibility times albedo.
fn under_white_sky(scene: Scene) -> Scene {
    Scene { lights: vec![Light::Sky(Sky::Uniform(Rgb::ONE)).into()], ..scene }
}

fn prepared(scene: &Scene, settings: &[(&str, &str)]) -> Occlusion {
    let params = Params::resolve(INFO.params, settings.iter().copied()).expect("in range");
    let cache = Cache::in_memory();
    Occlusion::prepare(&Job::new(scene, &params, 1, Backend::GPU, &cache), &mut NoMeter).expect("there is an adapter")
}

fn shaded(occlusion: &mut Occlusion, frame: &Frame) -> Vec<Rgb> {
    occlusion.update(frame, &mut NoMeter).expect("updates");
    occlusion.evaluate(frame, Quantity::Direct, &mut NoMeter).expect("shades");
    let mut out = vec![Rgb::ZERO; frame.receivers.len()];
    occlusion.read(Output::Radiance(&mut out), &mut NoMeter).expect("reads");
    out
}

/// Every receiver of every fixture, each pass of its own: what is found lies within what roundings add up to.
#[test]
fn accessibility_is_that_of_walks_in_f64() {
    let mut scenes = fixtures::all();
    scenes.push(fixtures::mesh_in_two_lights());
    for scene in scenes.into_iter().map(under_white_sky) {
        for (passes, opening) in [("1", "0.25"), ("2", "0.25"), ("2", "0")] {
            let settings = [("order", "2"), ("passes", passes), ("opening", opening), ("elements", "600")];
            let mut occlusion = prepared(&scene, &settings);
            let frame = scene.frame(0);
            let found = shaded(&mut occlusion, &frame);
            let walk = Walk::new(&occlusion.stage);
            let receivers = &frame.receivers;
            let (mut largest, mut share) = (0.0f64, 0.0f64);
            for i in (0..receivers.len()).filter(|&i| receivers.valid[i] && receivers.albedo[i].x > 0.0) {
                let expected = walk.accessibility(receivers.position[i], receivers.normal[i]);
                let found = f64::from(found[i].x / receivers.albedo[i].x);
                let (error, allowed) = ((found - expected.value).abs(), expected.bound + 8.0 * ROUNDING);
                let name = &scene.name;
                assert!(
                    error <= allowed,
                    "{name}, {settings:?}, {i}: {found} for {expected:?}, {error:e} > {allowed:e}"
                );
                (largest, share) = (largest.max(error), share.max(error / allowed));
            }
            println!(
                "{}, passes {passes}, opening {opening}: {largest:.1e}, {share:.2} of what is allowed",
                scene.name
            );
        }
    }
}

/// Two plates of 40 000 vertices above a receiver, all of their 131 070 nodes looked at.
#[test]
fn walks_that_a_driver_ends_are_an_error() {
    let plate = |height: f32| {
        let at = |i: usize| Vec3::new((i % 200) as f32 - 99.5, (i / 200) as f32 - 99.5, height);
        let corner = |i: usize| (i / 199 * 200 + i % 199) as u32;
        let positions: Vec<Vec3> = (0..40_000).map(at).collect();
        let triangles = (0..199 * 199).map(|i| [corner(i), corner(i) + 1, corner(i) + 200]).collect();
        let mesh = Mesh { normals: vec![Vec3::Z; positions.len()], uvs: Vec::new(), positions, triangles };
        let shape = Shape::Mesh(mesh);
        Object { content: shape.content(), shape: Arc::new(shape), ..fixtures::spheres("plate", Vec::new()) }
    };
    let receiver = Placement::Points(Arc::new(vec![(Vec3::ZERO, Vec3::Z)]));
    let light = vec![Light::Sky(Sky::Uniform(Rgb::ONE))];
    let scene = fixtures::scene("plates", vec![plate(50.0), plate(60.0)], light, receiver);
    let frame = scene.frame(0);
    let settings = [("order", "1"), ("elements", "32768"), ("opening", "0"), ("passes", "1")];
    let mut occlusion = prepared(&scene, &settings);
    occlusion.update(&frame, &mut NoMeter).expect("updates");
    let answer = occlusion.evaluate(&frame, Quantity::Direct, &mut NoMeter);
    if occlusion.gpu.adapter().is_software() {
        let error = answer.expect_err("lavapipe ends it").to_string();
        assert!(error.contains("1 walks over 131070 elements") && error.contains("llvmpipe"), "{error}");
    } else {
        answer.expect("goes to its end");
    }
    let mut opened_later = prepared(&scene, &[settings[0], settings[1], ("opening", "0.5"), settings[3]]);
    let found = f64::from(shaded(&mut opened_later, &frame)[0].x);
    let expected = Walk::new(&opened_later.stage).accessibility(Vec3::ZERO, Vec3::Z);
    assert!(expected.value < 0.9 && (found - expected.value).abs() <= expected.bound, "{found} for {expected:?}");
}

/// Counts bytes that go to the device, and keeps what passes say that they did.
#[derive(Default)]
struct Told {
    uploaded: u64,
    work: Vec<(&'static str, u64, u64)>,
}

impl Meter for Told {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        self.uploaded += if counter == "bytes uploaded" { amount } else { 0 };
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
    fn work(&mut self, pass: &'static str, operations: u64, bytes: u64) {
        self.work.push((pass, operations, bytes));
    }
}

#[test]
fn only_what_moved_is_uploaded() {
    let scene = fixtures::moving_sphere();
    let mut occlusion = prepared(&scene, &[("elements", "100")]);
    let mut update = |frame: usize| {
        let mut told = Told::default();
        occlusion.update(&scene.frame(frame), &mut told).expect("updates");
        told.uploaded
    };
    update(0);
    assert_eq!(update(0), 0);
    // A ball of 100 elements has 199 nodes of 32 bytes; before its pass 24 bytes of counters are cleared.
    assert_eq!(update(1), 199 * 32 + 24);
    assert_eq!(update(1), 0);
}

#[test]
fn passes_tell_their_work() {
    // A receiver below a ball of 16 elements, each summed, and the 15 groups above them opened.
    let scene = fixtures::sphere_over_plane();
    let mut occlusion = prepared(&scene, &[("elements", "16"), ("opening", "0"), ("order", "1")]);
    let (frame, mut told) = (scene.frame(0), Told::default());
    occlusion.update(&frame, &mut told).expect("updates");
    occlusion.evaluate(&frame, Quantity::Direct, &mut told).expect("shades");
    let [("elements", among, _), ("groups", groups, bytes), ("receivers", receivers, moved)] = told.work[..] else {
        panic!("{:?}", told.work)
    };
    assert_eq!((groups, bytes), (12 * 15, 56 * 15));
    let count = frame.receivers.valid.iter().filter(|valid| **valid).count() as u64;
    let walks = |points: u64| points * (31 * work::LOOK + 16 * work::SUM);
    assert!((walks(16)..=walks(16) + 16 * 16 * work::FACE).contains(&among), "{among}");
    let shading = 13 * count;
    let least = walks(count) + shading;
    assert!((least + 1..least + count * 16 * work::FACE).contains(&receivers), "{receivers} of {least} at least");
    assert_eq!(moved, 31 * 36 + 60 * count + 12);
}

#[test]
fn a_wrong_number_is_seen() {
    let scene = fixtures::hills();
    let params = Params::resolve(INFO.params, [("order", "2")]).expect("in range");
    let method: &dyn Method = &Elements;
    let case = Case::new(method, &scene, Quantity::Direct).tuned(params);
    let faults: [Fault; 9] = [
        ("next[node + 1u]", "next[node]"),                 // forest.wgsl
        ("square <= place.w", "square <= 1.5f * place.w"), // shadow.wgsl
        ("4f * dot", "4.1f * dot"),
        ("(rim + distance)", "(rim + 1.1f * distance)"),
        ("max(1f - shadow, 0f)", "max(1.01f - shadow, 0f)"),
        ("vec4f(accessibility(shadow.sum)", "vec4f(1f"), // elements.wgsl
        ("a.w / area", "0.6f"),                          // groups.wgsl
        ("t4 = 1.0f", "t4 = 1.01f"),                     // generated
        ("3u * index + channel", "3u * index + 2u - channel"), // receivers.wgsl
    ];
    let (right, wrong) = planted(&case, &faults, |job, (text, fault)| {
        let changed = |order| {
            let Shaders { elements, groups, receivers } = Shaders::new(order);
            let texts = [elements, groups, receivers];
            assert!(texts.iter().any(|whole| whole.contains(text)), "{text} is in no shader");
            let [elements, groups, receivers] = texts.map(|whole| whole.replacen(text, fault, 1));
            Shaders { elements, groups, receivers }
        };
        let gpu = Gpu::shared(job.backend)?;
        let occlusion = Occlusion::with_shaders(gpu, Stage::derive(job, &mut NoMeter)?, changed, &mut NoMeter)?;
        Ok(Box::new(occlusion))
    });
    println!("{right:e} without a fault, {wrong:?} with one");
    assert!(right < 1e-5, "{right:e} without a fault");
    assert!(wrong.iter().all(|distance| *distance > 1e-4), "{faults:?} change {wrong:?}");
}

#[test]
fn neighbours_go_up_together() {
    assert_eq!(joined(&[0..3, 3..5, 7..9, 9..9, 10..11]), [0..5, 7..9, 10..11]);
}
