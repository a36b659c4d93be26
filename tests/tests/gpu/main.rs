//! Methods on the GPU against the same methods on the CPU. These tests fail where there is no adapter, one in software at least.
#![cfg(feature = "gpu")]

mod ambient;
mod blockers;
mod lesser;
mod wedges;

use std::collections::{BTreeMap, BTreeSet};

use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, Params};
use halflight_tests::checks::{self, Case};
use halflight_tests::fixtures;

/// A rounding of `f32`.
const ROUNDING: f32 = f32::EPSILON / 2.0;

/// The registered methods with a GPU backend.
fn methods() -> impl Iterator<Item = &'static dyn Method> {
    halflight_registry::methods().into_iter().filter(|method| method.info().runs_on(Backend::GPU))
}

fn on(backend: Backend, case: &Case<'_>) -> Vec<f32> {
    let case = Case { backend, ..case.asking(case.quantity) };
    case.fresh(&case.frames[0]).unwrap_or_else(|error| panic!("{} on {backend}: {error}", case.method.info().id))
}

fn with_order(method: &dyn Method, order: u8) -> Params {
    let text = order.to_string();
    Params::resolve(method.info().params, [("order", text.as_str())]).expect("in range")
}

/// At order 2 alone: a shader of order 8 takes a software adapter a minute to compile.
#[test]
fn the_contract_holds_on_the_gpu() {
    let scenes = fixtures::all();
    for method in methods() {
        let cases = scenes.iter().flat_map(|scene| Case::all(method, scene, Backend::GPU));
        let cases: Vec<_> = cases
            .map(|case| Case { fixed: &["order", "extra-bands"], ..case.tuned(with_order(method, 2)) })
            .filter(Case::is_supported)
            .collect();
        assert!(!cases.is_empty(), "{} runs no case", method.info().id);
        for (case, (_, check)) in cases.iter().flat_map(|case| checks::CHECKS.iter().map(move |check| (case, check))) {
            check(case).unwrap_or_else(|violation| panic!("{violation}"));
        }
    }
}

/// Passes by the device's clock, and the operations and bytes that are told of each.
#[derive(Debug, Default)]
struct Told {
    timed: BTreeSet<&'static str>,
    worked: BTreeMap<&'static str, [u64; 2]>,
}

impl Meter for Told {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
    fn gpu(&mut self, pass: &'static str, _: u64) {
        self.timed.insert(pass);
    }
    fn work(&mut self, pass: &'static str, operations: u64, bytes: u64) {
        let sum = self.worked.entry(pass).or_default();
        *sum = [sum[0] + operations, sum[1] + bytes];
    }
}

#[test]
fn each_pass_tells_what_it_did() {
    let scenes = fixtures::all();
    for method in methods() {
        let case = scenes.iter().flat_map(|scene| Case::all(method, scene, Backend::GPU)).find(Case::is_supported);
        let case = case.unwrap_or_else(|| panic!("{} runs no case", method.info().id)).tuned(with_order(method, 2));
        let (mut told, cache) = (Told::default(), Cache::in_memory());
        let job = Job::new(case.scene, &case.params, 1, Backend::GPU, &cache);
        let mut prepared = method.prepare(&job, &mut told).expect("is supported");
        prepared.update(&case.frames[0], &mut told).expect("updates");
        prepared.evaluate(&case.frames[0], case.quantity, &mut told).expect("shades");
        assert!(!told.timed.is_empty() && told.timed.iter().eq(told.worked.keys()), "{}: {told:?}", method.info().id);
        assert!(told.worked.values().flatten().all(|amount| *amount > 0), "{}: {told:?}", method.info().id);
    }
}
