//! Methods on sphere blockers: a thread a receiver.

use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, Params, Quantity, Request, Support};
use halflight_proxies::{SelfShadow, seen};
use halflight_scenes::{Scene, Shape};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

use crate::{ROUNDING, on, with_order};

/// The methods on sphere blockers with a GPU backend.
fn methods() -> impl Iterator<Item = &'static dyn Method> {
    crate::methods().filter(|method| ["sh-product", "shexp"].contains(&method.info().family()))
}

/// The orders that are compared: each form of the product once, and each shader at an order of its own at least.
fn orders(method: &dyn Method) -> &'static [u8] {
    match method.info().id {
        "sh-product/ordered" => &[1, 2, 3, 4, 6],
        "shexp/hyb" => &[2, 4],
        _ => &[3],
    }
}

/// How far two backends may be apart in a coefficient of visibility.
///
/// Roundings are as good as independent (Higham and Mary 2019), so that N of them, each of at most u of the vector's norm, add up to
/// more than 4√N·u with a probability of 1e-4. On each backend a circle costs about 4n of them one after another: n for its zonal
/// coefficients and turning them, 3n for the three sums of a product of rings; an exponential costs a product for each squaring or
/// power, at most 21. Each squaring doubles a relative error, but was scaled down before as often.
///
/// A sine near 1 loses half its digits on its way to a cosine: 4 roundings of it change the cosine by 4u/cos θ.
fn tolerance(order: u8, circles: usize, least_cosine: f32) -> f32 {
    let roundings = 2.0 * 4.0 * f32::from(order) * (circles + 21) as f32;
    let norm = (4.0 * std::f32::consts::PI).sqrt();
    4.0 * roundings.sqrt() * ROUNDING * norm + circles as f32 * 4.0 * ROUNDING / least_cosine
}

/// The number of spheres of a scene, and the least cosine of the circles that receivers see.
fn circles(scene: &Scene) -> (usize, f32) {
    let (frame, mut count, mut least) = (scene.frame(0), 0, 1.0f32);
    let receivers = &frame.receivers;
    for object in frame.objects.iter().filter(|object| scene.objects[object.object].casts) {
        let Shape::Spheres(spheres) = &*object.in_place() else { continue };
        count += spheres.len();
        for receiver in 0..receivers.len() {
            let (position, normal) = (receivers.position[receiver], receivers.geometric_normal[receiver]);
            let circles = spheres.iter().filter_map(|s| seen(SelfShadow::Continuous, position, normal, s));
            least = circles.map(|circle| circle.cos_angle()).fold(least, f32::min);
        }
    }
    (count, least)
}

#[test]
fn bands_beyond_the_order_are_dropped_before_shading() {
    let scene = fixtures::two_lights();
    let (circles, least) = circles(&scene);
    for method in methods() {
        let params = Params::resolve(method.info().params, [("order", "1"), ("extra-bands", "1")]).expect("in range");
        let case = Case::new(method, &scene, Quantity::Direct).tuned(params);
        let [cpu, gpu] = [Backend::Cpu, Backend::GPU].map(|backend| on(backend, &case));
        let largest = cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
        assert!(largest <= tolerance(2, circles, least), "{}: {largest:e}", method.info().id);
    }
}

#[test]
fn both_backends_agree_to_rounding() {
    let scenes = [fixtures::sphere_over_plane(), fixtures::overlapping_spheres(), fixtures::two_lights()];
    for method in methods() {
        for (scene, &order) in scenes.iter().flat_map(|scene| orders(method).iter().map(move |order| (scene, order))) {
            let (circles, least) = circles(scene);
            let tolerance = tolerance(order, circles, least);
            for quantity in [Quantity::Direct, Quantity::Visibility { order }] {
                let case = Case::new(method, scene, quantity).tuned(with_order(method, order));
                let [cpu, gpu] = [Backend::Cpu, Backend::GPU].map(|backend| on(backend, &case));
                let largest = cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
                let (id, name) = (method.info().id, &scene.name);
                println!("{id} on {name}, {quantity}, order {order}: {largest:.1e} apart, {tolerance:.1e} allowed");
                assert!(largest <= tolerance, "{id} on {name}, {quantity}, order {order}: {largest:e} > {tolerance:e}");
            }
        }
    }
}

/// What a method counts.
#[derive(Debug, Default, PartialEq)]
struct Counted(std::collections::BTreeMap<&'static str, u64>);

impl Meter for Counted {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        // A square may be computed as a product.
        let counter = if counter == "squares" { "products" } else { counter };
        if !counter.starts_with("bytes") {
            *self.0.entry(counter).or_default() += amount;
        }
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

#[test]
fn both_backends_count_the_same_work() {
    for (method, scene) in methods()
        .flat_map(|method| [fixtures::overlapping_spheres(), fixtures::two_lights()].map(|scene| (method, scene)))
    {
        let (params, cache, frame) = (Params::defaults(method.info().params), Cache::in_memory(), scene.frame(0));
        let [cpu, gpu] = [Backend::Cpu, Backend::GPU].map(|backend| {
            let mut counted = Counted::default();
            let job = Job::new(&scene, &params, 1, backend, &cache);
            let mut prepared = method.prepare(&job, &mut counted).expect("is supported");
            prepared.update(&frame, &mut counted).expect("updates");
            prepared.evaluate(&frame, Quantity::Direct, &mut counted).expect("shades");
            counted
        });
        assert_eq!(cpu, gpu, "{} on {}", method.info().id, scene.name);
        assert!(cpu.0["blockers accumulated"] > 0);
    }
}

#[test]
fn what_the_gpu_does_not_do_is_skipped_with_a_reason() {
    let lamp = fixtures::moving_lamp();
    for method in halflight_registry::methods() {
        let params = Params::defaults(method.info().params);
        let request = Request { quantity: Quantity::Direct, backend: Backend::GPU, params: &params };
        if method.info().family() == "sh-product" || method.info().family() == "shexp" {
            let answer = method.supports(&lamp.facts(), &request);
            let Support::Skip(why) = answer else { panic!("{}: {answer:?}", method.info().id) };
            assert!(why.contains("GPU") || why.contains("CPU"), "{why}");
        }
    }
}
