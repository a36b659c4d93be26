//! Instruction counts: what shading a small frame takes, as valgrind counts it. Unlike times they do not depend on what else
//! a machine does, so they show the slowdowns by percents that times cannot.
//!
//! Valgrind pretends to be a processor with AVX2 and without AVX-512, whatever the true one has beyond; so counts differ by
//! compiler and profile, and hardly by machine. Those that were taken with something else are not compared.

use crate::Error;
use crate::execute::{Task, evaluate, prepare_once, update};
use crate::plan;
use crate::recorder::{Recorded, Recorder};
use halflight_contract::{Backend, Cache, Params, Quantity, Request, Support};
use halflight_results::Key;
use halflight_scenes::Rgb;
use rayon::ThreadPoolBuilder;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;
use std::process::Command;

/// How much of a count may be added before it fails: other versions of the mathematical library differ by less.
pub const MORE: f64 = 0.01;

/// Small scenes, of which the first that a method serves is shaded.
const SCENES: [&str; 2] = ["spheres-60@0.25", "trench"];

/// The function whose instructions are counted, those of what it calls included.
const COUNTED: &str = "*instructions::counted*";

/// Instructions by method, and what they were counted with.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instructions {
    /// Compiler, profile and vector extensions.
    pub with: String,
    /// By method, at its defaults.
    pub counts: BTreeMap<String, u64>,
}

impl Instructions {
    /// The command that counts a method's again.
    pub(crate) fn command(method: &str) -> String {
        format!(
            "valgrind --tool=callgrind --collect-atstart=no '--toggle-collect={COUNTED}' halflight count --method {method}"
        )
    }
}

/// Counts the instructions of every registered method; `None` where there is no valgrind.
///
/// # Errors
/// Valgrind or this program failed under it.
pub fn count() -> Result<Option<Instructions>, Error> {
    let mut instructions = Instructions::default();
    let folder = std::env::temp_dir().join(format!("halflight-instructions-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|source| Error::Io { path: folder.clone(), source })?;
    for method in halflight_registry::methods().iter().map(|method| method.info().id) {
        let counted = count_one(method, &folder.join("callgrind.out"));
        let Some((with, count)) = counted.inspect_err(|_| clear(&folder))? else {
            clear(&folder);
            return Ok(None);
        };
        instructions.with = with;
        instructions.counts.insert(method.to_owned(), count);
    }
    clear(&folder);
    Ok(Some(instructions))
}

/// What is left in a folder for passing files does no harm.
fn clear(folder: &Path) {
    let _ = std::fs::remove_dir_all(folder);
}

fn count_one(method: &str, file: &Path) -> Result<Option<(String, u64)>, Error> {
    let program = std::env::current_exe().map_err(|source| Error::Io { path: "halflight".into(), source })?;
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--collect-atstart=no", &format!("--toggle-collect={COUNTED}")]);
    command.arg(format!("--callgrind-out-file={}", file.display()));
    let output = match command.arg(program).args(["count", "--method", method]).output() {
        Ok(output) => output,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(Error::Io { path: "valgrind".into(), source }),
    };
    let failed = |why: &str| Error::Other(format!("valgrind: halflight count --method {method}: {why}"));
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(failed(said.lines().last().unwrap_or("it failed without a word")));
    }
    let text = std::fs::read_to_string(file).map_err(|source| Error::Io { path: file.to_owned(), source })?;
    let count = total(&text).ok_or_else(|| failed("expected a `totals:` above zero in callgrind's file"))?;
    Ok(Some((String::from_utf8_lossy(&output.stdout).trim().to_owned(), count)))
}

/// The sum in a file of callgrind's.
fn total(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("totals: "))?;
    line.trim().parse().ok().filter(|total| *total > 0)
}

/// Shades a small frame on one thread, the second time to be counted; says what with.
///
/// # Errors
/// The method is unknown, serves none of the small scenes, or fails.
pub(crate) fn shade(id: &str) -> Result<String, Error> {
    let method = plan::method(id)?;
    let params = Params::defaults(method.info().params);
    let (quantity, backend, cache) = (Quantity::Direct, Backend::Cpu, Cache::in_memory());
    let scenes: Vec<_> = SCENES.iter().map(|name| halflight_scenes::find(name)).collect::<Result<_, _>>()?;
    let request = Request { quantity, backend, params: &params };
    let serves =
        |scene: &&halflight_scenes::Scene| !matches!(method.supports(&scene.facts(), &request), Support::Skip(_));
    let failed = |error: String| Error::Other(format!("{id}: {error}"));
    let scene = scenes.iter().find(serves).ok_or_else(|| failed(format!("serves none of {}", SCENES.join(", "))))?;
    let task = Task { scene, method, params: &params, quantity, backend, seed: 1, cache: &cache };
    // In a pool of one thread nothing waits, and all that is called is called by the counted function.
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|error| failed(error.to_string()))?;
    pool.install(|| {
        let mut silent = |_: &str, _: u64, _: u64| ();
        let mut ready = prepare_once(&task, &Key::of_bytes(b"no cell"), &mut silent)?;
        let (mut recorder, mut recorded) = (Recorder::new(&mut silent), Recorded::default());
        let frame = scene.frame(0);
        update(&mut ready, &frame, &mut recorder, &mut recorded)?;
        let mut radiance = vec![Rgb::NAN; frame.receivers.len()];
        let mut once = || evaluate(&task, ready.method.as_mut(), &frame, &mut recorder, &mut recorded, &mut radiance);
        once()?;
        counted(&mut once)
    })
    .map_err(failed)?;
    let environment = crate::environment();
    Ok(format!("{} | {} | {}", environment.rustc, environment.profile, crate::cpu_features().join(" ")))
}

#[inline(never)]
fn counted(work: &mut dyn FnMut() -> Result<(), String>) -> Result<(), String> {
    work()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_are_read() {
        assert_eq!(total("version: 1\nevents: Ir\nsummary: 7\n\ntotals: 123456\n"), Some(123_456));
        for bad in ["", "totals: ", "totals: 0", "totals: many", "summary: 7"] {
            assert_eq!(total(bad), None, "{bad}");
        }
    }

    #[test]
    fn every_method_can_be_counted() {
        for method in halflight_registry::methods() {
            assert!(shade(method.info().id).unwrap().starts_with("rustc"), "{}", method.info().id);
        }
        assert!(shade("no/method").is_err());
    }
}
