//! `halflight ledger`.

use crate::bench::{Bench, of_kind};

#[test]
fn a_row_is_measured_and_the_page_follows_the_figures() {
    let bench = Bench::new();
    let page = bench.path("page.md");
    let at = format!("--figures {} --out {}", bench.path("figures").display(), page.display());
    bench.well(&format!("ledger {at}"));
    assert!(std::fs::read_to_string(&page).unwrap().contains("## S1: not measured"));

    let measured = bench.well("ledger measure S1 --figures figures");
    assert_eq!(measured, "S1: 16 figures\n");
    assert_eq!(of_kind(&bench.lines("figures"), "measured").len(), 16);
    assert_eq!(bench.halflight(&format!("ledger {at} --check")).code, Some(1), "the page is of no figures");
    bench.well(&format!("ledger {at}"));
    bench.well(&format!("ledger {at} --check"));
    let told = std::fs::read_to_string(&page).unwrap();
    assert!(told.contains("## S1: partly") && told.contains("| 369 | 359 |"), "{told}");
}
