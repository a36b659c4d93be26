//! What a list of blockers may hold without changing the light: another order, and spheres that block nothing.

use std::sync::Arc;

use glam::Vec3;
use halflight_contract::{Method, Params, Quantity};
use halflight_scenes::{Light, Placement, Rgb, Scene, Sky, Sphere};
use halflight_tests::{checks::Case, fixtures, stress};
use proptest::prelude::*;

/// Spheres over a ground, perhaps through it, 1 to 24 of them.
fn spheres() -> impl Strategy<Value = Vec<Sphere>> {
    let sphere = ([-2.0f32..2.0, -2.0..2.0, -0.1..1.5], 0.01f32..0.4);
    let sphere = sphere.prop_map(|(center, radius)| fixtures::sphere(Vec3::from(center), radius));
    proptest::collection::vec(sphere, 1..24)
}

/// Spheres of radius 0 anywhere, and ones below the ground.
fn nothing() -> impl Strategy<Value = Vec<Sphere>> {
    let point = [-2.0f32..2.0, -2.0..2.0, 0.0..1.5].prop_map(|center| fixtures::sphere(Vec3::from(center), 0.0));
    let below = ([-2.0f32..2.0, -2.0..2.0], 0.01f32..3.0, 1.0f32..4.0);
    let below = below.prop_map(|([x, y], radius, depth)| fixtures::sphere(Vec3::new(x, y, -depth * radius), radius));
    proptest::collection::vec(prop_oneof![point, below], 1..12)
}

fn scene(spheres: Vec<Sphere>) -> Scene {
    let points = (0..35).map(|i| (Vec3::new(0.8 * (i % 7) as f32 - 2.4, 0.9 * (i / 7) as f32 - 1.8, 0.0), Vec3::Z));
    let sky = vec![Light::Sky(Sky::Overcast(Rgb::ONE))];
    let placement = Placement::Points(Arc::new(points.collect()));
    fixtures::scene("blockers", vec![fixtures::spheres("heap", spheres)], sky, placement)
}

fn radiance(method: &'static dyn Method, spheres: Vec<Sphere>, order: usize, rule: &str) -> Vec<f32> {
    let order = order.to_string();
    let settings = [("order", order.as_str()), ("self-shadow", rule)];
    let params = Params::resolve(method.info().params, settings).expect("in range");
    let scene = scene(spheres);
    let case = Case::new(method, &scene, Quantity::Direct).tuned(params);
    case.fresh(&case.frames[0]).expect("it runs")
}

fn methods(family: &str) -> Vec<&'static dyn Method> {
    let all = stress::sphere_blockers(halflight_registry::methods());
    all.into_iter().filter(|method| method.info().id.starts_with(family)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// Sums of logs are rounded differently, products of truncated visibilities are others.
    #[test]
    fn sums_do_not_depend_on_the_order_of_blockers(
        (spheres, shuffled) in spheres().prop_flat_map(|spheres| (Just(spheres.clone()), Just(spheres).prop_shuffle())),
        order in 2usize..=6,
    ) {
        for method in methods("shexp/") {
            let [one, other] = [&spheres, &shuffled].map(|spheres| radiance(method, spheres.clone(), order, "continuous"));
            let worst = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            prop_assert!(worst < 2e-4, "{}, order {order}: {worst}", method.info().id);
        }
    }

    /// Some at a time are added up, so that sums are rounded differently. The tree is that of all spheres: more of them pair others.
    #[test]
    fn spheres_that_block_nothing_change_nothing(
        spheres in spheres(),
        nothing in nothing(),
        order in 2usize..=6,
        rule in prop_oneof![Just("continuous"), Just("paper")],
    ) {
        let more: Vec<Sphere> = nothing.iter().chain(&spheres).chain(&nothing).copied().collect();
        for method in methods("").into_iter().filter(|method| method.info().id != "sh-product/tree") {
            let [one, other] = [&spheres, &more].map(|spheres| radiance(method, spheres.clone(), order, rule));
            let worst = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            prop_assert!(worst < 2e-4, "{}, order {order}, {rule}: {worst}", method.info().id);
        }
    }
}
