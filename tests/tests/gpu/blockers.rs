//! Methods on sphere blockers: a thread a receiver.

mod baked;
mod cuts;
mod lamps;
mod papers;
mod stress;

use std::f32::consts::PI;

use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, NoMeter, Params, Quantity, Request, Support};
use halflight_proxies::{SelfShadow, seen};
use halflight_scenes::{Scene, Shape, Sphere};
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
/// A sine near 1 loses half its digits on its way to a cosine, by which band l changes √(π(2l+1)) times: that is what `blur` is about.
fn tolerance(order: u8, Seen { circles, blur }: Seen) -> f32 {
    let roundings = 2.0 * 4.0 * f32::from(order) * (circles + 21) as f32;
    let norm = (4.0 * PI).sqrt();
    4.0 * roundings.sqrt() * ROUNDING * norm + (PI * f32::from(2 * order - 1)).sqrt() * blur
}

/// What there is to be seen at the receivers of a scene.
#[derive(Clone, Copy)]
struct Seen {
    /// Spheres.
    circles: usize,
    /// The most that 4 roundings of each sine change the cosines of a receiver's circles, each by `4u/cos θ` and no more than `√8u`: in
    /// sum, or where there are many as independent changes add up.
    blur: f32,
}

impl Seen {
    fn of(scene: &Scene) -> Self {
        let frame = scene.frame(0);
        let casting = frame.objects.iter().filter(|object| scene.objects[object.object].casts);
        let spheres: Vec<Sphere> = casting
            .filter_map(|object| match &*object.in_place() {
                Shape::Spheres(spheres) => Some(spheres.clone()),
                _ => None,
            })
            .flatten()
            .collect();
        let receivers = &frame.receivers;
        let blur = |receiver: usize| {
            let (position, normal) = (receivers.position[receiver], receivers.geometric_normal[receiver]);
            let circles = spheres.iter().filter_map(|s| seen(SelfShadow::Continuous, position, normal, s));
            let each = circles.map(|circle| (4.0 * ROUNDING / circle.cos_angle()).min((8.0 * ROUNDING).sqrt()));
            let (sum, squares) = each.fold((0.0f32, 0.0), |(sum, squares), one| (sum + one, squares + one * one));
            sum.min(4.0 * squares.sqrt())
        };
        Seen { circles: spheres.len(), blur: (0..receivers.len()).map(blur).fold(0.0, f32::max) }
    }
}

