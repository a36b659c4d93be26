//! Every registered method keeps the contract.

use halflight_contract::{Backend, Params, Quantity};
use halflight_tests::checks::{self, Case};
use halflight_tests::fixtures;

#[test]
fn every_registered_method_keeps_the_contract() {
    let scenes = fixtures::all();
    let methods = halflight_registry::methods();
    assert!(!methods.is_empty());
    let violations: Vec<_> = methods.into_iter().flat_map(|method| checks::check_all(method, &scenes)).collect();
    let lines: Vec<String> = violations.iter().map(|violation| violation.to_string()).collect();
    assert!(lines.is_empty(), "{}", lines.join("\n"));
}

/// Receivers that share cuts, few of them and many, and blockers that are kept where they stay; alone and together.
#[test]
fn methods_with_cuts_and_bakes_keep_the_contract() {
    let scenes = [fixtures::heaps(), fixtures::moving_sphere(), fixtures::stress()];
    let cut = [("cut", "30"), ("cluster", "16")];
    let (coarse, bake) = ([("cut", "30"), ("cluster", "256")], [("bake", "true")]);
    let both = [("cut", "30"), ("cluster", "16"), ("bake", "true")];
    let mut violations = Vec::new();
    for (id, settings) in
        [("shexp/hyb", &cut[..]), ("shexp/hyb", &coarse), ("shexp/hyb", &both), ("sh-product/ordered", &bake)]
    {
        let method = halflight_registry::find(id).expect("it is registered");
        let params = Params::resolve(method.info().params, settings.iter().copied()).expect("they are its parameters");
        for case in scenes.iter().flat_map(|scene| Case::all(method, scene, Backend::Cpu)) {
            let case = case.tuned(params.clone());
            violations.extend(checks::CHECKS.iter().filter_map(|(_, check)| check(&case).err()));
        }
    }
    let lines: Vec<String> = violations.iter().map(|violation| violation.to_string()).collect();
    assert!(lines.is_empty(), "{}", lines.join("\n"));
}

/// What is derived from a mesh takes long, so one method stands for all that share it, with one sphere.
#[test]
fn derived_data_of_meshes_keeps_the_contract() {
    let scene = fixtures::mesh_in_two_lights();
    let method = halflight_registry::find("sh-product/ordered").expect("it is registered");
    let params = Params::resolve(method.info().params, [("spheres", "1")]).expect("it is its parameter");
    let case = Case::new(method, &scene, Quantity::Direct).tuned(params);
    for check in [checks::shared_derived_data, checks::cancellation] {
        check(&case).unwrap_or_else(|violation| panic!("{violation}"));
    }
}
