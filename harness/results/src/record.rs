//! The kinds of line in `results.jsonl`.

use crate::Key;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of the line format; written as `schema` on every line. Lines of another are refused by name.
///
/// Version 1 had times on the line of the run, taken one cell after another: they cannot become [`Times`], and results are
/// quicker made again than guessed at.
pub const SCHEMA: u32 = 2;

/// What the names of graphics processors in software end with in [`Cell::backend`].
pub const CORRECTNESS_ONLY: &str = "correctness only";

/// A method's parameters, by name.
pub type Params = BTreeMap<String, serde_json::Value>;

/// One line of `results.jsonl`; `kind` says which.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Record {
    /// A cell that was run.
    Run(Box<Run>),
    /// A cell that was not run, with the reason.
    Skip(Skip),
    /// A cell whose run failed.
    Failure(Failure),
    /// The times of a run.
    Times(Box<Times>),
    /// The errors of a run's picture against one reference.
    Score(Score),
    /// A reference that was made, and what it took.
    Reference(ReferenceMade),
    /// What another program says to the truth.
    CrossCheck(Box<CrossCheck>),
    /// A figure of a claim that is held against a paper's.
    Measured(Box<Measured>),
}

impl Record {
    /// The cell that a run, skip or failure is about; none for what is said about a run later, a reference, a cross-check or a claim.
    pub fn cell(&self) -> Option<&Cell> {
        match self {
            Record::Run(run) => Some(&run.cell),
            Record::Skip(skip) => Some(&skip.cell),
            Record::Failure(failure) => Some(&failure.cell),
            Record::Times(_)
            | Record::Score(_)
            | Record::Reference(_)
            | Record::CrossCheck(_)
            | Record::Measured(_) => None,
        }
    }
}

/// One cell of a plan: everything that decides what a run computes, and hence its [`Cell::key`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// The scene's name or path, for people: not part of the key.
    pub scene: String,
    /// Hash of the scene's content, assets included.
    pub scene_hash: String,
    /// The method's id, `family/variant`.
    pub method: String,
    /// The method's revision: a hash of the sources that it is built from.
    pub revision: String,
    /// Its parameters, defaults included.
    pub params: Params,
    /// `cpu`, or `gpu: ` and the adapter, with `correctness only` where it is software.
    pub backend: String,
    /// What was computed, such as `direct`.
    pub quantity: String,
    /// The seed of everything random in the run.
    pub seed: u64,
    /// The frame's index.
    pub frame: u32,
    /// Hash of the receivers.
    pub receivers_hash: String,
    /// Where times were taken ([`Environment::class`]); none where a cell's times are of no interest.
    pub timed_on: Option<String>,
}

impl Cell {
    /// The key of this cell: two cells have the same key exactly when all their fields but the scene's name are equal.
    ///
    /// ```
    /// use halflight_results::Cell;
    /// let cell = Cell { method: "shexp/hyb".into(), ..Cell::default() };
    /// let renamed = Cell { scene: "another name".into(), ..cell.clone() };
    /// let other = Cell { seed: 1, ..cell.clone() };
    /// assert_eq!(cell.key(), renamed.key());
    /// assert_ne!(cell.key(), other.key());
    /// ```
    pub fn key(&self) -> Key {
        let nameless = Self { scene: String::new(), ..self.clone() };
        Key::of(&nameless).expect("strings, numbers and JSON values have a JSON form")
    }

    /// The cell without where it runs and is timed: equal for the same work on two backends.
    #[must_use]
    pub fn anywhere(&self) -> Self {
        Self { scene: String::new(), backend: String::new(), timed_on: None, ..self.clone() }
    }

    /// Whether it is of a graphics processor, or of what stands for one.
    pub fn is_gpu(&self) -> bool {
        self.backend.starts_with("gpu")
    }

    /// Whether the processor's cores stood for a graphics processor: results count, times do not.
    pub fn is_software(&self) -> bool {
        self.backend.ends_with(CORRECTNESS_ONLY)
    }
}

