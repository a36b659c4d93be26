//! Results as a table: a row a cell and reference, for spreadsheets, statistics programs and notebooks.

mod csv;
#[cfg(feature = "parquet")]
mod parquet;

use crate::rescore::newest;
use halflight_metrics::{median, median_interval, outliers};
use halflight_reports::{Twins, twins};
use halflight_results::{Cell, Environment, Record, Run, Score, Store, Times};
use std::collections::BTreeMap;

/// The columns in their order, with what they hold. `NAME` stands for every name that the results have: of a parameter, an
/// error measure, a span of time, a counter; where a row has none the column is empty.
pub const COLUMNS: [(&str, &str); 54] = [
    ("kind", "run, skip or failure"),
    ("why", "the reason of a skip, or the error of a failure"),
    ("scene", "the scene's name or path"),
    ("frame", "the frame's index"),
    ("method", "the method's id"),
    ("param_NAME", "the value of a parameter"),
    ("quantity", "what was computed, such as direct"),
    ("backend", "cpu, or gpu and its adapter"),
    ("seed", "seed of everything random in the run"),
    ("receivers", "valid receivers that were shaded"),
    ("approximate", "how the method only approximates what was asked, by its own account"),
    ("reference", "the reference that the run was scored against; empty for a run without scores"),
    ("resolved", "whether the error exceeds the reference's own standard error; if not, it is only known to be small"),
    ("score_NAME", "an error measure; `list metrics` tells what each is"),
    ("score_receivers", "receivers that were compared"),
    ("score_version", "version of the error measures"),
    ("time_NAME_median_ns", "median wall time of a phase or of a span within it, nanoseconds"),
    ("time_NAME_low_ns", "lower end of the median's 95% interval, nanoseconds"),
    ("time_NAME_high_ns", "upper end of the median's 95% interval, nanoseconds"),
    ("time_NAME_samples", "how many times it was timed"),
    ("time_NAME_outliers", "samples far from the others; they are among the samples, for a median bears them"),
    ("calibration_NAME_ns", "median time of fixed work done beside each sample, nanoseconds: compute, memory"),
    ("taken", "when the times were taken, seconds since 1970-01-01 UTC"),
    ("beside", "cells that were timed side by side, this one included"),
    ("shared_NAME", "key of the cell for which this phase was carried out when the picture was made"),
    ("derived_ns", "time to build the derived data that were used, charged apart from the phases, nanoseconds"),
    ("count_NAME", "work done, skipped or guarded in one prepare, update, evaluate and read"),
    (
        "twin",
        "key of the same cell on the CPU, on rows of graphics processors; the next columns hold their pictures against each other",
    ),
    ("apart_max", "largest absolute difference of a channel, radiance"),
    ("apart_receiver", "the receiver where it is; empty where nothing differs"),
    ("apart_rmse", "root mean square difference, radiance"),
    ("apart_bias", "mean signed difference, GPU less CPU, radiance"),
    ("apart_level", "root mean square of the CPU's picture, radiance"),
    (
        "apart_not_finite",
        "receivers with a NaN or infinity in one picture, which are not compared, and those valid in one alone",
    ),
    ("apart_error", "why the pictures cannot be compared"),
    ("host_bytes", "main memory held after shading, as the method counts it, bytes"),
    ("device_bytes", "device memory held after shading, as the method counts it, bytes"),
    ("cpu", "the processor's model name"),
    ("cores", "logical cores of the machine"),
    ("threads", "threads that the run used"),
    ("os", "operating system and architecture"),
    ("rustc", "the compiler's version"),
    ("profile", "the build profile, release or debug"),
    ("halflight", "Halflight's version"),
    ("key", "the cell's key, sha-256"),
    ("image", "the picture, images/<image>.exr in the results directory"),
    ("reference_key", "the reference's key, sha-256"),
    ("reference_image", "the reference's picture, images/<reference_image>.exr in the results directory"),
    ("scene_hash", "hash of the scene's content, assets included"),
    ("receivers_hash", "hash of the receivers"),
    ("revision", "hash of the sources that the method is built from"),
    ("timed_on", "the machine class that times hold for"),
    ("params", "all parameters as a JSON object"),
    ("derived", "build time in nanoseconds by derived data as a JSON object"),
];

/// A table.
#[derive(Clone, Debug)]
pub struct Table {
    /// How many rows every column has.
    pub rows: usize,
    /// The columns.
    pub columns: Vec<Column>,
}

/// A named column.
#[derive(Clone, Debug)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What it holds, with the unit.
    pub about: &'static str,
    /// A value a row; none where the row has none.
    pub values: Values,
}

