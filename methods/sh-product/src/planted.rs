//! A wrong number in any of the texts that all sphere-blocker methods share is seen, and in this one's own.

use glam::Vec3;
use halflight_blockers::{GpuDirectLight, source};
use halflight_contract::{Method, NoMeter, Params, Quantity};
use halflight_scenes::{Emission, Object, Rgb, Scene};
use halflight_tests::checks::{Case, Fault, planted};
use halflight_tests::fixtures;

use crate::Ordered;
use crate::ordered::OrderedProduct;

/// Plants faults in the shader that a scene needs with these settings.
fn check(scene: &Scene, settings: &[(&str, &str)], faults: &[Fault]) {
    let params = Params::resolve(Ordered.info().params, settings.iter().copied()).expect("in range");
    let case = Case::new(&Ordered, scene, Quantity::Direct).tuned(params);
    let (right, wrong) = planted(&case, faults, |job, (text, fault)| {
        let text = Box::new(move |order, needs| {
            let whole = source::<OrderedProduct>(order, needs);
            assert!(whole.contains(text), "{text} is not in the shader");
            whole.replacen(text, fault, 1)
        });
        Ok(Box::new(GpuDirectLight::<OrderedProduct>::with_source(job, &mut NoMeter, text)?))
    });
    assert!(right < 1e-5, "{right:e} without a fault");
    assert!(wrong.iter().all(|distance| *distance > 1e-4), "{faults:?} change {wrong:?}");
}

#[test]
fn a_wrong_number_is_seen() {
    let faults = [
        ("t4 = 0.2820948f", "t4 = 0.283f"),                             // generated
        ("SQRT_4_PI: f32 = 3.5449077f", "SQRT_4_PI: f32 = 3.55f"),      // common.wgsl
        ("1.7724539f * (1f + p1)", "1.78f * (1f + p1)"),                // bands.rs
        ("channel < 3u", "channel < 2u"),                               // direct.wgsl
        ("0.5f * (height", "0.52f * (height"),                          // seen.wgsl
        ("vec2u(0u, settings.spheres)", "vec2u(1u, settings.spheres)"), // all_spheres.wgsl
        ("return vec3f();", "return vec3f(0.001f);"),                   // no_lamps.wgsl
        ("before == 0u", "before == 1u"),                               // ordered.wgsl
    ];
    check(&fixtures::overlapping_spheres(), &[("order", "2")], &faults);
}

/// A lamp half below the ground, so that receivers see the horizon cut it, behind a ball.
fn lamp() -> Scene {
    let lamp = fixtures::spheres("lamp", vec![fixtures::sphere(Vec3::new(1.1, 0.2, 0.05), 0.2)]);
    let mut scene = fixtures::two_lights();
    scene.objects.push(Object { emission: Emission::Even(Rgb::new(9.0, 6.0, 3.0)), ..lamp });
    scene
}

#[test]
fn a_wrong_number_is_seen_in_the_light_of_lamps() {
    let shares = [
        ("f32(l) * next)", "f32(l) * 1.1f * next)"), // common.wgsl
        ("2 * k + 1)", "2 * k + 2)"),                // lamps.wgsl
        ("square / 6f", "square / 5f"),              // shares.wgsl
    ];
    check(&lamp(), &[("order", "2")], &shares);
    let lobes = [("angle - 0.5f * PI", "angle - 0.51f * PI")];
    check(&lamp(), &[("order", "2"), ("lamps", "lobe")], &lobes);
}