/// A finished run of one cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// What was run.
    #[serde(flatten)]
    pub cell: Cell,
    /// How many receivers were shaded.
    pub receivers: usize,
    /// The picture, `images/<image>.exr`; none where the quantity is not a picture.
    pub image: Option<Key>,
    /// Why the method serves this scene only approximately, where it says so.
    pub approximate: Option<String>,
    /// Phases that were carried out for another cell, and served this one's picture too: by the phase's name the key of that
    /// cell. Each cell is timed by itself all the same.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub shared: BTreeMap<String, Key>,
    /// Build time in nanoseconds of each piece of derived data used, charged apart from the phases. A piece that came
    /// from a cache keeps the time that building it took.
    pub derived: BTreeMap<String, f64>,
    /// Work done, skipped and guarded, by name.
    pub counters: BTreeMap<String, u64>,
    /// Memory held after shading, by purpose, as the method counts it.
    pub footprint: Vec<Storage>,
    /// Where it ran.
    pub environment: Environment,
}

/// The times of a run, taken in rounds beside those of other cells, so that what slows the machine for a while slows all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// The run's cell key.
    pub run: Key,
    /// Seconds since 1970-01-01 UTC when the last round ended.
    pub taken: u64,
    /// Cells that took part in the rounds, this one included.
    pub beside: usize,
    /// Times by span. The whole of a phase bears the phase's own name (`prepare`, `update`, `shade`); any other name is a
    /// span inside the phase that it states.
    pub phases: BTreeMap<String, Timing>,
    /// How fast the machine was meanwhile.
    pub calibration: Calibration,
}

/// Wall times in nanoseconds of two fixed pieces of work on as many threads as the run used, one sample a round.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Multiplications and additions in registers: tells of the clock's frequency and of others on the same core.
    pub compute: Vec<f64>,
    /// Reading memory in order: tells of others on the same memory.
    pub memory: Vec<f64>,
}

/// The three phases of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// Once a scene.
    Prepare,
    /// Once a frame: all that a moving scene forces.
    Update,
    /// Per receiver.
    Shade,
}

impl Phase {
    /// All phases in the order in which they run.
    pub const ALL: [Phase; 3] = [Phase::Prepare, Phase::Update, Phase::Shade];

    /// The name under which the whole phase is timed.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Prepare => "prepare",
            Phase::Update => "update",
            Phase::Shade => "shade",
        }
    }
}

/// All samples of one span.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The phase in which the span lies.
    pub phase: Phase,
    /// Wall time of every repeat, in nanoseconds, in the order taken.
    pub nanoseconds: Vec<f64>,
}

/// Memory held for one purpose.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Storage {
    /// What it is for.
    pub purpose: String,
    /// Bytes in main memory.
    pub host_bytes: u64,
    /// Bytes on the device.
    pub device_bytes: u64,
}

/// The machine and the build.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Environment {
    /// The processor's model name.
    pub cpu: String,
    /// Logical cores of the machine.
    pub cores: usize,
    /// Threads that the run used.
    pub threads: usize,
    /// Operating system and architecture.
    pub os: String,
    /// The compiler's version.
    pub rustc: String,
    /// The build profile, `release` or `debug`.
    pub profile: String,
    /// Halflight's version.
    pub halflight: String,
}

impl Environment {
    /// What times depend on, as one text for [`Cell::timed_on`]: processor, threads, compiler and profile.
    pub fn class(&self) -> String {
        format!("{} | {} threads | {} | {} | {}", self.cpu, self.threads, self.os, self.rustc, self.profile)
    }
}

/// A cell that was not run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Skip {
    /// What would have been run.
    #[serde(flatten)]
    pub cell: Cell,
    /// Why it was not.
    pub reason: String,
}

/// A cell whose run ended with an error.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// What was run.
    #[serde(flatten)]
    pub cell: Cell,
    /// The error's message.
    pub error: String,
}

