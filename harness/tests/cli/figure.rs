//! `halflight figure`.

use crate::bench::Bench;

#[test]
fn figures_are_listed_made_by_name_and_an_unknown_one_is_told() {
    let bench = Bench::new();
    let listed = bench.well("figure");
    assert!(listed.lines().any(|line| line.starts_with("shexp/fig7 ") && line.contains("Ren et al. 2006, Fig. 7")));

    let told = bench.halflight("figure shexp/gamma shexp/fig2 --out figures");
    assert_eq!((told.code, told.err.lines().count()), (2, 1), "{}", told.err);
    assert!(told.err.contains("unknown figure `shexp/fig2`: expected one of shexp/"), "{}", told.err);
    assert!(!bench.path("figures").exists(), "nothing is made where one is unknown");

    assert_eq!(
        bench.well("figure shexp/gamma shexp/rim --out figures"),
        "figures/shexp/gamma/index.html\nfigures/shexp/rim/index.html\n"
    );
    let page = |id: &str| std::fs::read_to_string(bench.path("figures").join(id).join("index.html")).unwrap();
    // What is printed beside what is found, and the verdict on it.
    assert!(
        page("shexp/gamma").contains("<td>369</td><td>359</td>")
            && page("shexp/gamma").contains("S1 of the ledger: partly")
    );
    let rim = page("shexp/rim");
    assert_eq!(rim.matches("<svg").count(), 4);
    assert!(rim.contains("<th>0.9</th><td>0.729</td><td>0.729</td>"), "{rim}");
    bench.well("figure hw/fig4 --samples 64 --out figures");
    let offsets = page("hw/fig4");
    assert_eq!(
        (offsets.matches("<svg").count(), offsets.matches("RMSE 0.0").count()),
        (2, 5),
        "five offsets in two plots"
    );
    assert!(!rim.replace("http://www.w3.org/2000/svg", "").contains("://"), "the page loads something");
}
