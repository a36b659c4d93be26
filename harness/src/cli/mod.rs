//! The command line. Exit codes: 0 all is well, 1 cells failed, pictures differ or references are not as they should be, 2 the request cannot be carried out.

mod accuracy;
mod bless;
mod budget;
mod count;
mod crosscheck;
mod diff;
mod doctor;
mod export;
mod figure;
mod gate;
mod import;
mod ledger;
mod list;
mod measured;
mod merge;
mod pareto;
mod paths;
mod plan;
mod probe;
mod refs;
mod report;
mod run;
mod scaling;
mod score;
mod table;
mod threads;

use crate::Where;
use crate::plan::{Plan as Work, Terms};
use crate::select::Selection;
use crate::settings::Setting;
use clap::{Args, Parser, Subcommand};
use halflight_references::Quality;
use halflight_results::Environment;
use std::path::PathBuf;
use std::process::ExitCode;
use threads::Threads;

/// The laboratory bench for low-frequency light: soft-shadow methods on shared scenes, held against ray-traced references.
#[derive(Parser)]
#[command(name = "halflight", version)]
struct Cli {
    /// Threads for all work; all cores if not given. Results do not depend on it, but times do: `run` takes several numbers,
    /// such as 1,all, and times every cell on each
    #[arg(long, global = true, value_name = "N", value_delimiter = ',')]
    threads: Vec<Threads>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run what is not in the results yet, score it, and write the report (the default: the `quick` suite)
    Run(run::Run),
    /// Time cells that differ in one number (the default: the `scaling` suite) and fit power laws to their times
    Scaling(scaling::Scaling),
    /// Print every cell and what would be done about it, without doing it
    Plan(plan::Plan),
    /// Make the report again from a results directory
    Report(report::Report),
    /// Print which settings no other beats: error against time and against memory, on every scene and over scenes
    Pareto(pareto::Pareto),
    /// Score stored pictures again against their stored references, where the error measures are newer than the scores
    Score(score::Score),
    /// Put the results of several directories into one
    Merge(merge::Merge),
    /// Print radiance, or a reference's, at given points
    Probe(probe::Probe),
    /// Walk from the truth to a method, one approximation a step, and say what each adds to the error
    Budget(budget::Budget),
    /// Make, check, list or clear away references
    Refs(refs::Refs),
    /// Run what is not in the results yet (the default: the `gate` suite) and hold all of it against the baselines
    Gate(gate::Gate),
    /// Shade a small frame, for valgrind to count its instructions
    #[command(hide = true)]
    Count(count::Count),
    /// Make what was measured the baselines, and say what changes
    Bless(bless::Bless),
    /// Compare two EXR pictures, or the pictures of two results directories
    Diff(diff::Diff),
    /// Make a scene of models (glTF, OBJ, OFF, PLY) and a picture of the surroundings
    Import(import::Import),
    /// Write the results as a table, a scene as glTF, or one for another renderer with receivers and their truth to hold that
    /// against
    Export(export::Export),
    /// Hold the truth against what another renderer found in an exported scene
    Crosscheck(crosscheck::Check),
    /// Measure how accurate an algebra is, and hold it against what is stated of it
    Accuracy(accuracy::Accuracy),
    /// Hold a paper's claims against what was measured of them: write the ledger from stored figures, or take them
    Ledger(ledger::Ledger),
    /// Compare devices: write the page of what was measured on them, or measure this one
    Measured(measured::Page),
    /// Make the page of a paper's figure or table, or list those that there are
    Figure(figure::Figure),
    /// List what there is
    List(list::List),
    /// Show the machine, the build and the folders, and verify the shipped scenes
    Doctor(doctor::Doctor),
}

