//! Cuts through hierarchies of blockers: what they leave as it is, and what they may change.

use std::f32::consts::PI;

use glam::Vec3;
use halflight_blockers::clusters;
use halflight_contract::{Backend, Cache, Job, Method, NoMeter, Output, Params, Quantity};
use halflight_scenes::{Content, Emission, Frame, Light, Object, Placement, Rgb, Scene, Shape, Sky, Sphere};
use std::sync::Arc;

/// Radiance of white receivers under a uniform sky of 1.
fn radiance(scene: &Scene, settings: &str) -> Vec<Rgb> {
    let method = &halflight_shexp::Hyb;
    let settings = settings.split(' ').filter_map(|setting| setting.split_once('='));
    let params = Params::resolve(method.info().params, settings).expect("its parameters");
    let cache = Cache::in_memory();
    let job = Job::new(scene, &params, 1, Backend::Cpu, &cache);
    let mut prepared = method.prepare(&job, &mut NoMeter).expect("spheres need no preparation");
    let frame = white(scene.frame(0));
    let mut out = vec![Rgb::NAN; frame.receivers.len()];
    prepared.update(&frame, &mut NoMeter).expect("a frame");
    prepared.evaluate(&frame, Quantity::Direct, &mut NoMeter).expect("direct light");
    prepared.read(Output::Radiance(&mut out), &mut NoMeter).expect("as many");
    out
}

fn white(mut frame: Frame) -> Frame {
    let mut receivers = (*frame.receivers).clone();
    receivers.albedo.fill(Rgb::ONE);
    frame.receivers = Arc::new(receivers);
    frame
}

fn scene(heaps: Vec<Vec<Sphere>>, receivers: Vec<(Vec3, Vec3)>) -> Scene {
    let object = |spheres: Vec<Sphere>| {
        let shape = Shape::Spheres(spheres);
        Object {
            name: "heap".into(),
            content: shape.content(),
            shape: Arc::new(shape),
            albedo: Rgb::ONE,
            texture: None,
            emission: Emission::Even(Rgb::ZERO),
            casts: true,
            motion: Vec::new(),
            pivot: Vec3::ZERO,
            deformation: None,
        }
    };
    Scene {
        name: "heaps".into(),
        purpose: "tests".into(),
        content: Content::of(b"heaps"),
        objects: heaps.into_iter().map(object).collect(),
        lights: vec![Light::Sky(Sky::Uniform(Rgb::ONE)).into()],
        camera: None,
        placement: Placement::Points(Arc::new(receivers)),
        frame_count: 1,
        fps: 1.0,
        notices: Vec::new(),
        bodies: Default::default(),
    }
}

fn wave(i: usize, phase: f32) -> f32 {
    (i as f32 * 2.399 + phase).sin()
}

fn heap(center: Vec3, count: usize) -> Vec<Sphere> {
    let place = |i: usize| center + 0.4 * Vec3::new(wave(i, 0.0), wave(3 * i, 1.0), wave(7 * i, 2.0));
    (0..count).map(|i| Sphere { center: place(i), radius: 0.03 + 0.05 * wave(5 * i, 3.0).abs() }).collect()
}

/// A flat ground under two heaps, one object each.
fn ground_and_heaps() -> Scene {
    let heaps = vec![heap(Vec3::new(-1.5, 0.3, 0.6), 60), heap(Vec3::new(1.2, -0.5, 0.9), 40)];
    let ground =
        (0..40 * 40).map(|i| (Vec3::new((i % 40) as f32 * 0.15 - 3.0, (i / 40) as f32 * 0.15 - 3.0, 0.0), Vec3::Z));
    scene(heaps, ground.collect())
}