/// The errors of one picture against one reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// The run's cell key.
    pub run: Key,
    /// The picture that was scored. A run made again with another picture makes the score stale.
    pub image: Key,
    /// The reference's id, such as `truth`.
    pub reference: String,
    /// The reference's key: scene, receivers, frame, samples, seed and revision.
    pub reference_key: Key,
    /// The reference's picture in the same store: `images/<reference_image>.exr`.
    pub reference_image: Key,
    /// Version of the error measures.
    pub metrics: u32,
    /// Receivers valid in both pictures.
    pub receivers: usize,
    /// Whether the difference exceeds the reference's own standard error.
    pub resolved: bool,
    /// Every error measure by name, the reference's standard error among them.
    pub measures: BTreeMap<String, f64>,
}

/// A reference that was made: how long it took, to tell how long others may take.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceMade {
    /// The scene's name or path.
    pub scene: String,
    /// Hash of the scene's content, assets included.
    pub scene_hash: String,
    /// The frame's index.
    pub frame: u32,
    /// The reference's id, such as `truth`.
    pub reference: String,
    /// The reference's key.
    pub reference_key: Key,
    /// Which light, such as `direct`.
    pub quantity: String,
    /// The frame's receivers, valid or not.
    pub receivers: usize,
    /// Wall time, nanoseconds.
    pub nanoseconds: f64,
    /// Where it was made.
    pub environment: Environment,
}

/// The truth of a scene held against what another program finds at the same receivers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrossCheck {
    /// The scene's name or path.
    pub scene: String,
    /// Hash of the scene's content, assets included.
    pub scene_hash: String,
    /// The frame's index.
    pub frame: u32,
    /// What was computed, such as `direct`.
    pub quantity: String,
    /// The other program, with its version.
    pub program: String,
    /// Samples a receiver: ours, theirs.
    pub samples: [u32; 2],
    /// The truth, in the same store: `images/<ours>.exr`.
    pub ours: Key,
    /// What the other program finds.
    pub theirs: Key,
    /// A picture of each receiver's p: the probability of differences at least as large in any channel.
    pub receiver_p: Key,
    /// Receivers tested.
    pub receivers: usize,
    /// Largest |z| of any receiver and channel; none where there is a difference that chance cannot make.
    pub largest: Option<f64>,
    /// Probability that honest receivers have such an outlier.
    pub family_p: f64,
    /// Mean difference over receivers, a channel: the truth's excess.
    pub bias: [f64; 3],
    /// Standard error of `bias`.
    pub bias_error: [f64; 3],
    /// Probability that `bias` is so far from zero.
    pub bias_p: f64,
    /// Mean over receivers and channels of what the other program finds.
    pub level: f64,
    /// Probability that honest programs differ as much by either measure.
    pub p: f64,
    /// Whether `p` is above the level of the test.
    pub agrees: bool,
}

impl CrossCheck {
    /// Whether another check is of the same scene, frame and quantity with the same program.
    pub fn same_subject(&self, other: &CrossCheck) -> bool {
        let place = |check: &CrossCheck| (check.scene_hash.clone(), check.frame);
        let kind = |check: &CrossCheck| (check.quantity.clone(), check.program.clone());
        place(self) == place(other) && kind(self) == kind(other)
    }
}

/// A figure that was measured to hold a paper's claim against it; those of a claim that were taken together bear the same `taken`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The claim's id, such as `S1`.
    pub row: String,
    /// What was measured, in words that are the same whenever it is measured.
    pub quantity: String,
    /// Its unit; empty for numbers and ratios.
    pub unit: String,
    /// The figure.
    pub value: f64,
    /// Ends of the 95% interval; none for what is counted or computed and has no spread.
    pub interval: Option<[f64; 2]>,
    /// Rounds, receivers or cases that the figure comes from.
    pub samples: u64,
    /// The command that measures it.
    pub command: String,
    /// Hash of the sources of the methods that it is about.
    pub revision: String,
    /// Seconds since 1970-01-01 UTC when the claim's measurement ended.
    pub taken: u64,
    /// Where it was measured.
    pub environment: Environment,
}
