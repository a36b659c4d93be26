//! A wrong number in any of the shaders' files is seen, and what a lesser device does. The pyramid's files are planted in beside their own
//! tests.

use std::path::Path;

use halflight_contract::{Backend, Method, NoMeter, Params, Quantity};
use halflight_gpu::{Adapter, Gpu, adapters};
use halflight_scenes::Scene;
use halflight_tests::checks::{Case, Fault, planted};
use halflight_tests::fixtures;

use super::GpuTerrain;
use crate::{COMPLETE, PARTIAL, Variant};

fn order_two(method: &Variant) -> Params {
    Params::resolve(method.info().params, [("order", "2")]).expect("in range")
}

#[test]
fn a_wrong_number_is_seen() {
    const FAULTS: &[Fault] = &[
        ("first: u32,\n    wedges: u32", "wedges: u32,\n    first: u32"), // view.wgsl
        ("f32(place < l) - f32", "0.9f * f32(place < l) - f32"),          // wedges.wgsl
        ("fma(high - low", "fma(0.99f * high - low"),
        ("ELEVATIONS * ELEVATIONS + start.entry", "ELEVATIONS * ELEVATIONS + start.entry + 1u"),
        ("fma(receiver.albedo[channel]", "fma(0.999f * receiver.albedo[channel]"), // shade.wgsl
    ];
    let scene = fixtures::hills();
    let case = Case::new(&PARTIAL, &scene, Quantity::Direct).tuned(order_two(&PARTIAL));
    let (right, wrong) = planted(&case, FAULTS, |job, (text, fault)| {
        let edit = Box::new(move |whole: String| if text.is_empty() { whole } else { whole.replacen(text, fault, 1) });
        Ok(Box::new(GpuTerrain::prepare(&PARTIAL, job, &mut NoMeter, edit)?))
    });
    assert!(right < 2e-5, "{right:e} without a fault");
    assert!(wrong.iter().all(|distance| *distance > 1e-4), "{FAULTS:?} change {wrong:?}");
}

/// Hills of so many vertices under an overcast sky.
fn hills(resolution: &str) -> Scene {
    let text = format!(
        "purpose = 'test'\n[receivers]\nheights = {{ object = 'field' }}\n[[objects]]\nname = 'field'\nalbedo = [1, 1, 1]\n\
         [objects.heights]\nresolution = {resolution}\ncell = [1, 1]\n\
         fractal = {{ seed = 3, amplitude = 6, wavelength = 20, octaves = 3 }}\n[[lights]]\nsky = {{ overcast = [1, 1, 1] }}\n"
    );
    Scene::parse(Path::new("hills.toml"), &text).expect("a scene")
}

/// A device whose bindings hold the tables of order 2, and little more.
fn lesser() -> Backend {
    const LESSER: Backend = Backend::Gpu(77);
    let adapter = adapters().next().expect("an adapter").clone();
    Gpu::open_as(0, Adapter { max_binding: 1_100_000, ..adapter }).expect("opens").share(LESSER);
    LESSER
}

#[test]
fn parts_of_the_receivers_see_what_all_do() {
    let (scene, lesser) = (hills("[80, 70]"), lesser());
    let settings = [("order", "2"), ("azimuths", "64")];
    let params = Params::resolve(COMPLETE.info().params, settings).expect("in range");
    for quantity in [Quantity::Direct, Quantity::Visibility { order: 2 }] {
        let case = Case::new(&COMPLETE, &scene, quantity).tuned(params.clone());
        let [at_once, in_parts] = [Backend::GPU, lesser].map(|backend| {
            let case = Case { backend, ..case.asking(quantity) };
            case.fresh(&case.frames[0]).expect("runs")
        });
        assert_eq!(at_once, in_parts, "{quantity}");
    }
}

#[test]
fn levels_that_no_binding_holds_are_one_clear_error() {
    let (scene, lesser) = (hills("[300, 200]"), lesser());
    let case = Case::new(&COMPLETE, &scene, Quantity::Direct).tuned(order_two(&COMPLETE));
    let case = Case { backend: lesser, ..case };
    let error = case.fresh(&case.frames[0]).unwrap_err().to_string();
    assert!(error.contains("levels brought back takes 2464200 bytes, at most 1100000"), "{error}");
}
