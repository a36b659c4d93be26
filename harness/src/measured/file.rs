//! The file of a device: JSON lines, the conditions first, then a line a cell.

use super::Conditions;
use crate::Error;
use halflight_reports::Twins;
use halflight_results::{Key, Record, Score, Times};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The version of the lines.
const SCHEMA: u32 = 1;

/// What was measured on one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// How.
    pub conditions: Conditions,
    /// What.
    pub cells: Vec<Cell>,
}

/// A cell with all that is known of it; pictures are not kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Its run, skip or failure.
    pub outcome: Record,
    /// Its times; none where they were not taken, or mean nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub times: Option<Times>,
    /// Its errors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scores: Vec<Score>,
    /// How far its picture is from that of the same cell on the processor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twin: Option<Difference>,
}

/// How far a graphics processor's picture is from the processor's ([`halflight_metrics::Apart`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Difference {
    /// The cell on the processor.
    pub cpu: Key,
    /// Receivers compared.
    pub receivers: usize,
    /// Largest absolute difference, radiance.
    pub max: f64,
    /// The receiver where it is.
    pub worst: Option<usize>,
    /// Root mean square difference, radiance.
    pub rmse: f64,
    /// Mean signed difference, radiance.
    pub bias: f64,
    /// Root mean square of the processor's picture, radiance.
    pub level: f64,
    /// Receivers with a NaN or infinity in one picture.
    pub not_finite: usize,
    /// Receivers valid in one picture alone.
    pub lone: usize,
    /// Why nothing could be compared; empty where it could.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub error: String,
}

impl Difference {
    pub(super) fn of(twins: &Twins) -> Self {
        let nothing = Self {
            cpu: twins.cpu.clone(),
            receivers: 0,
            max: 0.0,
            worst: None,
            rmse: 0.0,
            bias: 0.0,
            level: 0.0,
            not_finite: 0,
            lone: 0,
            error: String::new(),
        };
        match &twins.apart {
            Ok(apart) => Self {
                receivers: apart.receivers,
                max: apart.max,
                worst: apart.worst,
                rmse: apart.rmse,
                bias: apart.bias,
                level: apart.level,
                not_finite: apart.not_finite,
                lone: apart.lone,
                ..nothing
            },
            Err(error) => Self { error: error.clone(), ..nothing },
        }
    }
}

/// A line of the file.
#[derive(Serialize, Deserialize)]
#[serde(tag = "line", rename_all = "lowercase")]
enum Line {
    Conditions { schema: u32, conditions: Box<Conditions> },
    Cell(Box<Cell>),
}

impl Measured {
    /// Writes the file; an older one is replaced whole or not at all.
    ///
    /// # Errors
    /// A value is not finite, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let io = |source| Error::Io { path: path.to_owned(), source };
        let conditions = Line::Conditions { schema: SCHEMA, conditions: Box::new(self.conditions.clone()) };
        let cells = self.cells.iter().map(|cell| Line::Cell(Box::new(cell.clone())));
        let mut text = String::new();
        for line in std::iter::once(conditions).chain(cells) {
            text +=
                &serde_json::to_string(&line).map_err(|error| Error::Other(format!("{}: {error}", path.display())))?;
            text.push('\n');
        }
        let back = Self::parse(path, &text)?;
        if back != *self {
            return Err(Error::Other(format!(
                "{}: would not read back as it is, expected finite numbers",
                path.display()
            )));
        }
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(io)?;
        }
        let beside = path.with_extension(format!("{}.tmp", std::process::id()));
        std::fs::write(&beside, text).and_then(|()| std::fs::rename(&beside, path)).map_err(|source| {
            // The first error is the one to report.
            let _ = std::fs::remove_file(&beside);
            io(source)
        })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or a line of it is not what it should be.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
        Self::parse(path, &text)
    }

    fn parse(path: &Path, text: &str) -> Result<Self, Error> {
        let wrong = |line: usize, message: &str| Error::Other(format!("{}, line {line}: {message}", path.display()));
        let (mut found, mut cells) = (None, Vec::new());
        for (number, text) in (1..).zip(text.lines()) {
            match serde_json::from_str(text).map_err(|error| wrong(number, &error.to_string()))? {
                Line::Conditions { schema, .. } if schema != SCHEMA => {
                    return Err(wrong(number, &format!("`schema` is {schema}, expected {SCHEMA}")));
                }
                Line::Conditions { conditions, .. } if number == 1 => found = Some(*conditions),
                Line::Conditions { .. } => return Err(wrong(number, "conditions a second time, expected a cell")),
                Line::Cell(cell) if cell.outcome.cell().is_some() => cells.push(*cell),
                Line::Cell(_) => return Err(wrong(number, "expected a run, skip or failure")),
            }
        }
        let conditions = found.ok_or_else(|| wrong(1, "expected the conditions"))?;
        Ok(Self { conditions, cells })
    }
}

/// Every device of a folder, by the names of their files.
///
/// # Errors
/// As [`Measured::read`].
pub fn read_all(folder: &Path) -> Result<Vec<Measured>, Error> {
    let listed = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<_> =
        listed.filter(|path| path.extension().is_some_and(|extension| extension == "jsonl")).collect();
    paths.sort();
    paths.iter().map(|path| Measured::read(path)).collect()
}
