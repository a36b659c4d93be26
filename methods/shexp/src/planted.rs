//! A wrong number in any of the shaders' files is seen; those that all sphere-blocker methods share are `sh-product`'s to plant in.

use halflight_blockers::{GpuDirectLight, source};
use halflight_contract::{Method, NoMeter, Params, Quantity};
use halflight_scenes::Scene;
use halflight_tests::checks::{Case, Fault, planted};
use halflight_tests::fixtures;

use crate::cpu::LogSum;
use crate::exponentials::{Exponential, HybridExp, LinearExp, PlainSeries, SeriesExp};

/// Plants faults in the shader of a variant.
fn check<E: Exponential>(method: &dyn Method, faults: &[Fault]) {
    check_on::<E>(method, &fixtures::two_lights(), &[("order", "2")], faults);
}

fn check_on<E: Exponential>(method: &dyn Method, scene: &Scene, settings: &[(&str, &str)], faults: &[Fault]) {
    let params = Params::resolve(E::PARAMS, settings.iter().copied()).expect("in range");
    let case = Case::new(method, scene, Quantity::Direct).tuned(params);
    let (right, wrong) = planted(&case, faults, |job, (text, fault)| {
        let text = Box::new(move |order, needs| {
            let whole = source::<LogSum<E>>(order, needs);
            assert!(whole.contains(text), "{text} is not in the shader");
            whole.replacen(text, fault, 1)
        });
        Ok(Box::new(GpuDirectLight::<LogSum<E>>::with_source(job, &mut NoMeter, text)?))
    });
    assert!(right < 1e-5, "{right:e} without a fault");
    assert!(wrong.iter().all(|distance| *distance > 5e-5), "{faults:?} change {wrong:?}");
}

#[test]
fn a_wrong_number_is_seen() {
    check::<HybridExp>(
        &crate::Hyb,
        &[
            ("(clamped - middle)", "(clamped - 1.1f * middle)"), // common.wgsl
            ("f[0] / SQRT_4_PI", "f[0] / 3.55f"),                // log_sum.wgsl
            ("given.squarings)", "given.squarings - 1)"),        // hyb.wgsl
            ("return value * square;", "return value * 1.01f * square;"), // bands.rs
        ],
    );
    let cuts = [("settings.ratios == 0u", "settings.ratios == 1u"), ("* factors[1]", "* factors[0]")];
    check_on::<HybridExp>(&crate::Hyb, &fixtures::heaps(), &[("order", "2"), ("cut", "40"), ("cluster", "16")], &cuts);
    let baked = [
        ("work.kept = baked[index].circles", "work.kept = 0u * baked[index].circles"),
        ("log_sum = sum;", "log_sum = scaled(1.01f, sum);"),
    ];
    check_on::<HybridExp>(&crate::Hyb, &fixtures::two_lights(), &[("order", "2"), ("bake", "true")], &baked);
    check::<LinearExp>(&crate::Ol, &[("1e-30f, 1e30f", "1e-30f, 0.1f")]);
    check::<PlainSeries>(&crate::Ps, &[("1f / f32(power)", "1.001f / f32(power)")]);
    check::<SeriesExp>(&crate::PsStar, &[("reciprocal = 1f", "reciprocal = 1.1f")]);
}
