//! Suites: TOML files that say what to run.
//!
//! ```toml
//! about = "What the suite is for, in one line"
//!
//! [[entry]]
//! scenes = ["sphere-plane", "scenes/mine.toml"]    # shipped names, or paths as seen from the suite file
//! methods = ["shexp/hyb"]
//! set = { order = "2..6", p = 2 }                  # as with --set; a list of values is well too
//! references = ["truth", "sh-light"]
//! quantities = ["direct"]                          # the default; `indirect-1` (bounces), `total`
//! frames = 3                                       # the first so many; all if nothing is said
//! ```
//!
//! `scenes = ["all"]` are all that are shipped, `methods = ["all"]` all that are registered, `shexp/*` those of a family.
//! Every entry stands for all combinations of its scenes, methods and settings; a cell that several entries name is run
//! once, against the references of all of them.

use crate::Error;
use crate::settings::{Series, Setting, read};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A suite.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suite {
    /// What it is for, in one line.
    pub about: String,
    /// What it runs.
    #[serde(rename = "entry")]
    pub entries: Vec<Entry>,
}

/// A part of a suite: all combinations of scenes, methods and settings.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Shipped names or paths of scene files; `all` for every shipped one.
    pub scenes: Vec<String>,
    /// Method ids; `family/*` for a family's, `all` for every one.
    pub methods: Vec<String>,
    /// Series by parameter; applied to those of the methods that declare the parameter.
    #[serde(default, deserialize_with = "settings")]
    pub set: Vec<Setting>,
    /// References to score against; all kinds if nothing is said.
    #[serde(default = "all_references")]
    pub references: Vec<String>,
    /// What is computed: `direct`, `indirect-N` by N bounces, `total`.
    #[serde(default = "direct")]
    pub quantities: Vec<String>,
    /// The first so many frames of each scene; all if nothing is said, or where there are fewer.
    pub frames: Option<usize>,
}

/// The suites that come with the program.
pub(crate) const SHIPPED: [(&str, &str); 14] = [
    ("quick", include_str!("../suites/quick.toml")),
    ("full", include_str!("../suites/full.toml")),
    ("paper/shexp", include_str!("../suites/paper/shexp.toml")),
    ("paper/rates", include_str!("../suites/paper/rates.toml")),
    ("paper/hw-fig3", include_str!("../suites/paper/hw-fig3.toml")),
    ("paper/hw-fig4", include_str!("../suites/paper/hw-fig4.toml")),
    ("paper/hw-fig6", include_str!("../suites/paper/hw-fig6.toml")),
    ("paper/hw-fig8", include_str!("../suites/paper/hw-fig8.toml")),
    ("paper/hw-fig9", include_str!("../suites/paper/hw-fig9.toml")),
    ("paper/hw-fig10", include_str!("../suites/paper/hw-fig10.toml")),
    ("paper/hw-fig11", include_str!("../suites/paper/hw-fig11.toml")),
    ("paper/hw-table1", include_str!("../suites/paper/hw-table1.toml")),
    ("scaling", include_str!("../suites/scaling.toml")),
    ("gate", include_str!("../suites/gate.toml")),
];

