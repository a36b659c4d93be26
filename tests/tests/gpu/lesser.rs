//! Methods on adapters that this machine does not have: of small bindings, without a clock, lost under way. Each is opened under a number
//! of its own.

use std::collections::BTreeMap;
use std::sync::Arc;

use halflight_contract::{Backend, Error, Flow, Meter, Method, NoMeter, Params, Quantity};
use halflight_gpu::{Adapter, Gpu, adapters};
use halflight_scenes::{Placement, Scene};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

/// A lesser device, for those who ask for its number.
fn lesser(number: u8, change: impl FnOnce(&mut Adapter)) -> Backend {
    let mut adapter = adapters().next().expect("tests of the GPU need an adapter").clone();
    change(&mut adapter);
    let backend = Backend::Gpu(number);
    Gpu::open_as(0, adapter).expect("less can be had").share(backend);
    backend
}

/// Methods that are compared, with settings under which what receivers share fits into 4096 bytes.
fn cases(scene: &Scene) -> Vec<Case<'_>> {
    let settings = [
        ("sh-product/ordered", vec![("order", "2")]),
        ("shexp/hyb", vec![("order", "2")]),
        ("ambient-occlusion/elements", vec![("order", "2"), ("elements", "16")]),
    ];
    let case = |(id, settings): (&str, Vec<(&str, &str)>)| {
        let method: &dyn Method = halflight_registry::find(id).expect("is registered");
        let params = Params::resolve(method.info().params, settings).expect("in range");
        Case { backend: Backend::GPU, ..Case::new(method, scene, Quantity::Direct).tuned(params) }
    };
    settings.into_iter().map(case).collect()
}

/// How often each pass was timed by the device, and the spans.
#[derive(Default)]
struct Passes {
    timed: BTreeMap<&'static str, usize>,
    spans: Vec<&'static str>,
}

impl Meter for Passes {
    fn begin(&mut self, span: &'static str) {
        self.spans.push(span);
    }
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
    fn gpu(&mut self, pass: &'static str, _: u64) {
        *self.timed.entry(pass).or_default() += 1;
    }
}

/// A frame's result on a backend, and its passes.
fn on(backend: Backend, case: &Case<'_>) -> (Vec<f32>, Passes) {
    let (case, mut passes) = (Case { backend, ..case.asking(case.quantity) }, Passes::default());
    let mut prepared = case.prepare(&case.cache, &mut NoMeter).expect("is supported");
    prepared.update(&case.frames[0], &mut NoMeter).expect("updates");
    prepared.evaluate(&case.frames[0], case.quantity, &mut passes).expect("shades");
    (case.read(&mut *prepared, &case.frames[0], 0.0).expect("reads"), passes)
}

#[test]
fn receivers_go_in_parts_where_a_binding_does_not_hold_them() {
    let meagre = lesser(200, |adapter| adapter.max_binding = 4096);
    let scene = fixtures::heaps();
    let receivers = scene.frame(0).receivers.valid.iter().filter(|valid| **valid).count();
    for case in cases(&scene) {
        let [(whole, once), (parts, often)] = [Backend::GPU, meagre].map(|backend| on(backend, &case));
        let id = case.method.info().id;
        assert_eq!(whole, parts, "{id}: parts change the result");
        assert_eq!(once.timed.values().collect::<Vec<_>>(), [&1], "{id}");
        assert_eq!(often.timed.values().collect::<Vec<_>>(), [&receivers.div_ceil(64)], "{id}");
    }
}

#[test]
fn without_a_clock_results_are_the_same_and_spans_tell_the_time() {
    let timeless = lesser(201, |adapter| adapter.timestamps = false);
    let scene = fixtures::two_lights();
    for case in cases(&scene) {
        let [(timed, clocked), (spanned, passes)] = [Backend::GPU, timeless].map(|backend| on(backend, &case));
        assert_eq!(timed, spanned, "{}", case.method.info().id);
        assert!(passes.timed.is_empty());
        assert!(clocked.timed.keys().all(|pass| passes.spans.contains(pass)), "{:?}", passes.spans);
    }
}

/// The cell at hand fails and names the adapter; the next one runs on a new device.
#[test]
fn a_device_lost_under_way_fails_one_cell() {
    let backend = lesser(202, |_| ());
    let scene = fixtures::two_lights();
    for case in cases(&scene) {
        let (id, frame) = (case.method.info().id, &case.frames[0]);
        let (finished, _) = on(backend, &case);
        let case = Case { backend, ..case.asking(case.quantity) };
        let mut prepared = case.prepare(&case.cache, &mut NoMeter).expect("is supported");
        prepared.update(frame, &mut NoMeter).expect("updates");
        let lost = Gpu::shared(backend).expect("is open");
        lost.give_up();
        for _ in 0..2 {
            let error = prepared.evaluate(frame, case.quantity, &mut NoMeter).expect_err("the device is gone");
            let Error::Device(said) = error else { panic!("{id}: {error}") };
            assert!(said.contains(&lost.adapter().name) && said.contains("lost"), "{id}: {said}");
        }
        assert_eq!(finished, on(backend, &case).0, "{id}");
        assert!(!Arc::ptr_eq(&lost, &Gpu::shared(backend).expect("is open")));
    }
}

#[test]
fn no_receivers_are_shaded() {
    let scene = Scene { placement: Placement::Points(Arc::new(Vec::new())), ..fixtures::two_lights() };
    for case in cases(&scene) {
        let (result, passes) = on(Backend::GPU, &case);
        assert!(result.is_empty() && passes.timed.is_empty(), "{}", case.method.info().id);
    }
}

/// More than a binding of lavapipe's 128 MiB holds. Takes lavapipe on two cores some seconds each: `--ignored` runs it.
#[test]
fn four_million_receivers_are_shaded() {
    let point = |i: usize| (glam::Vec3::new((i % 2000) as f32, (i / 2000) as f32, 0.0) / 500.0 - 2.0, glam::Vec3::Z);
    let points = (0..4_000_000).map(point).map(|(at, normal)| (at.with_z(0.0), normal)).collect();
    let scene = Scene { placement: Placement::Points(Arc::new(points)), ..fixtures::two_lights() };
    for case in cases(&scene) {
        let start = std::time::Instant::now();
        let (gpu, passes) = on(Backend::GPU, &case);
        let there = start.elapsed();
        let (cpu, _) = on(Backend::Cpu, &case);
        let largest = cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
        let id = case.method.info().id;
        println!("{id}: {there:?} there, {:?} in all, {largest:.1e} apart, {:?}", start.elapsed(), passes.timed);
        assert!(largest < 1e-3, "{id}: {largest:e}");
        assert!(passes.timed.values().all(|parts| *parts > 1), "{id}: {:?}", passes.timed);
    }
}
