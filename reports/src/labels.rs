//! Short names for settings and scenes: what is the same everywhere need not be said.

use halflight_results::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// Names settings by their method and by those fields alone in which the method's cells differ.
pub(crate) struct Labels {
    /// By method, the names of the fields that differ.
    differing: BTreeMap<String, BTreeSet<String>>,
}

impl Labels {
    pub(crate) fn of<'a>(cells: impl Iterator<Item = &'a Cell>) -> Self {
        let mut seen: BTreeMap<String, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
        for cell in cells {
            let fields = seen.entry(cell.method.clone()).or_default();
            for (name, value) in fields_of(cell) {
                fields.entry(name).or_default().insert(value);
            }
        }
        let differing = seen.into_iter().map(|(method, fields)| {
            let names = fields.into_iter().filter(|(_, values)| values.len() > 1).map(|(name, _)| name).collect();
            (method, names)
        });
        Self { differing: differing.collect() }
    }

    /// The label of a cell.
    pub(crate) fn label(&self, cell: &Cell) -> String {
        self.without(cell, &[])
    }

    /// The label without where the cell ran.
    pub(crate) fn setting(&self, cell: &Cell) -> String {
        self.without(cell, &["backend", "threads", "on", "by"])
    }

    fn without(&self, cell: &Cell, left_out: &[&str]) -> String {
        let differing = self.differing.get(&cell.method);
        let is_shown =
            |name: &String| differing.is_some_and(|d| d.contains(name)) && !left_out.contains(&name.as_str());
        let shown = fields_of(cell).into_iter().filter(|(name, _)| is_shown(name));
        let part = |(name, value): (String, String)| if name == "backend" { value } else { format!("{name} {value}") };
        let parts: Vec<String> = shown.map(part).collect();
        if parts.is_empty() { cell.method.clone() } else { format!("{} · {}", cell.method, parts.join(", ")) }
    }
}

/// All that tells two settings of a method apart within a scene.
fn fields_of(cell: &Cell) -> Vec<(String, String)> {
    let mut fields: Vec<(String, String)> =
        cell.params.iter().map(|(name, value)| (name.clone(), value_text(value))).collect();
    fields.push(("backend".into(), cell.backend.clone()));
    fields.push(("quantity".into(), cell.quantity.clone()));
    fields.push(("seed".into(), cell.seed.to_string()));
    fields.push(("revision".into(), cell.revision.chars().take(8).collect()));
    // What was not timed is on no machine, rather than on another one; and what says the backend need not be said again.
    if let Some((threads, on)) = cell.timed_on.as_deref().map(split) {
        fields.push(("threads".into(), threads));
        fields.push((if cell.is_gpu() { "by" } else { "on" }.into(), on));
    }
    fields
}

/// The number of threads of a machine class, and all else that it says.
fn split(class: &str) -> (String, String) {
    let (threads, rest): (Vec<&str>, Vec<&str>) = class.split(" | ").partition(|part| part.ends_with(" threads"));
    (threads.join(" | ").replace(" threads", ""), rest.join(" | "))
}

