//! Crates point only downward, as ARCHITECTURE draws them.

use std::collections::BTreeSet;

use crate::manifests::{Manifest, members};

/// Folders of support crates and of the boxes above, each with the folders that it may link. Every other crate below
/// `methods/` is a family.
const ALLOWED: &[(&str, &[&str])] = &[
    ("references/trace", &[]),
    ("methods/sh/kernels", &[]),
    ("methods/sh", &["methods/sh/kernels"]),
    ("methods/sh/accuracy", &["methods/sh"]),
    ("methods/sh/generate", &["methods/sh"]),
    ("harness/revision", &[]),
    ("harness/results", &[]),
    ("reports/metrics", &[]),
    ("scenes/oiio", &[]),
    ("scenes", &["references/trace", "scenes/oiio"]),
    ("methods/contract", &["scenes"]),
    ("methods/gpu", &["methods/contract", "scenes"]),
    ("methods/light", &["methods/contract", "methods/sh", "scenes"]),
    ("methods/horizons", &["methods/contract", "methods/gpu", "methods/sh/kernels", "scenes"]),
    ("methods/proxies", &["harness/revision", "methods/contract", "references/trace", "scenes"]),
    (
        "methods/blockers",
        &["methods/contract", "methods/gpu", "methods/light", "methods/proxies", "methods/sh", "scenes"],
    ),
    (
        "references",
        &[
            "harness/revision",
            "methods/contract",
            "methods/light",
            "methods/proxies",
            "methods/sh",
            "references/trace",
            "scenes",
        ],
    ),
    ("reports", &["harness/results", "reports/metrics"]),
    (
        "harness",
        &[
            "harness/results",
            "methods/blockers",
            "methods/contract",
            "methods/gpu",
            "methods/horizons",
            "methods/light",
            "methods/proxies",
            "methods/registry",
            "methods/sh",
            "methods/sh/accuracy",
            "references",
            "reports",
            "reports/metrics",
            "scenes",
        ],
    ),
    ("tests", &["methods/contract", "methods/gpu", "scenes"]),
];

/// What a family may link: what lies below it, and never its judge.
const BELOW_FAMILIES: &[&str] = &[
    "methods/blockers",
    "methods/contract",
    "methods/gpu",
    "methods/horizons",
    "methods/light",
    "methods/proxies",
    "methods/sh",
    "references/trace",
    "scenes",
];

/// Libraries that draw, which no gate may stand behind.
const PLOTTING: &[&str] = &["charming", "kuva", "plotly", "plotters", "svg2pdf", "typst"];

/// Dependencies that point up, aside, or nowhere that the table knows.
fn misplaced(crates: &[Manifest]) -> Vec<String> {
    let folder_of = |name: &str| crates.iter().find(|c| c.name == name).map(|c| c.folder.as_str());
    let mut found = Vec::new();
    for member in crates {
        let inner = member.dependencies.iter().filter_map(|name| folder_of(name));
        let wrong = inner.filter(|to| !may_link(&member.folder, to));
        found.extend(wrong.map(|to| format!("{} may not depend on {to}", member.folder)));
        if !is_known(&member.folder) {
            found.push(format!("{} has no place in the table of layers", member.folder));
        }
    }
    let metrics = crates.iter().filter(|c| c.folder == "reports/metrics");
    let drawing = metrics.flat_map(|c| &c.dependencies).filter(|name| PLOTTING.contains(&name.as_str()));
    found.extend(drawing.map(|name| format!("reports/metrics may not depend on {name}: gates stand on it")));
    found
}

fn may_link(from: &str, to: &str) -> bool {
    let listed = ALLOWED.iter().find(|(folder, _)| *folder == from).map(|(_, allowed)| *allowed);
    match listed {
        Some(allowed) => allowed.contains(&to),
        None if from == "methods/registry" => is_family(to) || ["methods/contract", "harness/revision"].contains(&to),
        None => is_family(from) && BELOW_FAMILIES.contains(&to),
    }
}

fn is_known(folder: &str) -> bool {
    folder == "methods/registry" || is_family(folder) || ALLOWED.iter().any(|(known, _)| *known == folder)
}

fn is_family(folder: &str) -> bool {
    folder.starts_with("methods/") && folder != "methods/registry" && ALLOWED.iter().all(|(known, _)| *known != folder)
}

#[test]
fn crates_point_only_downward() {
    let found = misplaced(&members());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn the_table_itself_has_no_circles() {
    let mut done: BTreeSet<&str> = BTreeSet::new();
    while done.len() < ALLOWED.len() {
        let ready = |(folder, allowed): &&(&'static str, &[&str])| {
            let settled = |to: &&str| *to == "methods/registry" || done.contains(to);
            !done.contains(folder) && allowed.iter().all(settled)
        };
        let next = ALLOWED.iter().find(ready).map(|(folder, _)| *folder);
        done.insert(next.unwrap_or_else(|| panic!("a circle above {done:?}")));
    }
}

/// The workspace with one more dependency.
fn with(folder: &str, dependency: &str) -> Vec<Manifest> {
    let mut crates = members();
    let member = crates.iter_mut().find(|c| c.folder == folder).expect("a member");
    member.dependencies.insert(dependency.into());
    crates
}

#[test]
fn what_points_up_is_found() {
    let wrong = [
        ("methods/shexp", "halflight-references"),
        ("methods/sh-product", "halflight-shexp"),
        ("methods/sh", "halflight-scenes"),
        ("methods/contract", "halflight-registry"),
        ("scenes", "halflight-contract"),
        ("references", "halflight-shexp"),
        ("references/trace", "halflight-scenes"),
        ("scenes/oiio", "halflight-scenes"),
        ("reports", "halflight-references"),
        ("reports/metrics", "halflight-reports"),
        ("reports/metrics", "plotters"),
        ("harness/results", "halflight"),
    ];
    let before = misplaced(&members());
    for (folder, dependency) in wrong {
        let mut found = misplaced(&with(folder, dependency));
        found.retain(|line| !before.contains(line));
        assert_eq!(found.len(), 1, "{folder} on {dependency}: {found:?}");
        assert!(found[0].starts_with(&format!("{folder} may not depend on")), "{found:?}");
    }
}

#[test]
fn a_crate_without_a_place_is_found() {
    let stray = Manifest { folder: "tools".into(), name: "tools".into(), dependencies: BTreeSet::new() };
    assert_eq!(misplaced(&[stray]), ["tools has no place in the table of layers"]);
}
