//! The walk from the truth to a method.

use crate::bench::Bench;
use serde_json::Value;

#[test]
fn a_budget_walks_to_the_method_with_figures_and_pictures() {
    let bench = Bench::new();
    let command = "budget --scene tiny.toml --method shexp/hyb --set order=3 --set spheres=8 --out out";
    let steps: Vec<Value> = serde_json::from_str(&bench.well(&format!("{command} --json"))).unwrap();
    let names: Vec<_> = steps.iter().map(|step| step["step"].as_str().unwrap()).collect();
    let expected = [
        "truth",
        "+ sh-light:3",
        "+ sphere-proxies:8",
        "+ sh-visibility:3",
        "sh-product/ordered",
        "shexp/eigen",
        "shexp/hyb",
    ];
    assert_eq!(names, expected);
    assert!(steps[0]["change"].is_null() && steps[0]["from_truth"].is_null());
    let figure = |step: usize, of: &str, name: &str| steps[step][of][name].as_f64().unwrap();
    assert_eq!(figure(1, "from_truth", "rmse"), figure(1, "change", "rmse"));
    // An exact sphere far below the receivers' tangent planes is its own proxy, a method without samples has no noise.
    assert_eq!(steps[2]["change"]["resolved"], false, "{}", steps[2]);
    assert!(figure(5, "change", "noise") == 0.0 && figure(6, "from_truth", "noise") > 0.0);
    // One sphere: no product is taken, and the exponential of its log is all but its visibility.
    assert!(figure(5, "change", "rmse") < 1e-3, "{}", steps[5]);
    // Biases add up, since every step's mean is the next one's start.
    let sum: f64 = (1..7).map(|step| figure(step, "change", "bias")).sum();
    assert!((sum - figure(6, "from_truth", "bias")).abs() < 1e-6);

    let told = bench.well(command);
    assert!(told.contains("not resolved, < ") && told.contains("\nshexp/hyb "), "{told}");
    let page = std::fs::read_to_string(bench.path("out/budget-tiny-shexp-hyb.html")).unwrap();
    // A picture a step, and a difference a step but the first.
    assert_eq!(page.matches("<img ").count(), 13);
    assert!(!page.contains("://"), "the page loads something");
}

#[test]
fn a_method_that_is_off_shows_where() {
    let bench = Bench::new();
    // Two spheres that all but coincide: the truncated product counts them twice.
    let ball = "[[objects]]\nname = \"twin\"\nsphere = { center = [0.0, 0.0, 1.01], radius = 0.5 }\nalbedo = [0.5, 0.5, 0.5]\n";
    let scene = std::fs::read_to_string(bench.path("tiny.toml")).unwrap();
    bench.write("twins.toml", &format!("{scene}\n{ball}"));
    let of = |scene: &str| -> Vec<Value> {
        let said = bench.well(&format!("budget --scene {scene} --method sh-product/ordered --json --samples 4096"));
        serde_json::from_str(&said).unwrap()
    };
    let product = |steps: &[Value]| steps[4]["change"]["bias"].as_f64().unwrap();
    let (one, two) = (of("tiny.toml"), of("twins.toml"));
    assert!(product(&two) < product(&one) - 0.005, "{} {}", two[4], one[4]);
}