/// The values of a column, of one type.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Words.
    Text(Vec<Option<String>>),
    /// Numbers from 0 without a fraction.
    Count(Vec<Option<u64>>),
    /// Numbers.
    Real(Vec<Option<f64>>),
    /// Yes or no.
    Flag(Vec<Option<bool>>),
}

impl Table {
    /// Everything that a store holds: the latest outcome of every cell with its newest score against each reference, cells
    /// without a score in a row of their own.
    pub fn of(store: &Store) -> Self {
        let mut rows = Vec::new();
        let twins = twins(store);
        for outcome in store.outcomes() {
            let Some(cell) = outcome.cell() else { continue };
            let mut row = Row::default();
            row.cell(cell);
            match outcome {
                Record::Run(run) => {
                    row.run(run);
                    store.times(&cell.key()).into_iter().for_each(|times| row.times(times));
                    twins.iter().filter(|twins| twins.gpu == cell.key()).for_each(|twins| row.twins(twins));
                }
                Record::Skip(skip) => row.absent("skip", &skip.reason),
                Record::Failure(failure) => row.absent("failure", &failure.error),
                Record::Times(_)
                | Record::Score(_)
                | Record::Reference(_)
                | Record::CrossCheck(_)
                | Record::Measured(_) => {}
            }
            let scores = newest(store.scores(&cell.key()));
            rows.extend(scores.iter().map(|score| row.scored(score)));
            if scores.is_empty() {
                rows.push(row);
            }
        }
        Self::from_rows(&rows)
    }

    fn from_rows(rows: &[Row]) -> Self {
        let mut cells: BTreeMap<&(usize, String), Vec<Option<&Value>>> = BTreeMap::new();
        for (i, row) in rows.iter().enumerate() {
            for (place, value) in &row.0 {
                cells.entry(place).or_insert_with(|| vec![None; rows.len()])[i] = Some(value);
            }
        }
        let column = |((place, name), values): (&(usize, String), Vec<Option<&Value>>)| Column {
            name: name.clone(),
            about: COLUMNS[*place].1,
            values: uniform(&values),
        };
        Self { rows: rows.len(), columns: cells.into_iter().map(column).collect() }
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }
}

#[derive(Clone, Debug)]
enum Value {
    Text(String),
    Count(u64),
    Real(f64),
    Flag(bool),
}

/// Values by column: the place in [`COLUMNS`] and the name.
#[derive(Clone, Debug, Default)]
struct Row(BTreeMap<(usize, String), Value>);

impl Row {
    /// Sets the column of this pattern for a name.
    fn set(&mut self, pattern: &str, name: &str, value: Value) {
        let place = COLUMNS.iter().position(|(column, _)| *column == pattern);
        let place = place.expect("every column is declared");
        self.0.insert((place, pattern.replace("NAME", name)), value);
    }

    fn text(&mut self, column: &str, value: impl Into<String>) {
        self.set(column, "", Value::Text(value.into()));
    }

    fn count(&mut self, column: &str, value: u64) {
        self.set(column, "", Value::Count(value));
    }

    fn cell(&mut self, cell: &Cell) {
        self.text("key", cell.key().as_str());
        self.text("scene", &cell.scene);
        self.text("scene_hash", &cell.scene_hash);
        self.text("method", &cell.method);
        self.text("revision", &cell.revision);
        self.text("quantity", &cell.quantity);
        self.text("backend", &cell.backend);
        self.text("receivers_hash", &cell.receivers_hash);
        self.text("timed_on", cell.timed_on.clone().unwrap_or_default());
        self.count("seed", cell.seed);
        self.count("frame", cell.frame.into());
        self.text("params", serde_json::json!(cell.params).to_string());
        for (name, value) in &cell.params {
            let value = match value {
                serde_json::Value::Number(number) => Value::Real(number.as_f64().unwrap_or(f64::NAN)),
                serde_json::Value::Bool(flag) => Value::Flag(*flag),
                serde_json::Value::String(text) => Value::Text(text.clone()),
                other => Value::Text(other.to_string()),
            };
            self.set("param_NAME", name, value);
        }
    }

    fn absent(&mut self, kind: &str, why: &str) {
        self.text("kind", kind);
        self.text("why", why);
    }