/// The largest difference between the backends.
fn apart(case: &Case<'_>) -> f32 {
    let [cpu, gpu] = [Backend::Cpu, Backend::GPU].map(|backend| on(backend, case));
    cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Parameters by their text, `name=value` each.
fn tuned(method: &dyn Method, settings: &str) -> Params {
    let settings = settings.split(' ').filter_map(|setting| setting.split_once('='));
    Params::resolve(method.info().params, settings).expect("in range")
}

#[test]
fn bands_beyond_the_order_are_dropped_before_shading() {
    let scene = fixtures::two_lights();
    let seen = Seen::of(&scene);
    for method in methods() {
        let case = Case::new(method, &scene, Quantity::Direct).tuned(tuned(method, "order=1 extra-bands=1"));
        let largest = apart(&case);
        assert!(largest <= tolerance(2, seen), "{}: {largest:e}", method.info().id);
    }
}

/// Whether a method's own terms cancel by more than roundings can tell: PS-p adds up powers of a sum of logs with changing signs, as large as
/// the exponential of its norm, which grows with the order and with circles over each other.
fn cancels(method: &dyn Method, order: u8, seen: Seen) -> bool {
    method.info().id == "shexp/ps" && order > 4 && seen.circles > 10
}

/// Fails where the backends are further apart than roundings bring them.
fn agree(method: &dyn Method, orders: &[u8]) {
    let scenes = [fixtures::sphere_over_plane(), fixtures::overlapping_spheres(), fixtures::two_lights()];
    for (scene, &order) in scenes.iter().flat_map(|scene| orders.iter().map(move |order| (scene, order))) {
        let seen = Seen::of(scene);
        if cancels(method, order, seen) {
            continue;
        }
        let tolerance = tolerance(order, seen);
        for quantity in [Quantity::Direct, Quantity::Visibility { order }] {
            let largest = apart(&Case::new(method, scene, quantity).tuned(with_order(method, order)));
            let (id, name) = (method.info().id, &scene.name);
            println!("{id} on {name}, {quantity}, order {order}: {largest:.1e} apart, {tolerance:.1e} allowed");
            assert!(largest <= tolerance, "{id} on {name}, {quantity}, order {order}: {largest:e} > {tolerance:e}");
        }
    }
}

#[test]
fn both_backends_agree_to_rounding() {
    methods().for_each(|method| agree(method, orders(method)));
}

#[test]
#[ignore = "a software adapter compiles a shader of order 8 for a minute"]
fn both_backends_agree_at_every_order() {
    methods().for_each(|method| agree(method, &[1, 2, 3, 4, 5, 6, 7, 8]));
}

/// What a method counts.
#[derive(Debug, Default, PartialEq)]
struct Counted(std::collections::BTreeMap<&'static str, u64>);

impl Counted {
    /// A frame's counts.
    fn of(backend: Backend, method: &dyn Method, scene: &Scene, params: &Params) -> Self {
        let (mut counted, cache, frame) = (Counted::default(), Cache::in_memory(), scene.frame(0));
        let job = Job::new(scene, params, 1, backend, &cache);
        let mut prepared = method.prepare(&job, &mut counted).expect("is supported");
        prepared.update(&frame, &mut counted).expect("updates");
        prepared.evaluate(&frame, Quantity::Direct, &mut counted).expect("shades");
        counted
    }

    /// Without bytes, and squares as products: a square may be computed as one.
    fn work(mut self) -> Self {
        let squares = self.0.remove("squares").unwrap_or(0);
        *self.0.entry("products").or_default() += squares;
        self.0.retain(|counter, amount| !counter.starts_with("bytes") && *amount > 0);
        self
    }
}

impl Meter for Counted {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        *self.0.entry(counter).or_default() += amount;
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

/// Fails where the backends do not count the same work, and returns what they counted.
fn count_alike(method: &dyn Method, scene: &Scene, params: &Params) -> Counted {
    let [cpu, gpu] = [Backend::Cpu, Backend::GPU].map(|backend| Counted::of(backend, method, scene, params).work());
    assert_eq!(cpu, gpu, "{} on {}", method.info().id, scene.name);
    cpu
}

#[test]
fn both_backends_count_the_same_work() {
    for method in methods() {
        for scene in [fixtures::overlapping_spheres(), fixtures::two_lights()] {
            let counted = count_alike(method, &scene, &Params::defaults(method.info().params));
            assert!(counted.0["blockers accumulated"] > 0);
        }
    }
}

#[test]
fn only_what_changed_is_uploaded() {
    let scene = fixtures::moving_sphere();
    for method in methods() {
        let (params, cache) = (Params::defaults(method.info().params), Cache::in_memory());
        let job = Job::new(&scene, &params, 1, Backend::GPU, &cache);
        let mut prepared = method.prepare(&job, &mut NoMeter).expect("is supported");
        let uploaded = [0, 0, 1].map(|frame| {
            let mut counted = Counted::default();
            prepared.update(&scene.frame(frame), &mut counted).expect("updates");
            counted.0.get("bytes uploaded").copied().unwrap_or(0)
        });
        // Receivers of 64 bytes and spheres of 16, nothing, spheres.
        assert_eq!(uploaded, [64 * 72 + 2 * 16, 0, 2 * 16], "{}", method.info().id);
    }
}

#[test]
fn what_the_gpu_does_not_do_is_skipped_with_a_reason() {
    let lamp = fixtures::moving_lamp();
    let families = ["sh-product", "shexp"];
    let mut skipped = 0;
    for method in halflight_registry::methods().into_iter().filter(|m| families.contains(&m.info().family())) {
        let params = Params::defaults(method.info().params);
        let request = Request { quantity: Quantity::Direct, backend: Backend::GPU, params: &params };
        if let Support::Skip(why) = method.supports(&lamp.facts(), &request) {
            assert!(why.contains("GPU"), "{why}");
            skipped += 1;
        } else {
            assert!(method.info().runs_on(Backend::GPU), "{}", method.info().id);
        }
    }
    assert_eq!(skipped, 3);
}
