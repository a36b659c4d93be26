//! What a report holds: plain data, assembled by [`crate::build`].

use crate::{Benchmark, Rate, Scaling};
use halflight_metrics::{Interval, median_interval};
use halflight_results::{Cell, Environment, Picture, Run, Score, Times, Timing};
use std::path::{Path, PathBuf};

/// Everything that the page shows.
#[derive(Clone, Debug)]
pub struct Report {
    /// The page's title.
    pub title: String,
    /// The machines and builds of the runs, without repetitions.
    pub environments: Vec<Environment>,
    /// The settings compared: a method with the parameters that tell it from its siblings. A place in this list numbers a
    /// setting from 1 on the whole page.
    pub labels: Vec<String>,
    /// The method of each label.
    pub methods: Vec<String>,
    /// Each label without where it ran: equal for the same setting on two backends.
    pub settings: Vec<String>,
    /// One section a scene and frame.
    pub scenes: Vec<Scene>,
    /// What other programs say to the truth.
    pub cross_checks: Vec<CrossCheck>,
    /// How cost grows with one number; [`crate::build`] leaves it to its caller to find out.
    pub scalings: Vec<Scaling>,
    /// What `cargo bench` measured; left to the caller, too.
    pub benchmarks: Vec<Benchmark>,
    /// The papers' frame rates beside those of these results; left to the caller, too.
    pub rates: Vec<Rate>,
    /// Cells that were skipped.
    pub skips: Vec<Absent>,
    /// Cells that failed.
    pub failures: Vec<Absent>,
    /// What was wrong with the store, for the reader to know.
    pub warnings: Vec<String>,
}

/// One scene at one frame, seen at one set of receivers.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name, with the frame or a hash where the name alone is ambiguous.
    pub name: String,
    /// The references that its runs were scored against; `truth` first.
    pub references: Vec<Reference>,
    /// Its runs, ordered by label.
    pub rows: Vec<Row>,
}

/// A reference of a scene.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Its id, such as `truth`.
    pub id: String,
    /// Its picture; none where the file is missing or damaged.
    pub picture: Option<Picture>,
}

/// One run.
#[derive(Clone, Debug)]
pub struct Row {
    /// Place in [`Report::labels`].
    pub label: usize,
    /// The run's record.
    pub run: Run,
    /// Its picture; none where there is none or its file is missing or damaged.
    pub picture: Option<Picture>,
    /// Its times; none where it was not timed yet.
    pub times: Option<Times>,
    /// Its scores, one a reference.
    pub scores: Vec<Score>,
}

/// What another program says to the truth. Pictures are none where a file is missing or damaged.
#[derive(Clone, Debug)]
pub struct CrossCheck {
    /// The record.
    pub record: halflight_results::CrossCheck,
    /// The truth.
    pub ours: Option<Picture>,
    /// The other program's picture.
    pub theirs: Option<Picture>,
    /// The probability of the difference at each receiver.
    pub receiver_p: Option<Picture>,
}

/// A cell without a run.
#[derive(Clone, Debug)]
pub struct Absent {
    /// The cell.
    pub cell: Cell,
    /// Its scene's section name.
    pub scene: String,
    /// Place in [`Report::labels`].
    pub label: usize,
    /// The reason of a skip or the error of a failure.
    pub why: String,
}

/// Why a report could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The page could not be written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A picture could not be encoded.
    #[error("encoding a picture as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// A plot could not be drawn.
    #[error("drawing a plot: {0}")]
    Plot(String),
}

impl Report {
    /// A report of nothing.
    pub fn empty(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            environments: Vec::new(),
            labels: Vec::new(),
            methods: Vec::new(),
            settings: Vec::new(),
            scenes: Vec::new(),
            cross_checks: Vec::new(),
            scalings: Vec::new(),
            benchmarks: Vec::new(),
            rates: Vec::new(),
            skips: Vec::new(),
            failures: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The page.
    ///
    /// # Errors
    /// A picture could not be encoded or a plot not be drawn.
    pub fn html(&self) -> Result<String, ReportError> {
        crate::page::html(self)
    }

    /// Writes the page; an older one is replaced whole or not at all.
    ///
    /// # Errors
    /// The page could not be made or written.
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        replace(path, &self.html()?)
    }
}

/// Writes a page, beside its place first, so that an older page is replaced whole or not at all.
pub(crate) fn replace(path: &Path, html: &str) -> Result<(), ReportError> {
    let beside = path.with_extension(format!("{}.tmp", std::process::id()));
    std::fs::write(&beside, html).and_then(|()| std::fs::rename(&beside, path)).map_err(|source| {
        // The first error is the one to report.
        let _ = std::fs::remove_file(&beside);
        ReportError::Io { path: path.to_owned(), source }
    })
}

impl Scene {
    /// The id of the reference that the summary, the pictures and the plot use: `truth`, or else the first there is.
    pub fn main_reference(&self) -> Option<&str> {
        self.references.first().map(|r| r.id.as_str())
    }

    /// The standard error of a reference, the largest stated by its scores.
    pub(crate) fn standard_error(&self, reference: &str) -> f64 {
        let stated = self.rows.iter().filter_map(|row| row.measure(reference, "reference_standard_error"));
        stated.fold(0.0, f64::max)
    }
}

impl Row {
    /// The score against a reference.
    pub fn score(&self, reference: &str) -> Option<&Score> {
        self.scores.iter().find(|s| s.reference == reference)
    }

    /// An error measure against a reference.
    pub fn measure(&self, reference: &str, name: &str) -> Option<f64> {
        self.score(reference)?.measures.get(name).copied()
    }

    /// The median shade time with its interval, in nanoseconds.
    pub(crate) fn shade_time(&self) -> Option<Interval> {
        median_interval(&self.span("shade")?.nanoseconds)
    }

    /// The samples of a phase or of a span within one.
    pub fn span(&self, name: &str) -> Option<&Timing> {
        self.times.as_ref()?.phases.get(name)
    }
}
