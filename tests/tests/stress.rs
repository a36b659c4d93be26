//! `docs/stress.md` says what the code does, and nothing that it says is infinite.

use halflight_tests::stress::{self, COUNTS, Stress};

/// What a vector within the guard's bound makes of a uniform sky at most: the ball around half the open sky holds it, so that it
/// is `(1 + ‖H‖/H_0)/2 = (1 + √(8/3))/2` of the open sky's.
const MOST: f64 = 1.3166;

fn measured() -> Stress {
    stress::measure(&stress::sphere_blockers(halflight_registry::methods()))
}

/// Words alike, or numbers near one another: other processors round differently, and what diverges multiplies that.
fn alike(written: &str, found: &str) -> bool {
    let number = |word: &str| word.trim_matches(|c: char| ":,|!".contains(c)).parse::<f64>().ok();
    match (number(written), number(found)) {
        (Some(a), Some(b))
            if [a, b].iter().all(|v| v.abs() > 1e3) || [a, b].iter().all(|v| (1e-30..1e-3).contains(&v.abs())) =>
        {
            a * b > 0.0 && (a / b).log10().abs() < 0.5
        }
        (Some(a), Some(b)) => (a - b).abs() <= 0.02 + 0.03 * a.abs().max(b.abs()),
        _ => written == found,
    }
}

/// Numbers apart from what is between them, in pictures too.
fn words(line: &str) -> impl Iterator<Item = &str> + Clone {
    line.split(|c: char| c.is_whitespace() || "\"',".contains(c)).filter(|word| !word.is_empty())
}

fn same(written: &str, found: &str) {
    for (number, (written, found)) in written.lines().zip(found.lines()).enumerate() {
        let (mine, others) = (words(written), words(found));
        assert!(
            mine.clone().count() == others.clone().count() && mine.zip(others).all(|(a, b)| alike(a, b)),
            "line {}: run `cargo run --release -p halflight-tests --example stress`\n{written}\n{found}",
            number + 1
        );
    }
    assert_eq!(written.lines().count(), found.lines().count());
}

#[test]
fn the_page_is_what_is_measured() {
    let stress = measured();
    for (written, found) in [
        (include_str!("../../docs/stress.md"), stress::markdown(&stress)),
        (include_str!("../../docs/stress/onset.svg"), stress::onsets(&stress).expect("it is drawn")),
        (include_str!("../../docs/stress/irradiance.svg"), stress::irradiance(&stress).expect("it is drawn")),
    ] {
        same(written, &found);
    }

    // Nothing is infinite, and the guard bounds what receivers get.
    for case in &stress.cases {
        let [off, on] = case.found;
        assert_eq!(off.not_finite + on.not_finite, 0, "{case:?}");
        assert!(on.worst <= MOST && off.guarded <= on.guarded, "{case:?}");
    }

    // Order 4 at N = 1, 10, 20, 60, 200: powers of the product matrix by NumPy in f64, and what exponentials give.
    let powers = [0.929249, 0.703199, 0.765261, 1.416228, 8.905278];
    for (method, figures, tolerance) in
        [("sh-product/ordered", powers, 1e-3), ("shexp/eigen", [0.929, 0.703, 0.764, 1.40, 8.35], 5e-3)]
    {
        let overlap = stress.overlaps.iter().find(|o| o.method == method && o.order == 4).expect("it is there");
        for (count, want) in [1, 10, 20, 60, 200].into_iter().zip(figures) {
            let found = overlap.irradiance[0][COUNTS.iter().position(|n| *n == count).expect("tried")];
            assert!((found - want).abs() < tolerance * want, "{method} at {count}: {found} for {want}");
        }
    }
}

#[test]
fn pages_that_differ_are_told_apart() {
    assert!(alike("0.929", "0.931") && alike("|", "|") && alike("8.35,", "8.40,") && alike("1e9", "2e9"));
    assert!(!alike("0.929", "0.99") && !alike("–", "3") && !alike("1e5", "-1e5") && !alike("guard", "guards"));
}
