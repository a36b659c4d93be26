//! The scenes of Ren et al. 2006: characters, an environment, two lamps, cuts.

use std::time::Instant;

use halflight_contract::Quantity;
use halflight_scenes::find;
use halflight_tests::checks::Case;

use super::{Seen, apart, tolerance, tuned};
use crate::ROUNDING;

/// How far the backends may be apart under light of about 1: receivers on characters touch their spheres, whose sines near 1 lose half their
/// digits, on each backend others.
fn check(scene: &str, settings: &str) {
    let scene = find(scene).expect("it is shipped");
    let method = halflight_registry::find("shexp/hyb").expect("it is registered");
    let case = Case::new(method, &scene, Quantity::Direct).tuned(tuned(method, settings));
    let touched = Seen { circles: 512, blur: 2.0 * (8.0 * ROUNDING).sqrt() };
    let allowed = tolerance(case.params.int("order") as u8, touched);
    let begin = Instant::now();
    let largest = apart(&case);
    let receivers = case.frames[0].receivers.len();
    let (name, time) = (&scene.name, begin.elapsed());
    println!("{name}, {settings}: {receivers} receivers, {largest:.1e} apart, {allowed:.1e} allowed, {time:.0?}");
    assert!(largest <= allowed, "{name}, {settings}: {largest:e} > {allowed:e}");
}

#[test]
fn a_small_battle_is_the_same_on_both() {
    check("battle@0.05", "order=2 spheres=8 cut=20 cluster=16");
}

#[test]
#[ignore = "minutes in software"]
fn battle_and_herd_are_the_same_on_both_at_their_true_sizes() {
    for settings in ["spheres=61", "spheres=61 cut=20", "spheres=61 cut=20 lamps=lobe"] {
        check("battle@1.238", settings);
    }
    for settings in ["", "cut=20"] {
        check("herd@1.11", settings);
    }
}