impl Suite {
    /// A shipped suite by name, or the suite in the file of this path.
    ///
    /// # Errors
    /// There is neither, or the file is not a suite.
    pub fn find(name: &str) -> Result<Self, Error> {
        if let Some((_, text)) = SHIPPED.iter().find(|(shipped, _)| *shipped == name) {
            return Self::parse(name, text);
        }
        let path = Path::new(name);
        if !path.exists() {
            let known = SHIPPED.iter().map(|(name, _)| *name).chain(["the path of a suite file"]);
            return Err(Error::unknown("suite", name, known));
        }
        let text = std::fs::read_to_string(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
        let mut suite = Self::parse(name, &text)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        for scene in suite.entries.iter_mut().flat_map(|entry| &mut entry.scenes) {
            if is_path(scene) {
                *scene = folder.join(&*scene).display().to_string();
            }
        }
        Ok(suite)
    }

    fn parse(name: &str, text: &str) -> Result<Self, Error> {
        let wrong = |message: String| Error::Suite { name: name.to_owned(), message };
        let suite: Suite = toml::from_str(text).map_err(|e| wrong(one_line(text, &e)))?;
        for (i, entry) in suite.entries.iter().enumerate() {
            let lists = [("scenes", &entry.scenes), ("methods", &entry.methods), ("quantities", &entry.quantities)];
            if let Some((field, _)) = lists.iter().find(|(_, list)| list.is_empty()) {
                return Err(wrong(format!("entry {}: `{field}` is empty, expected at least one", i + 1)));
            }
            if entry.frames == Some(0) {
                return Err(wrong(format!("entry {}: `frames` is 0, expected at least 1", i + 1)));
            }
        }
        if suite.entries.is_empty() { Err(wrong("expected at least one `[[entry]]`".into())) } else { Ok(suite) }
    }
}

/// Whether a scene is named by the path of its file: shipped names have neither a separator nor an extension.
fn is_path(scene: &str) -> bool {
    let whole = scene.split_once('@').map_or(scene, |(whole, _)| whole);
    scene.contains(std::path::is_separator) || whole.ends_with(".toml")
}

/// TOML's own messages span several lines; what remains here is one with its place.
fn one_line(text: &str, error: &toml::de::Error) -> String {
    let start = error.span().map_or(0, |span| span.start.min(text.len()));
    let line = text.as_bytes()[..start].iter().filter(|byte| **byte == b'\n').count() + 1;
    format!("line {line}: {}", error.message().trim().replace('\n', ", "))
}

fn all_references() -> Vec<String> {
    DEFAULT_REFERENCES.map(str::to_owned).to_vec()
}

/// The references that are used when nothing is said.
pub const DEFAULT_REFERENCES: [&str; 3] = ["truth", "sh-light", "sphere-proxies"];

/// The quantities when nothing is said.
pub(crate) fn direct() -> Vec<String> {
    vec!["direct".to_owned()]
}

/// Reads `{ order = "2..6", p = [2, 4], windowed = true }`.
fn settings<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<Setting>, D::Error> {
    let table = BTreeMap::<String, toml::Value>::deserialize(deserializer)?;
    let one = |value: &toml::Value| match value {
        toml::Value::String(text) => read(text),
        toml::Value::Integer(v) => Ok(vec![Series::One(v.to_string())]),
        toml::Value::Float(v) => Ok(vec![Series::One(v.to_string())]),
        toml::Value::Boolean(v) => Ok(vec![Series::One(v.to_string())]),
        other => Err(format!("expected a text, number, switch or a list of these, found a {}", other.type_str())),
    };
    let all = |value: &toml::Value| match value {
        toml::Value::Array(values) => values.iter().map(one).collect::<Result<Vec<_>, _>>().map(|v| v.concat()),
        value => one(value),
    };
    let setting = |(name, value): (String, toml::Value)| match all(&value) {
        Ok(values) => Ok(Setting { name, values }),
        Err(message) => Err(serde::de::Error::custom(format!("set.{name}: {message}"))),
    };
    table.into_iter().map(setting).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_suites_are_suites() {
        for (name, _) in SHIPPED {
            assert!(!Suite::find(name).unwrap().about.is_empty());
        }
    }

    #[test]
    fn every_suite_file_is_shipped_under_its_path() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("suites");
        let mut found = Vec::new();
        for (folder, before) in [(folder.clone(), ""), (folder.join("paper"), "paper/")] {
            for file in std::fs::read_dir(folder).unwrap() {
                let path = file.unwrap().path();
                if path.is_file() {
                    found.push(format!("{before}{}", path.file_stem().unwrap().display()));
                }
            }
        }
        found.sort();
        let mut shipped = SHIPPED.map(|(name, _)| name);
        shipped.sort_unstable();
        assert_eq!(found, shipped);
    }

    #[test]
    fn settings_take_every_form() {
        let text = "about = ''\n[[entry]]\nscenes = ['a']\nmethods = ['b']\nreferences = []\n\
                    set = { order = '2..3', p = [1, '4..5'], on = true, x = 0.5, y = 'log(1..8, 4), 7' }";
        let suite = Suite::parse("test", text).unwrap();
        let one = |s: &Setting| format!("{}={}", s.name, s.values.iter().map(|v| format!("{v};")).collect::<String>());
        let found: Vec<_> = suite.entries[0].set.iter().map(one).collect();
        assert_eq!(found, ["on=true;", "order=2..3;", "p=1;4..5;", "x=0.5;", "y=log(1..8,4);7;"]);
    }

    #[test]
    fn wrong_suites_are_refused() {
        let base = "about = ''\n[[entry]]\nscenes = ['a']\nmethods = ['b']\nreferences = []\n";
        for (text, part) in [
            (format!("{base}sed = 3"), "sed"),
            (base.replace("'b'", ""), "`methods` is empty"),
            ("about = ''\nentry = []".to_owned(), "[[entry]]"),
            (format!("{base}set = {{ order = '6..2' }}"), "set.order: expected a range"),
            (base.replace("about", "a"), "a"),
        ] {
            let message = Suite::parse("test", &text).unwrap_err().to_string();
            assert!(message.starts_with("suite test: ") && message.contains(part), "{message}");
        }
    }
}