/// What to run; without any of these, the `quick` suite.
#[derive(Args)]
struct Pick {
    /// A suite: a shipped one's name, or the path of a TOML file
    #[arg(long, conflicts_with_all = ["scene", "method", "set", "reference", "quantity"])]
    suite: Option<String>,
    /// A scene, repeatable: a shipped one's name, or the path of a scene file; all shipped ones if not given
    #[arg(long, value_name = "SCENE")]
    scene: Vec<String>,
    /// A method, repeatable: an id, or family/* for those of a family; all if not given
    #[arg(long, value_name = "METHOD")]
    method: Vec<String>,
    /// Values of a parameter, repeatable, for the methods that declare it: order=4, order=2..6, p=2,4, self-shadow=all,
    /// spheres=log(16..256,5) for 5 values of equal ratio, min-angle=lin(0..4,3) for equal steps
    #[arg(long, value_name = "NAME=VALUES")]
    set: Vec<Setting>,
    /// A reference, repeatable: truth, sh-light, sphere-proxies (bare names take the method's order and spheres), sh-light:6
    #[arg(long, value_name = "REFERENCE")]
    reference: Vec<String>,
    /// What is computed, repeatable: direct, indirect-N by N bounces, total; direct if not given
    #[arg(long, value_name = "QUANTITY")]
    quantity: Vec<String>,
    /// Where methods run
    #[arg(long, value_enum, default_value_t = Where::Cpu)]
    backend: Where,
    /// The graphics processor, by its number or part of its name; the first that `doctor` lists if not given
    #[arg(long, value_name = "ADAPTER")]
    adapter: Option<String>,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Pick {
    /// These arguments again, as on the command line.
    fn words(&self) -> String {
        let all = |name: &str, values: &[String]| values.iter().map(|v| format!(" --{name} {v}")).collect::<String>();
        let suite = self.suite.as_slice();
        let lists = [("suite", suite), ("scene", &self.scene), ("method", &self.method), ("quantity", &self.quantity)];
        let lists = lists.iter().map(|(name, values)| all(name, values)).collect::<String>();
        lists
            + &all("set", &self.set.iter().map(ToString::to_string).collect::<Vec<_>>())
            + &all("reference", &self.reference)
            + &if self.backend == Where::Cpu {
                String::new()
            } else {
                format!(" --backend {:?}", self.backend).to_lowercase()
            }
            + &all("adapter", self.adapter.as_slice())
    }

    /// What is asked for, this suite if nothing is, to be timed on each of these numbers of threads; on those of all work if
    /// there is none.
    ///
    /// # Errors
    /// As [`Work::new`].
    fn plan(&self, suite: &str, threads: &[usize]) -> Result<Work, crate::Error> {
        let environment = crate::environment();
        let terms = Terms { seed: self.seed, timed_on: environment.class() };
        let mut selection = self.selection();
        if selection.names_nothing() {
            selection.suite = Some(suite.to_owned());
        }
        let plan = Work::new(&selection.entries()?, &terms)?;
        let class = |threads| Environment { threads, ..environment.clone() }.class();
        let plan = if threads.is_empty() { plan } else { plan.on_threads(threads, class) };
        if self.backend == Where::Cpu {
            return Ok(plan);
        }
        Ok(plan.on_backends(self.backend, &crate::processor(self.adapter.as_deref())?))
    }

    fn selection(&self) -> Selection {
        Selection {
            suite: self.suite.clone(),
            scenes: self.scene.clone(),
            methods: self.method.clone(),
            set: self.set.clone(),
            quantities: self.quantity.clone(),
            references: self.reference.clone(),
        }
    }
}

/// Where results go.
#[derive(Args)]
struct Out {
    /// Results directory
    #[arg(long, value_name = "DIR", default_value = "halflight-out")]
    out: PathBuf,
}

/// Where derived data and references are kept between runs.
#[derive(Args)]
struct CacheDir {
    /// Cache folder; $XDG_CACHE_HOME/halflight or ~/.cache/halflight if not given
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
}

/// How good references are to be.
#[derive(Args)]
struct HowGood {
    /// Standard error that references are to reach at every receiver, relative to the scene's mean level
    #[arg(long, value_name = "E")]
    standard_error: Option<f32>,
    /// Most samples a receiver, 65536 if not given; without --standard-error all receivers take so many
    #[arg(long, value_name = "N")]
    samples: Option<u32>,
}

impl HowGood {
    fn quality(&self) -> anyhow::Result<Quality> {
        let quality = match (self.standard_error, self.samples) {
            (None, None) => Quality::default(),
            (None, Some(samples)) => Quality::fixed(samples),
            (Some(standard_error), samples) => {
                let (least, most) = (Quality::default().min_samples, samples.unwrap_or(1 << 16));
                Quality { standard_error, min_samples: least.min(most), max_samples: most, ..Quality::default() }
            }
        };
        quality.check()?;
        Ok(quality)
    }
}

/// How a command that was carried out ended.
enum Ending {
    /// All is well.
    Well,
    /// Cells failed, pictures differ, or references are not as they should be.
    Differs,
}

/// Runs the program.
pub fn main() -> ExitCode {
    match act(Cli::parse()) {
        Ok(Ending::Well) => ExitCode::SUCCESS,
        Ok(Ending::Differs) => ExitCode::from(1),
        Err(error) => {
            eprintln!("halflight: {}", one_line(&error));
            ExitCode::from(2)
        }
    }
}

/// An error and its causes on one line; a cause that the error tells already is not told again.
fn one_line(error: &anyhow::Error) -> String {
    let mut line = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if line.is_empty() {
            line = cause;
        } else if !line.contains(&cause) {
            line += &format!(": {cause}");
        }
    }
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn act(cli: Cli) -> anyhow::Result<Ending> {
    let may_be_several = matches!(cli.command, None | Some(Command::Run(_) | Command::Plan(_) | Command::Scaling(_)));
    let threads = threads::settle(&cli.threads, may_be_several)?;
    match cli.command {
        None => run::Run::plain()?.act(&threads),
        Some(Command::Run(run)) => run.act(&threads),
        Some(Command::Scaling(scaling)) => scaling.act(&threads),
        Some(Command::Plan(plan)) => plan.act(&threads),
        Some(Command::Report(report)) => report.act(),
        Some(Command::Pareto(pareto)) => pareto.act(),
        Some(Command::Score(score)) => score.act(),
        Some(Command::Merge(merge)) => merge.act(),
        Some(Command::Probe(probe)) => probe.act(),
        Some(Command::Budget(budget)) => budget.act(),
        Some(Command::Refs(refs)) => refs.act(),
        Some(Command::Gate(gate)) => gate.act(),
        Some(Command::Count(count)) => count.act(),
        Some(Command::Bless(bless)) => bless.act(),
        Some(Command::Diff(diff)) => diff.act(),
        Some(Command::Import(import)) => import.act(),
        Some(Command::Export(export)) => export.act(),
        Some(Command::Crosscheck(check)) => check.act(),
        Some(Command::Accuracy(accuracy)) => accuracy.act(),
        Some(Command::Ledger(ledger)) => ledger.act(),
        Some(Command::Measured(measured)) => measured.act(&threads),
        Some(Command::Figure(figure)) => figure.act(),
        Some(Command::List(list)) => list.act(),
        Some(Command::Doctor(doctor)) => doctor.act(),
    }
}

/// Prints a line to standard output; a reader that has gone away, such as `head`, is no error.
fn say(line: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stdout(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_told_once() {
        let error = anyhow::anyhow!("no such folder").context("a.toml: no such folder").context("scene a");
        assert_eq!(one_line(&error), "scene a: a.toml: no such folder");
    }

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }
}
