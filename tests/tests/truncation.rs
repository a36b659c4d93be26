//! Blockers accumulated in more bands than are shaded with.

use halflight_contract::{Params, Quantity};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

#[test]
fn extra_bands_leave_the_first_ones_of_a_higher_order() {
    let scene = fixtures::overlapping_spheres();
    let with = |method: &dyn halflight_contract::Method| method.info().params.iter().any(|p| p.name == "extra-bands");
    let mut tried = 0;
    for method in halflight_registry::methods().into_iter().filter(|method| with(*method)) {
        let visibility = |order: u8, settings: [(&str, &str); 2]| {
            let params = Params::resolve(method.info().params, settings).expect("in range");
            let case = Case::new(method, &scene, Quantity::Visibility { order }).tuned(params);
            case.fresh(&case.frames[0]).expect("it runs")
        };
        let kept = visibility(3, [("order", "3"), ("extra-bands", "2")]);
        let high = visibility(3, [("order", "5"), ("extra-bands", "0")]);
        let low = visibility(3, [("order", "3"), ("extra-bands", "0")]);
        assert_eq!(kept, high, "{}", method.info().id);
        assert_ne!(kept, low, "{}", method.info().id);
        let shaded = |settings: [(&str, &str); 2]| {
            let params = Params::resolve(method.info().params, settings).expect("in range");
            let case = Case::new(method, &scene, Quantity::Direct).tuned(params);
            assert_eq!(
                case.is_supported(),
                settings[0].1 != "6",
                "{}: order + extra-bands is at most 8",
                method.info().id
            );
            case.is_supported().then(|| case.fresh(&case.frames[0]).expect("it runs"))
        };
        assert_ne!(shaded([("order", "3"), ("extra-bands", "2")]), shaded([("order", "3"), ("extra-bands", "0")]));
        assert_eq!(shaded([("order", "6"), ("extra-bands", "3")]), None);
        tried += 1;
    }
    assert!(tried >= 8, "{tried}");
}
