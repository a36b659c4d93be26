//! What two reports must have in common to say the same: everything but times, environment and order.

use halflight_results::{Phase, Store};
use std::path::Path;

/// A report's data without times, sorted, a line a fact.
pub(crate) fn facts(dir: &Path) -> Vec<String> {
    let store = Store::open(dir).unwrap();
    let report = halflight_reports::build(&store, "");
    // How busy the machine was is a matter of times.
    let warnings = report.warnings.iter().filter(|warning| !warning.contains("were timed while the machine"));
    let mut facts: Vec<String> = warnings.map(|warning| format!("warning {warning}")).collect();
    let label = |label: usize| &report.labels[label];
    for scene in &report.scenes {
        let name = &scene.name;
        facts.extend(scene.references.iter().map(|r| format!("{name} reference {} {:?}", r.id, r.picture)));
        for row in &scene.rows {
            let (run, label) = (&row.run, label(row.label));
            // How often `prepare` is timed depends on how long it takes.
            let phases = row.times.iter().flat_map(|times| &times.phases).filter(|(_, t)| t.phase == Phase::Shade);
            let spans: Vec<_> = phases.map(|(name, timing)| (name, timing.nanoseconds.len())).collect();
            let counted = (run.receivers, &run.approximate, &run.counters, &run.footprint, spans);
            facts.push(format!("{name} {label} {:?} {counted:?} {:?}", run.cell, row.picture));
            facts.extend(row.scores.iter().map(|score| format!("{name} {label} {score:?}")));
        }
    }
    for (kind, absent) in [("skip", &report.skips), ("failure", &report.failures)] {
        facts.extend(absent.iter().map(|a| format!("{kind} {} {} {}", a.scene, label(a.label), a.why)));
    }
    facts.sort();
    facts
}

/// Asserts that two results directories make the same report but for times.
pub(crate) fn assert_same(a: &Path, b: &Path) {
    let (a, b) = (facts(a), facts(b));
    assert!(!a.is_empty());
    let first = a.iter().zip(&b).find(|(a, b)| a != b);
    assert!(a == b, "{} facts and {}; the first that differ: {first:#?}", a.len(), b.len());
}