    fn run(&mut self, run: &Run) {
        self.text("kind", "run");
        self.count("receivers", run.receivers as u64);
        if let Some(image) = &run.image {
            self.text("image", image.as_str());
        }
        if let Some(approximate) = &run.approximate {
            self.text("approximate", approximate);
        }
        for (phase, bearer) in &run.shared {
            self.set("shared_NAME", phase, Value::Text(bearer.to_string()));
        }
        self.set("derived_ns", "", Value::Real(run.derived.values().sum()));
        self.text("derived", serde_json::json!(run.derived).to_string());
        for (name, count) in &run.counters {
            self.set("count_NAME", name, Value::Count(*count));
        }
        self.count("host_bytes", run.footprint.iter().map(|storage| storage.host_bytes).sum());
        self.count("device_bytes", run.footprint.iter().map(|storage| storage.device_bytes).sum());
        self.environment(&run.environment);
    }

    fn twins(&mut self, twins: &Twins) {
        self.text("twin", twins.cpu.as_str());
        match &twins.apart {
            Ok(apart) => {
                let of = [
                    ("apart_max", apart.max),
                    ("apart_rmse", apart.rmse),
                    ("apart_bias", apart.bias),
                    ("apart_level", apart.level),
                ];
                of.into_iter().for_each(|(column, value)| self.set(column, "", Value::Real(value)));
                apart.worst.into_iter().for_each(|receiver| self.count("apart_receiver", receiver as u64));
                self.count("apart_not_finite", (apart.not_finite + apart.lone) as u64);
            }
            Err(error) => self.text("apart_error", error),
        }
    }

    fn times(&mut self, times: &Times) {
        for (name, timing) in &times.phases {
            let Some(interval) = median_interval(&timing.nanoseconds) else { continue };
            self.set("time_NAME_median_ns", name, Value::Real(interval.median));
            self.set("time_NAME_low_ns", name, Value::Real(interval.low));
            self.set("time_NAME_high_ns", name, Value::Real(interval.high));
            self.set("time_NAME_samples", name, Value::Count(interval.count as u64));
            let far = outliers(&timing.nanoseconds).into_iter().filter(|far| *far).count();
            self.set("time_NAME_outliers", name, Value::Count(far as u64));
        }
        self.count("taken", times.taken);
        self.count("beside", times.beside as u64);
        for (name, samples) in [("compute", &times.calibration.compute), ("memory", &times.calibration.memory)] {
            if let Some(median) = median(samples) {
                self.set("calibration_NAME_ns", name, Value::Real(median));
            }
        }
    }

    fn environment(&mut self, environment: &Environment) {
        self.text("cpu", &environment.cpu);
        self.count("cores", environment.cores as u64);
        self.count("threads", environment.threads as u64);
        self.text("os", &environment.os);
        self.text("rustc", &environment.rustc);
        self.text("profile", &environment.profile);
        self.text("halflight", &environment.halflight);
    }

    /// This row with a score.
    fn scored(&self, score: &Score) -> Self {
        let mut row = self.clone();
        row.text("reference", &score.reference);
        row.text("reference_key", score.reference_key.as_str());
        row.text("reference_image", score.reference_image.as_str());
        row.set("resolved", "", Value::Flag(score.resolved));
        row.count("score_receivers", score.receivers as u64);
        row.count("score_version", score.metrics.into());
        for (name, value) in &score.measures {
            row.set("score_NAME", name, Value::Real(*value));
        }
        row
    }
}

/// The values as one type: that of all of them, or else text.
fn uniform(values: &[Option<&Value>]) -> Values {
    let all = |is: fn(&Value) -> bool| values.iter().flatten().all(|value| is(value));
    if all(|value| matches!(value, Value::Count(_))) {
        let count = |value: &Value| if let Value::Count(count) = value { Some(*count) } else { None };
        Values::Count(values.iter().map(|value| count((*value)?)).collect())
    } else if all(|value| matches!(value, Value::Real(_))) {
        let real = |value: &Value| if let Value::Real(real) = value { Some(*real) } else { None };
        Values::Real(values.iter().map(|value| real((*value)?)).collect())
    } else if all(|value| matches!(value, Value::Flag(_))) {
        let flag = |value: &Value| if let Value::Flag(flag) = value { Some(*flag) } else { None };
        Values::Flag(values.iter().map(|value| flag((*value)?)).collect())
    } else {
        Values::Text(values.iter().map(|value| Some((*value)?.to_string())).collect())
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Value::Text(text) => f.write_str(text),
            Value::Count(count) => write!(f, "{count}"),
            Value::Real(real) => f.write_str(&real_text(*real)),
            Value::Flag(flag) => write!(f, "{flag}"),
        }
    }
}

/// The shortest text that reads back as the same number.
fn real_text(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
