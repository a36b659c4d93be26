//! Baselines: what was measured and blessed, as a text file of stable order whose lines change only with what they tell.

use super::Instructions;
use crate::Error;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The version of the file's format.
const VERSION: u32 = 1;

/// A suite's baselines.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baselines {
    version: u32,
    /// Vector extensions of the processor that they were measured on.
    pub kernels: String,
    /// References, by `scene · reference · quantity`.
    pub references: BTreeMap<String, ReferenceBaseline>,
    /// Cells, by `scene · method name=value … · quantity`; parameters at their default are not named.
    pub cells: BTreeMap<String, CellBaseline>,
    /// Median over scenes of the shading time relative to [`super::PACE`], by method with its settings.
    pub paces: BTreeMap<String, f64>,
    /// Instructions of a small frame by method; none where they were not counted.
    #[serde(default)]
    pub instructions: Instructions,
}

/// Block means of a reference: mean and standard error of each channel, and the effective number of receivers.
pub type Noisy = ([f64; 3], [f64; 3], f64);

/// What a reference is known by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceBaseline {
    /// Key of all that decides it, its seed and the revision of its sources included.
    pub key: String,
    /// Valid receivers.
    pub receivers: usize,
    /// Root mean square radiance.
    pub level: f64,
    /// Blocks as of [`halflight_metrics::Fingerprint`].
    pub blocks: Vec<Option<Noisy>>,
}

/// What a cell is known by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CellBaseline {
    /// Valid receivers.
    pub receivers: usize,
    /// Root mean square radiance of the picture.
    pub level: f64,
    /// Its block means, as of [`halflight_metrics::Fingerprint`].
    pub blocks: Vec<Option<[f64; 3]>>,
    /// Errors, by reference as in [`Baselines::references`].
    pub errors: BTreeMap<String, ScoreBaseline>,
    /// Bytes held, by purpose.
    pub memory: BTreeMap<String, u64>,
    /// Work, by counter.
    pub work: BTreeMap<String, u64>,
}

/// How far a picture is from a reference; as of [`halflight_metrics::Difference`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScoreBaseline {
    /// Root mean square error without the reference's noise.
    pub rmse: f64,
    /// Its standard error.
    pub rmse_error: f64,
    /// Mean signed error.
    pub bias: f64,
    /// Its standard error.
    pub bias_error: f64,
    /// Effective number of receivers that the standard errors stem from.
    pub effective: f64,
}

impl Baselines {
    /// Nothing yet, measured on this processor.
    pub fn new() -> Self {
        Baselines { version: VERSION, kernels: crate::cpu_features().join(" "), ..Self::default() }
    }

    /// Keeps what these older ones say where it is no news: relative times that are still right, and, if what was measured is a
    /// part, the rest.
    pub fn keep(&mut self, old: &Self, partial: bool) {
        for (method, pace) in &mut self.paces {
            // Times vary from run to run; a new one would be a line changed for nothing.
            *pace = *old.paces.get(method).filter(|old| (0.67..1.5).contains(&(*pace / **old))).unwrap_or(pace);
        }
        let counts = &mut self.instructions;
        if counts.counts.is_empty()
            || counts.with == old.instructions.with && near(&counts.counts, &old.instructions.counts)
        {
            *counts = old.instructions.clone();
        }
        if partial {
            let part = std::mem::replace(self, old.clone());
            self.references.extend(part.references);
            self.cells.extend(part.cells);
            self.paces.extend(part.paces);
            if part.kernels != old.kernels {
                self.kernels = "several".to_owned();
            }
        }
    }

    /// The file of a suite's baselines: a suite given by its path is known by the file's stem.
    pub fn path(folder: &Path, suite: &str) -> PathBuf {
        let stem = Path::new(suite).file_stem().unwrap_or(suite.as_ref());
        folder.join(stem).with_extension("json")
    }

    /// Reads a file; `None` if there is none.
    ///
    /// # Errors
    /// It cannot be read, or is none of this format.
    pub fn read(path: &Path) -> Result<Option<Self>, Error> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(Error::Io { path: path.to_owned(), source }),
        };
        let wrong = |what: String| Error::Other(format!("{}: {what}", path.display()));
        let found: Self = serde_json::from_str(&text).map_err(|e| wrong(format!("not baselines: {e}")))?;
        if found.version != VERSION {
            return Err(wrong(format!("`version` is {}, expected {VERSION}", found.version)));
        }
        Ok(Some(found))
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let failed = |source| Error::Io { path: path.to_owned(), source };
        let beside = path.with_extension(format!("{}.tmp", std::process::id()));
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).map_err(failed)?;
        std::fs::write(&beside, self.text()).and_then(|()| std::fs::rename(&beside, path)).map_err(|error| {
            // The rename's own error is the one to report; a file left beside does no harm.
            let _ = std::fs::remove_file(&beside);
            failed(error)
        })
    }

    /// As JSON, one block a line.
    fn text(&self) -> String {
        let mut bytes = Vec::new();
        let mut serializer = serde_json::Serializer::with_formatter(&mut bytes, Lines::default());
        self.serialize(&mut serializer).expect("strings and numbers have a JSON form");
        bytes.push(b'\n');
        String::from_utf8(bytes).expect("JSON is UTF-8")
    }
}

