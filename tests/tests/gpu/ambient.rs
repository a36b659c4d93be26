//! Ambient occlusion: a thread a receiver, walking the forest that the cores walk. Held against walks in f64 in the method's own tests.

use std::collections::BTreeMap;

use halflight_contract::{Backend, Flow, Job, Meter, Method, NoMeter, Params, Quantity};
use halflight_light::LightOf;
use halflight_scenes::Scene;
use halflight_sh::clamped_cosine;
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

use crate::{ROUNDING, with_order};

fn method() -> &'static dyn Method {
    halflight_registry::find("ambient-occlusion/elements").expect("is registered")
}

/// What a method counts but for bytes.
#[derive(Debug, Default, PartialEq)]
struct Counted(BTreeMap<&'static str, u64>);

impl Meter for Counted {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        if !counter.starts_with("bytes") {
            *self.0.entry(counter).or_default() += amount;
        }
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

/// A frame's result, and what was counted.
fn counted(case: &Case<'_>) -> (Vec<f32>, Counted) {
    let mut counted = Counted::default();
    let mut prepared = case.prepare(&case.cache, &mut counted).expect("is supported");
    prepared.update(&case.frames[0], &mut counted).expect("updates");
    prepared.evaluate(&case.frames[0], case.quantity, &mut counted).expect("shades");
    (case.read(&mut *prepared, &case.frames[0], 0.0).expect("reads"), counted)
}

/// How far two backends may be apart in radiance.
///
/// Roundings are as good as independent (Higham and Mary 2019). On each backend a term of at most 1 costs 81 of them, two roots and two
/// quotients counted as WGSL allows them to err; there are no more terms than elements. Irradiance costs 6 a coefficient, each of at
/// most the lengths of light and cosine multiplied.
fn tolerance(scene: &Scene, params: &Params, order: u8, elements: u64) -> f32 {
    let cache = halflight_contract::Cache::in_memory();
    let job = Job::new(scene, params, 1, Backend::Cpu, &cache);
    let light = job.derive(&LightOf { order: order.into() }, &mut NoMeter).expect("is in memory");
    let length = |vector: &[f32]| vector.iter().map(|value| value * value).sum::<f32>().sqrt();
    let brightest = light.still.rgb.iter().map(|channel| length(channel)).fold(0.0, f32::max);
    let cosine = clamped_cosine(order.into()).iter().map(|value| value * value).sum::<f64>().sqrt() as f32;
    let roundings = 2.0 * (81.0 * elements as f32 + 6.0 * f32::from(order * order));
    4.0 * roundings.sqrt() * ROUNDING * brightest * cosine
}

fn compare(scene: &Scene, order: u8) {
    let params = with_order(method(), order);
    let case = |backend| Case { backend, ..Case::new(method(), scene, Quantity::Direct).tuned(params.clone()) };
    let [(cpu, on_cores), (gpu, there)] = [Backend::Cpu, Backend::GPU].map(|backend| counted(&case(backend)));
    let largest = cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
    let tolerance = tolerance(scene, &params, order, on_cores.0["elements"]);
    println!("{}, order {order}: {largest:.1e} apart, {tolerance:.1e} allowed", scene.name);
    assert!(largest <= tolerance, "{}, order {order}: {largest:e} > {tolerance:e}", scene.name);
    // A fused square may open a group or not, where it is within a rounding.
    let fused = if halflight_gpu::adapters().all(|adapter| adapter.is_software()) { 0.0 } else { 1e-5 };
    for (counter, amount) in &on_cores.0 {
        let found = there.0.get(counter).copied().unwrap_or(0);
        let name = &scene.name;
        assert!(found.abs_diff(*amount) as f64 <= fused * *amount as f64, "{name}: {counter} {found} for {amount}");
    }
    assert_eq!(on_cores.0.len(), there.0.len(), "{on_cores:?} and {there:?}");
}

#[test]
fn both_backends_agree_to_rounding_and_count_the_same() {
    for scene in fixtures::all() {
        compare(&scene, 3);
    }
    for order in [1, 2, 4, 5, 6, 7, 8] {
        compare(&fixtures::mesh_in_two_lights(), order);
    }
}
