//! The laboratory bench for low-frequency light: plans which methods run on which scenes, runs them, holds their pictures
//! against references, and keeps the results. The program `halflight` is a thin shell over this library.
//!
//! The way of the data, a file a step:
//!
//! | step | file | from → to |
//! |---|---|---|
//! | select | `select.rs`, `suite.rs`, `settings.rs` | command line or suite file → entries |
//! | plan | `plan.rs`, `judge.rs` | entries → cells, each run, cached or skipped with its reason |
//! | execute | `execute.rs`, `recorder.rs` | cell → picture, counters, memory |
//! | time | `run/timing.rs`, `rounds.rs`, `calibrate.rs` | cells → their times, side by side |
//! | score | `score.rs` | picture and reference → error measures |
//! | forecast | `todo.rs`, `forecast.rs` | what is left of a plan and a store → how long it may take |
//! | table | `table.rs` | a store → rows of a CSV or Parquet file |
//! | run | `run.rs` | all of it, into a [`Store`](halflight_results::Store) line by line |
//! | ledger | `ledger/` | a paper's claims → figures in a store → a page of verdicts |
//! | rates | `rates.rs` | a store → frames a second, beside those that papers print |
//! | measured | `measured/` | a store → the file of a device; all files → the page that compares them |
//! | figures | `figures/` | a paper's figures and tables → a page each |
//! | gate | `gate/` | what a store holds, against baselines |
//!
//! A cell is scene × method × parameters × backend × quantity × frame. Its key holds what decides its result and, since
//! results carry times, where they were taken: another machine class (processor, threads, compiler, profile) runs cells anew.
//! A key that is in the store is not run again; scores are lines of their own, and only missing ones are made.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use halflight::{Options, Plan, Selection, Terms, environment};
//! use halflight_results::Store;
//!
//! let selection = Selection { scenes: vec!["bunny-studio".into()], set: vec!["order=2..6".parse()?], ..Default::default() };
//! let plan = Plan::new(&selection.entries()?, &Terms { seed: 1, timed_on: environment().class() })?;
//! let mut store = Store::open("out")?;
//! let summary = halflight::run(&plan, &mut store, &Options::new("cache"))?;
//! println!("{} cells run, {} failed", summary.ran, summary.failed);
//! # Ok(())
//! # }
//! ```

mod backends;
mod budget;
mod calibrate;
pub mod cli;
mod crosscheck;
mod environment;
mod error;
mod execute;
mod export;
pub mod figures;
mod forecast;
pub mod gate;
mod judge;
pub mod ledger;
pub mod measured;
mod plan;
mod priority;
mod probe;
mod progress;
mod rates;
mod recorder;
pub mod refs;
mod rescore;
mod rounds;
mod run;
pub mod scaling;
mod score;
mod select;
mod settings;
mod suite;
mod sway;
mod table;
mod todo;

pub use backends::{Processor, Where, processor};
pub use budget::{
    budget,
    chain::{Step, Walk, What, walk},
};
pub use crosscheck::{SIGNIFICANCE, cross_check};
pub use environment::{cpu_features, environment};
pub use error::Error;
pub use export::{Check, export_to_mitsuba};
pub use plan::{Group, Plan, Stage, State, Terms};
pub use probe::{Answers, Question, Source, probe};
pub use rescore::{Rescored, rescore};
pub use run::{Options, Summary, run};
pub use select::{DEFAULT_SUITE, Selection};
pub use settings::{Series, Setting};
pub use suite::{DEFAULT_REFERENCES, Entry, Suite};
pub use table::{COLUMNS, Column, Table, Values};
