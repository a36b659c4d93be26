//! A wrong number in any of the shaders' files is seen, and receivers that go part by part see the same as all at once. The pyramid's
//! files are planted in beside their own tests.

use halflight_contract::{Backend, Job, Method, NoMeter, Params, Quantity};
use halflight_tests::checks::{Case, Fault, planted};
use halflight_tests::fixtures;

use super::GpuTerrain;
use crate::PARTIAL;

fn order_two() -> Params {
    Params::resolve(PARTIAL.info().params, [("order", "2")]).expect("in range")
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
    let case = Case::new(&PARTIAL, &scene, Quantity::Direct).tuned(order_two());
    let (right, wrong) = planted(&case, FAULTS, |job, (text, fault)| {
        let edit = Box::new(move |whole: String| if text.is_empty() { whole } else { whole.replacen(text, fault, 1) });
        Ok(Box::new(GpuTerrain::prepare(&PARTIAL, job, &mut NoMeter, edit)?))
    });
    assert!(right < 2e-5, "{right:e} without a fault");
    assert!(wrong.iter().all(|distance| *distance > 1e-4), "{FAULTS:?} change {wrong:?}");
}

#[test]
fn parts_of_the_receivers_see_what_all_do() {
    let (scene, params) = (fixtures::hills(), order_two());
    let whole = Params::resolve(PARTIAL.info().params, [("order", "2"), ("swath", "360")]).expect("in range");
    for (params, quantity) in [(&params, Quantity::Direct), (&whole, Quantity::Visibility { order: 2 })] {
        let case = Case::new(&PARTIAL, &scene, quantity).tuned(params.clone());
        let [at_once, in_parts] = [u64::MAX, 8192].map(|binding| {
            let job = Job::new(&scene, params, 1, Backend::GPU, &case.cache);
            let mut terrain =
                GpuTerrain::prepare(&PARTIAL, &job, &mut NoMeter, Box::new(|text| text)).expect("prepares");
            terrain.binding = terrain.binding.min(binding);
            case.run(&mut terrain, &case.frames[0]).expect("runs")
        });
        assert_eq!(at_once, in_parts, "{quantity}");
    }
}