/// Whether the same methods have counts that differ by a thousandth at most, which is no news either.
fn near(a: &BTreeMap<String, u64>, b: &BTreeMap<String, u64>) -> bool {
    let near = |(a, b): (&u64, &u64)| a.abs_diff(*b) <= b / 1000;
    a.keys().eq(b.keys()) && a.values().zip(b.values()).all(near)
}

/// Six significant digits: a hundred times finer than what is compared.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(f64::NAN)
}

/// Three, for what says how well something is known.
pub(super) fn coarse(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(f64::NAN)
}

/// Pretty JSON in which an array inside an array stays on its line.
#[derive(Default)]
struct Lines {
    pretty: serde_json::ser::PrettyFormatter<'static>,
    arrays: usize,
}

impl serde_json::ser::Formatter for Lines {
    fn begin_array<W: ?Sized + std::io::Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.arrays += 1;
        if self.arrays > 1 { writer.write_all(b"[") } else { self.pretty.begin_array(writer) }
    }

    fn end_array<W: ?Sized + std::io::Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.arrays -= 1;
        if self.arrays > 0 { writer.write_all(b"]") } else { self.pretty.end_array(writer) }
    }

    fn begin_array_value<W: ?Sized + std::io::Write>(&mut self, writer: &mut W, first: bool) -> std::io::Result<()> {
        match (self.arrays > 1, first) {
            (false, first) => self.pretty.begin_array_value(writer, first),
            (true, true) => Ok(()),
            (true, false) => writer.write_all(b", "),
        }
    }

    fn end_array_value<W: ?Sized + std::io::Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.pretty.end_array_value(writer)
    }

    fn begin_object<W: ?Sized + std::io::Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.pretty.begin_object(writer)
    }

    fn end_object<W: ?Sized + std::io::Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.pretty.end_object(writer)
    }

    fn begin_object_key<W: ?Sized + std::io::Write>(&mut self, writer: &mut W, first: bool) -> std::io::Result<()> {
        self.pretty.begin_object_key(writer, first)
    }

    fn begin_object_value<W: ?Sized + std::io::Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.pretty.begin_object_value(writer)
    }

    fn end_object_value<W: ?Sized + std::io::Write>(&mut self, writer: &mut W) -> std::io::Result<()> {
        self.pretty.end_object_value(writer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_reads_back_and_keeps_a_block_on_its_line() {
        let mut baselines = Baselines::new();
        let blocks = vec![Some(([0.1, 0.2, 0.3], [0.0; 3], 12.5)), None];
        let reference = ReferenceBaseline { key: "k".into(), receivers: 7, level: 1e-9, blocks };
        baselines.references.insert("a · truth · direct".into(), reference);
        let folder = tempfile::tempdir().unwrap();
        let path = Baselines::path(folder.path(), "suites/mine.toml");
        assert_eq!(path, folder.path().join("mine.json"));
        assert_eq!(Baselines::read(&path).unwrap(), None);
        baselines.write(&path).unwrap();
        assert_eq!(Baselines::read(&path).unwrap(), Some(baselines.clone()));
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("\n        [[0.1, 0.2, 0.3], [0.0, 0.0, 0.0], 12.5],\n        null\n"), "{text}");

        std::fs::write(&path, text.replace("\"version\": 1", "\"version\": 2")).unwrap();
        assert!(Baselines::read(&path).unwrap_err().to_string().contains("`version` is 2, expected 1"));
        std::fs::write(&path, text.replace("0.2", "null")).unwrap();
        assert!(Baselines::read(&path).unwrap_err().to_string().contains("not baselines"));
    }

    #[test]
    fn six_digits_are_kept() {
        assert_eq!([0.123_456_78, -9.876_543_21e-9, 0.0].map(rounded), [0.123_457, -9.876_54e-9, 0.0]);
        assert!(rounded(f64::NAN).is_nan());
    }
}
