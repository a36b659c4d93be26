//! Cuts, which the CPU makes for both backends.

use halflight_contract::{Backend, Cache, Job, Method, NoMeter, Params, Quantity};
use halflight_scenes::{Light, Rgb, Scene, Sky};
use halflight_tests::checks::{self, Case};
use halflight_tests::fixtures;

use super::{Counted, Seen, apart, count_alike, methods, tolerance, tuned};

/// The methods that sum logs.
fn with_cuts() -> impl Iterator<Item = &'static dyn Method> {
    methods().filter(|method| method.info().params.iter().any(|spec| spec.name == "cut"))
}

/// Settings that make cuts of different kinds.
const SETTINGS: [&str; 4] = [
    "order=2 cut=40 cluster=16",
    "order=2 cut=40 cluster=16 ratio=false",
    "order=3 cut=60 cluster=32",
    "order=2 cut=40 cluster=16 min-angle=2",
];

#[test]
fn backends_agree_on_cuts() {
    let scene = fixtures::heaps();
    let seen = Seen::of(&scene);
    for method in with_cuts() {
        for settings in SETTINGS {
            let params = tuned(method, settings);
            let order = params.int("order") as u8;
            // Ratio vectors make a bounding sphere's log as long as the sum of what it bounds.
            let tolerance = tolerance(order, seen);
            for quantity in [Quantity::Direct, Quantity::Visibility { order }] {
                let largest = apart(&Case::new(method, &scene, quantity).tuned(params.clone()));
                let id = method.info().id;
                println!("{id}, {settings}, {quantity}: {largest:.1e} apart, {tolerance:.1e} allowed");
                assert!(largest <= tolerance, "{id}, {settings}, {quantity}: {largest:e} > {tolerance:e}");
            }
        }
    }
}

#[test]
fn both_backends_count_the_same_work_on_cuts() {
    let scene = fixtures::heaps();
    for (method, settings) in with_cuts().flat_map(|method| SETTINGS.map(|settings| (method, settings))) {
        let counted = count_alike(method, &scene, &tuned(method, settings));
        assert!(counted.0["receiver clusters"] > 10, "{settings}: {counted:?}");
        assert!(counted.0.contains_key("spheres seen in detail") != settings.contains("ratio=false"), "{settings}");
    }
}

#[test]
fn the_contract_holds_on_cuts() {
    let scene = fixtures::heaps();
    for method in with_cuts() {
        let case = Case { backend: Backend::GPU, ..Case::new(method, &scene, Quantity::Direct) };
        let case =
            Case { fixed: &["order", "extra-bands", "spheres", "cut"], ..case.tuned(tuned(method, SETTINGS[0])) };
        for (_, check) in checks::CHECKS {
            check(&case).unwrap_or_else(|violation| panic!("{violation}"));
        }
    }
}

/// Cuts go to the device again when something that they are made of changes, and only then.
#[test]
fn only_new_cuts_are_uploaded() {
    let scene = Scene { frame_count: 3, ..moving_heaps() };
    let method = halflight_registry::find("shexp/hyb").expect("it is registered");
    let (params, cache) = (tuned(method, SETTINGS[0]), Cache::in_memory());
    let job = Job::new(&scene, &params, 1, Backend::GPU, &cache);
    let mut prepared = method.prepare(&job, &mut NoMeter).expect("is supported");
    let mut frame = |index, params: &Params| {
        let (mut update, mut evaluate, frame) = (Counted::default(), Counted::default(), scene.frame(index));
        prepared.retune(params).expect("no phase before update");
        prepared.update(&frame, &mut update).expect("updates");
        prepared.evaluate(&frame, Quantity::Direct, &mut evaluate).expect("shades");
        [update, evaluate].map(|counted| counted.0.get("bytes uploaded").copied().unwrap_or(0))
    };
    let receivers = 64 * 24 * 20;
    let [first, settings] = frame(0, &params);
    assert!(first > receivers, "{first}");
    assert_eq!(frame(0, &params)[0], 0, "the same frame again");
    let [moved, _] = frame(1, &params);
    assert!(0 < moved && moved < receivers, "{moved} bytes for spheres that moved");
    let again = frame(1, &tuned(method, SETTINGS[1]));
    assert!(0 < again[0] && again[0] < moved && again[1] < settings, "{again:?} for cuts without ratio vectors");
    assert!(frame(1, &tuned(method, "order=2 cut=40 cluster=32"))[0] > receivers, "other clusters");
}

/// Heaps that move, under a uniform sky.
fn moving_heaps() -> Scene {
    let there =
        |x| halflight_scenes::Pose { translation: glam::Vec3::new(x, 0.0, 0.0), ..halflight_scenes::Pose::IDENTITY };
    let mut scene = fixtures::heaps();
    scene.objects[1].motion = vec![(0.0, there(0.0)), (2.0, there(0.5))];
    scene.lights = vec![Light::Sky(Sky::Uniform(Rgb::ONE)).into()];
    scene
}