/// A parameter's value: strings without their quotes.
pub(crate) fn value_text(value: &serde_json::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Names the sections: a scene's name, with the frame, the receivers or the content's hash where it has several.
pub(crate) struct SceneNames {
    hashes: BTreeMap<String, BTreeSet<String>>,
    frames: BTreeMap<String, BTreeSet<u32>>,
    receivers: BTreeMap<String, BTreeSet<String>>,
}

impl SceneNames {
    pub(crate) fn of<'a>(cells: impl Iterator<Item = &'a Cell>) -> Self {
        let mut names = Self { hashes: BTreeMap::new(), frames: BTreeMap::new(), receivers: BTreeMap::new() };
        for cell in cells {
            names.hashes.entry(cell.scene.clone()).or_default().insert(cell.scene_hash.clone());
            names.frames.entry(cell.scene.clone()).or_default().insert(cell.frame);
            // A skipped cell may never have had receivers.
            if !cell.receivers_hash.is_empty() {
                names.receivers.entry(cell.scene.clone()).or_default().insert(cell.receivers_hash.clone());
            }
        }
        names
    }

    pub(crate) fn name(&self, cell: &Cell) -> String {
        let start = |hash: &str| hash.chars().take(8).collect::<String>();
        let mut name = cell.scene.clone();
        if self.frames.get(&cell.scene).is_some_and(|f| f.len() > 1) {
            name += &format!(" · frame {}", cell.frame);
        }
        if self.hashes.get(&cell.scene).is_some_and(|h| h.len() > 1) {
            name += &format!(" · content {}", start(&cell.scene_hash));
        }
        if self.receivers.get(&cell.scene).is_some_and(|r| r.len() > 1) && !cell.receivers_hash.is_empty() {
            name += &format!(" · receivers {}", start(&cell.receivers_hash));
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::Environment;

    fn cell(scene: &str, method: &str, order: u32, frame: u32) -> Cell {
        let params = [("order".to_owned(), order.into()), ("rule".to_owned(), "paper".into())].into();
        Cell { scene: scene.into(), method: method.into(), params, frame, ..Cell::default() }
    }

    #[test]
    fn labels_say_only_what_differs() {
        let cells = [cell("s", "a/x", 3, 0), cell("s", "a/x", 4, 0), cell("s", "b/y", 4, 0), cell("t", "b/y", 4, 0)];
        let labels = Labels::of(cells.iter());
        let names: Vec<String> = cells.iter().map(|c| labels.label(c)).collect();
        assert_eq!(names, ["a/x · order 3", "a/x · order 4", "b/y", "b/y"]);
    }

    #[test]
    fn threads_are_told_apart_without_the_machine() {
        let on = |threads: usize| {
            let environment = Environment { threads, cpu: "a".into(), ..Environment::default() };
            Cell { timed_on: Some(environment.class()), ..cell("s", "a/x", 3, 0) }
        };
        let labels = Labels::of([on(1), on(8)].iter());
        assert_eq!(labels.label(&on(8)), "a/x · threads 8");
    }

    #[test]
    fn a_setting_is_the_same_wherever_it_runs() {
        let on = |backend: &str, order| Cell { backend: backend.into(), ..cell("s", "a/x", order, 0) };
        let labels = Labels::of([on("cpu", 3), on("gpu: x", 3), on("cpu", 4)].iter());
        assert_eq!(labels.label(&on("gpu: x", 3)), "a/x · order 3, gpu: x");
        assert_eq!(labels.setting(&on("gpu: x", 3)), "a/x · order 3");
    }

    #[test]
    fn machines_are_told_apart_on_each_backend_by_itself() {
        let on = |backend: &str, timed_on: Option<&str>| Cell {
            backend: backend.into(),
            timed_on: timed_on.map(str::to_owned),
            ..cell("s", "a/x", 3, 0)
        };
        let [cpu, gpu, software] =
            [on("cpu", Some("a | 2 threads")), on("gpu: x", Some("a | 2 threads | x")), on("gpu: y", None)];
        let labels = Labels::of([&cpu, &gpu, &software].into_iter());
        assert_eq!(
            [&cpu, &gpu, &software].map(|cell| labels.label(cell)),
            ["a/x · cpu", "a/x · gpu: x", "a/x · gpu: y"]
        );
        let elsewhere = on("cpu", Some("b | 2 threads"));
        let labels = Labels::of([&cpu, &gpu, &elsewhere].into_iter());
        assert_eq!([&gpu, &elsewhere].map(|cell| labels.label(cell)), ["a/x · gpu: x", "a/x · cpu, on b"]);
    }

    #[test]
    fn scenes_are_told_apart_by_what_differs() {
        let mut cells = vec![cell("s", "a", 3, 0), cell("s", "a", 3, 1), cell("t", "a", 3, 0)];
        cells[2].scene_hash = "0123456789".into();
        let names = SceneNames::of(cells.iter());
        assert_eq!(names.name(&cells[1]), "s · frame 1");
        assert_eq!(names.name(&cells[2]), "t");
        cells.push(cell("t", "a", 3, 0));
        assert_eq!(SceneNames::of(cells.iter()).name(&cells[2]), "t · content 01234567");
    }
}