fn worst(a: &[Rgb], b: &[Rgb]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

#[test]
fn a_cut_of_leaves_alone_is_every_sphere() {
    let scene = ground_and_heaps();
    for rule in ["continuous", "paper", "off"] {
        for least in ["0", "1.5"] {
            let common = format!("self-shadow={rule} min-angle={least}");
            let exact = radiance(&scene, &common);
            let leaves = radiance(&scene, &format!("{common} cut=1e-5"));
            assert!(worst(&exact, &leaves) < 2e-5, "{common}: {}", worst(&exact, &leaves));
        }
    }
}

#[test]
fn ratio_vectors_make_coarse_blockers_look_like_fine_ones() {
    let scene = ground_and_heaps();
    let exact = radiance(&scene, "");
    let [with, without] = ["cut=25", "cut=25 ratio=false"].map(|settings| worst(&exact, &radiance(&scene, settings)));
    assert!(with > 1e-5, "no bounding sphere stands for anything");
    assert!(with < 0.02 && with < 0.15 * without, "{with} with, {without} without");
}

/// Nodes are small in the cut of a cluster of one place: what is left is the least-squares scaling, which a uniform sky does not see
/// but for the products of bands.
#[test]
fn a_cluster_of_one_place_loses_next_to_nothing() {
    let places = [Vec3::new(2.5, 1.0, 0.0), Vec3::new(-3.5, 0.0, 0.0), Vec3::new(0.0, -3.0, 0.0)];
    let receivers = places.iter().flat_map(|place| [(*place, Vec3::Z); 16]).collect();
    let scene = scene(vec![heap(Vec3::new(0.0, 0.0, 0.7), 80)], receivers);
    let exact = radiance(&scene, "");
    let cut = radiance(&scene, "cut=20 cluster=16");
    assert!(worst(&exact, &cut) < 2e-3, "{}", worst(&exact, &cut));
    assert!(worst(&exact, &radiance(&scene, "cut=20 cluster=16 ratio=false")) > 1e-2);
}

#[test]
fn whatever_the_spheres_results_are_finite() {
    let center = Vec3::new(0.3, 0.2, 0.1);
    let odd = vec![
        Sphere { center, radius: 0.0 },
        Sphere { center, radius: 1e-6 },
        Sphere { center, radius: 0.5 },
        Sphere { center: Vec3::Z * 1e6, radius: 9e5 },
        Sphere { center: Vec3::new(2.0, 0.0, 0.5), radius: 0.5 },
        Sphere { center: Vec3::new(2.0, 0.0, 0.0), radius: 0.0 },
        Sphere { center: Vec3::splat(1e20), radius: 1e19 },
    ];
    let coincident = vec![Sphere { center: Vec3::new(-1.0, 0.0, 1.0), radius: 0.2 }; 300];
    let places = [
        center,
        Vec3::ZERO,
        Vec3::new(2.0, 0.0, 0.0),
        Vec3::new(-1.0, 0.0, 1.0),
        Vec3::new(-1.0, 0.0, 0.8),
        Vec3::X * 1e4,
    ];
    let normals = [Vec3::Z, Vec3::X, -Vec3::Z, Vec3::new(0.6, 0.0, 0.8)];
    let receivers = places.iter().flat_map(|place| normals.map(|normal| (*place, normal))).collect();
    let scene = scene(vec![odd, coincident, heap(Vec3::Z, 50), Vec::new()], receivers);
    for rule in ["continuous", "paper", "off"] {
        for (order, cut) in [(4, 5), (4, 60), (8, 30)] {
            for value in radiance(&scene, &format!("self-shadow={rule} order={order} cut={cut} cluster=16")) {
                // What the guard leaves: order times the light's mean, and more than nothing is dark.
                assert!(
                    value.is_finite() && value.abs().max_element() <= PI * order as f32,
                    "{rule} {order} {cut}: {value}"
                );
            }
        }
    }
}

#[test]
fn clusters_hold_every_receiver_once_in_whole_registers() {
    let receivers = ground_and_heaps().frame(0).receivers;
    let mut receivers = (*receivers).clone();
    (0..receivers.len()).step_by(7).for_each(|i| receivers.valid[i] = false);
    for size in [16, 100, 256, 100_000] {
        let clusters = clusters(&receivers, size);
        let mut all: Vec<usize> = clusters.iter().flatten().copied().collect();
        all.sort_unstable();
        assert!(all.iter().copied().eq((0..receivers.len()).filter(|&i| receivers.valid[i])));
        assert!(clusters.iter().all(|cluster| cluster.len() <= size && !cluster.is_empty()));
        let ragged = clusters.iter().filter(|cluster| cluster.len() % 16 != 0).count();
        assert!(ragged <= 1, "{ragged} clusters leave lanes idle");
        let extent = |cluster: &Vec<usize>| {
            let first = receivers.position[cluster[0]];
            cluster.iter().map(|&i| receivers.position[i].distance(first)).fold(0.0, f32::max)
        };
        let largest = clusters.iter().map(extent).fold(0.0, f32::max);
        assert!(largest < 0.15 * 3.5 * (size as f32).sqrt(), "{size} receivers reach {largest}");
    }
}
