//! Methods on the GPU against the same methods on the CPU. These tests fail where there is no adapter, one in software at least.
#![cfg(feature = "gpu")]

mod ambient;
mod blockers;
mod lesser;
mod wedges;

use halflight_contract::{Backend, Method, Params};
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
