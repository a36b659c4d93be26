//! Blockers that never move, which the CPU accumulates for both backends.

use halflight_contract::{Backend, Cache, Job, Method, NoMeter, Quantity};
use halflight_tests::checks::{self, Case};
use halflight_tests::fixtures;

use super::{Counted, Seen, apart, count_alike, methods, tolerance, tuned};

/// The methods that bake, all blockers before all receivers and, those that do, with cuts.
fn bakers() -> impl Iterator<Item = (&'static dyn Method, &'static str)> {
    let has = |method: &dyn Method, name| method.info().params.iter().any(|spec| spec.name == name);
    let plain = methods().filter(move |method| has(*method, "bake")).map(|method| (method, "order=2 bake=true"));
    let with_cuts = methods().filter(move |method| has(*method, "cut"));
    plain.chain(with_cuts.map(|method| (method, "order=2 bake=true cut=40 cluster=16")))
}

#[test]
fn backends_agree_and_count_alike_on_baked_blockers() {
    let mut heaps = fixtures::heaps();
    heaps.objects[1].motion = fixtures::moving_sphere().objects[1].motion.clone();
    for scene in [fixtures::moving_sphere(), fixtures::two_lights(), heaps] {
        let tolerance = tolerance(2, Seen::of(&scene));
        for (method, settings) in bakers() {
            let params = tuned(method, settings);
            let counted = count_alike(method, &scene, &params);
            assert!(counted.0["blockers baked"] > 0 && counted.0["blockers kept from before"] > 0, "{counted:?}");
            for quantity in [Quantity::Direct, Quantity::Visibility { order: 2 }] {
                let largest = apart(&Case::new(method, &scene, quantity).tuned(params.clone()));
                let (id, name) = (method.info().id, &scene.name);
                println!("{id} on {name}, {settings}, {quantity}: {largest:.1e} apart, {tolerance:.1e} allowed");
                assert!(largest <= tolerance, "{id} on {name}, {settings}, {quantity}: {largest:e} > {tolerance:e}");
            }
        }
    }
}

#[test]
fn the_contract_holds_on_baked_blockers() {
    let scene = fixtures::moving_sphere();
    for (method, settings) in bakers() {
        let case = Case { backend: Backend::GPU, ..Case::new(method, &scene, Quantity::Direct) };
        let fixed = &["order", "extra-bands", "spheres", "cut", "bake", "local-lights", "lamps", "window-light"];
        let case = Case { fixed, ..case.tuned(tuned(method, settings)) };
        for (_, check) in checks::CHECKS {
            check(&case).unwrap_or_else(|violation| panic!("{violation}"));
        }
    }
}

/// What is baked goes to the device once for where receivers are.
#[test]
fn baked_blockers_stay_on_the_device() {
    let scene = fixtures::moving_sphere();
    let method = halflight_registry::find("shexp/hyb").expect("it is registered");
    let (params, cache) = (tuned(method, "order=2 bake=true"), Cache::in_memory());
    let mut prepared = method.prepare(&Job::new(&scene, &params, 1, Backend::GPU, &cache), &mut NoMeter).expect("runs");
    let uploaded = [0, 1, 2].map(|frame| {
        let mut counted = Counted::default();
        prepared.update(&scene.frame(frame), &mut counted).expect("updates");
        counted.0.get("bytes uploaded").copied().unwrap_or(0)
    });
    // Receivers of 64 bytes, their sums of 4·(1 + 4), the sphere that moves.
    assert_eq!(uploaded, [72 * (64 + 20) + 16, 16, 16]);
}
