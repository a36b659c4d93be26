//! What blessing changes, for people.

use super::{Baselines, CellBaseline, ReferenceBaseline};
use std::collections::{BTreeMap, BTreeSet};

/// One line for every value that differs, `subject: what: old -> new`; none where nothing does.
pub fn changes(old: &Baselines, new: &Baselines) -> Vec<String> {
    let mut lines = Vec::new();
    if old.kernels != new.kernels && !old.kernels.is_empty() {
        lines.push(format!("vector extensions: {} -> {}", old.kernels, new.kernels));
    }
    for (name, old, new) in pairs(&old.references, &new.references) {
        table(&mut lines, name, old.map(reference), new.map(reference));
    }
    for (name, old, new) in pairs(&old.cells, &new.cells) {
        table(&mut lines, name, old.map(cell), new.map(cell));
    }
    for (name, old, new) in pairs(&old.paces, &new.paces) {
        value(&mut lines, name, "relative shading time", old.map(f64::to_string), new.map(f64::to_string));
    }
    if old.instructions.with != new.instructions.with && !new.instructions.with.is_empty() {
        lines.push(format!("instructions: counted with {}", new.instructions.with));
    }
    for (name, old, new) in pairs(&old.instructions.counts, &new.instructions.counts) {
        value(&mut lines, name, "instructions", old.map(u64::to_string), new.map(u64::to_string));
    }
    lines
}

/// What a cell or reference is known by, in words.
struct Known {
    values: BTreeMap<String, String>,
    means: Means,
}

fn table(lines: &mut Vec<String>, name: &str, old: Option<Known>, new: Option<Known>) {
    let (old, new) = match (old, new) {
        (Some(old), Some(new)) => (old, new),
        (None, Some(_)) => return lines.push(format!("{name}: new")),
        (Some(_), None) => return lines.push(format!("{name}: gone")),
        (None, None) => return,
    };
    lines.extend(moved(&old.means, &new.means).map(|told| format!("{name}: {told}")));
    for (what, old, new) in pairs(&old.values, &new.values) {
        value(lines, name, what, old.cloned(), new.cloned());
    }
}

fn value(lines: &mut Vec<String>, name: &str, what: &str, old: Option<String>, new: Option<String>) {
    if old != new {
        let or_none = |value: Option<String>| value.unwrap_or_else(|| "none".to_owned());
        lines.push(format!("{name}: {what}: {} -> {}", or_none(old), or_none(new)));
    }
}

/// Both maps' values by name.
fn pairs<'a, T>(
    old: &'a BTreeMap<String, T>,
    new: &'a BTreeMap<String, T>,
) -> impl Iterator<Item = (&'a str, Option<&'a T>, Option<&'a T>)> {
    let names: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    names.into_iter().map(|name| (name.as_str(), old.get(name), new.get(name)))
}

fn reference(known: &ReferenceBaseline) -> Known {
    let mut values = common(known.receivers, known.level);
    values.insert("key".to_owned(), known.key.chars().take(12).collect());
    Known { values, means: known.blocks.iter().map(|block| block.map(|(mean, ..)| mean)).collect() }
}

fn cell(known: &CellBaseline) -> Known {
    let mut values = common(known.receivers, known.level);
    for (reference, score) in &known.errors {
        values.insert(format!("RMSE against {reference}"), format!("{:.3e} ± {:.0e}", score.rmse, score.rmse_error));
        values.insert(format!("bias against {reference}"), format!("{:.3e} ± {:.0e}", score.bias, score.bias_error));
    }
    values.extend(known.memory.iter().map(|(purpose, bytes)| (format!("memory, {purpose}"), format!("{bytes} bytes"))));
    values.extend(known.work.iter().map(|(counter, count)| (format!("work, {counter}"), count.to_string())));
    Known { values, means: known.blocks.clone() }
}

fn common(receivers: usize, level: f64) -> BTreeMap<String, String> {
    [("receivers".to_owned(), receivers.to_string()), ("level".to_owned(), level.to_string())].into()
}

/// Block means of a picture or of a reference.
type Means = Vec<Option<[f64; 3]>>;

/// How many block means differ, and by how much at most; `None` if none does.
fn moved(old: &Means, new: &Means) -> Option<String> {
    let all = |means: &Means| means.iter().map(|mean| mean.unwrap_or([f64::NAN; 3])).collect::<Vec<_>>().concat();
    let (old, new) = (all(old), all(new));
    let off = |old: f64, new: f64| if old == new || (old.is_nan() && new.is_nan()) { 0.0 } else { (new - old) / old };
    let off: Vec<f64> = old.iter().zip(&new).map(|(old, new)| off(*old, *new)).filter(|off| *off != 0.0).collect();
    let most = off.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    Some(format!("{} of {} block means differ, by {:+.3}% at most", off.len(), new.len(), 100.0 * most))
}
