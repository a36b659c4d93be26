//! The checks pass what is whole and reject what is broken, each for its own reason.

use std::collections::BTreeSet;

use halflight_contract::{Method, Quantity};
use halflight_scenes::Scene;
use halflight_tests::checks::{self, Case, Verdict};
use halflight_tests::fixtures;
use halflight_tests::mocks::{Fault, Faulty, Grid, PAIRS, Resident};

fn broken(method: &dyn Method, scenes: &[Scene]) -> BTreeSet<&'static str> {
    checks::check_all(method, scenes).iter().map(|violation| violation.check).collect()
}

#[test]
fn honest_mocks_pass_and_each_twin_fails_the_check_meant_for_it_alone() {
    let scenes = fixtures::all();
    for pair in &PAIRS {
        assert_eq!(checks::check_all(pair.honest, &scenes), [], "{}", pair.honest.info().id);
        let id = pair.twin.info().id;
        assert_eq!(broken(pair.twin, &scenes), BTreeSet::from([pair.caught_by]), "{id}");
    }
}

#[test]
fn every_fault_is_rejected_by_the_check_meant_for_it() {
    let scenes = fixtures::all();
    for (fault, check) in Fault::ALL {
        let found = broken(&Faulty::new(fault), &scenes);
        assert!(found.contains(check), "{fault:?}: {check} is not among {found:?}");
    }
}

#[test]
fn every_check_has_something_that_it_must_reject() {
    let rejected = Fault::ALL.iter().map(|(_, check)| *check).chain(PAIRS.iter().map(|pair| pair.caught_by));
    let checks = checks::CHECKS.iter().map(|(name, _)| *name);
    assert_eq!(rejected.collect::<BTreeSet<_>>(), checks.collect());
}

#[test]
fn a_check_that_does_not_apply_says_so() {
    let scene = fixtures::moving_sphere();
    let on_grid = checks::permuted_receivers(&Case::new(&Grid::HONEST, &scene, Quantity::Direct));
    assert!(matches!(on_grid, Ok(Verdict::Exempt(_))), "{on_grid:?}");
    let without_progress = checks::cancellation(&Case::new(&Resident::HONEST, &scene, Quantity::Direct));
    assert!(matches!(without_progress, Ok(Verdict::Exempt(_))), "{without_progress:?}");
}

#[test]
fn a_method_that_supports_nothing_does_not_pass() {
    assert_eq!(broken(&Resident::HONEST, &[]), BTreeSet::from(["check_all"]));
}

/// Where every result is zero, few checks could fail.
#[test]
fn fixtures_have_light_and_shadow() {
    for scene in fixtures::all() {
        let case = Case::new(&Resident::HONEST, &scene, Quantity::Direct);
        let results = case.fresh(&case.frames[0]).expect("the mock runs");
        let (least, most) = results.iter().fold((f32::MAX, 0f32), |(least, most), v| (least.min(*v), most.max(*v)));
        assert!(most > 0.1 && least < 0.8 * most, "{}: from {least} to {most}", scene.name);
    }
}
