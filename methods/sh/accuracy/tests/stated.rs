//! What is stated holds, at every order, in every form that this machine has, and the crate's page says the same.

use halflight_sh_accuracy::{measure, stated_markdown, violations};

#[test]
fn errors_and_domains_are_as_stated() {
    let report = measure(1..=8);
    assert_eq!(violations(&report), Vec::<String>::new());
    assert!(report.steps.iter().all(|step| step.not_finite == 0));
}

#[test]
fn the_page_carries_what_is_stated() {
    let page = include_str!("../../README.md");
    assert!(page.contains(&stated_markdown()), "methods/sh/README.md lacks these tables:\n{}", stated_markdown());
}
