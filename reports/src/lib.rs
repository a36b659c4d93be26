//! One self-contained HTML page from a results directory: who was how far off, at what cost.
//!
//! [`build`] reads everything from the store, references included, so a report can be made again from the directory
//! alone; [`Report::html`] renders it. The page loads nothing from anywhere.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let store = halflight_results::Store::open("halflight-out")?;
//! let report = halflight_reports::build(&store, "Halflight: quick suite");
//! report.write(&store.dir().join("report.html"))?;
//! # Ok(())
//! # }
//! ```

mod backends;
mod budget;
mod calibration;
mod chip;
mod collect;
mod criterion;
mod crosschecks;
mod figures;
mod format;
mod fronts;
mod labels;
mod lines;
mod page;
mod pareto;
mod plot;
mod raster;
mod rates;
mod report;
mod scaling;
mod sheet;
mod summary;
mod tables;
mod threads;

pub use backends::{Twins, twins};
pub use budget::{Budget, BudgetStep};
pub use collect::{build, outline};
pub use criterion::{Benchmark, CriterionError, read_criterion};
pub use format::plus_minus;
pub use fronts::{Against, Entry, Front, Relative};
pub use lines::{Axis, Mark, Plot, Series};
pub use rates::{Rate, Reached};
pub use report::{Absent, CrossCheck, Reference, Report, ReportError, Row, Scene};
pub use scaling::{Fit, Scaling};
pub use sheet::{Sheet, Shown};
