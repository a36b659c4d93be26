//! `halflight diff`.

use super::{Ending, say};
use crate::score::view;
use anyhow::{Context, ensure};
use clap::Args;
use glam::Vec3;
use halflight_metrics::{Tolerance, agrees, compare};
use halflight_results::{Picture, Record, Run, Store};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(super) struct Diff {
    /// An EXR picture or a results directory
    a: PathBuf,
    /// What it is held against, of the same kind
    b: PathBuf,
    /// The RMSE and bias that pass, relative to B's level (its root mean square); a single channel of a single receiver may
    /// be off by 100 times as much
    #[arg(long, default_value_t = 1e-6, value_parser = tolerance)]
    tolerance: f64,
}

/// A run by what was asked: neither its revision nor the place where it was timed.
type Asked = (String, String, String, String, String, u64, u32);

impl Diff {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let same = if self.a.is_dir() && self.b.is_dir() {
            self.directories()?
        } else {
            self.pictures(&self.a.display().to_string(), &read(&self.a)?, &read(&self.b)?)
        };
        Ok(if same { Ending::Well } else { Ending::Differs })
    }

    /// Compares the pictures of all runs that either directory has.
    fn directories(&self) -> anyhow::Result<bool> {
        let (a, b) = (open(&self.a)?, open(&self.b)?);
        let (runs_a, runs_b) = (runs(&a), runs(&b));
        let mut same = true;
        for (asked, run) in &runs_a {
            let label = label(run);
            let Some(other) = runs_b.get(asked) else {
                say(&format!("{label}: only in {}", self.a.display()));
                same = false;
                continue;
            };
            same &= match (&run.image, &other.image) {
                (Some(x), Some(y)) => self.pictures(&label, &a.read_picture(x)?, &b.read_picture(y)?),
                (x, y) => x.is_none() && y.is_none(),
            };
        }
        for (_, run) in runs_b.iter().filter(|(asked, _)| !runs_a.contains_key(*asked)) {
            say(&format!("{}: only in {}", label(run), self.b.display()));
            same = false;
        }
        Ok(same)
    }

    /// Prints the error measures of one picture against another, and whether they are within the tolerance.
    fn pictures(&self, label: &str, a: &Picture, b: &Picture) -> bool {
        let tolerance = Tolerance { rmse: self.tolerance, bias: self.tolerance, max: 100.0 * self.tolerance };
        if a == b {
            say(&format!("{label}: same, bit for bit"));
            return true;
        }
        let scores = match compare(&view(a), &view(b), &vec![Vec3::ZERO; b.radiance.len()]) {
            Ok(scores) => scores,
            Err(error) => {
                say(&format!("{label}: DIFFERS: {error}"));
                return false;
            }
        };
        let measures: Vec<_> = scores.measures().map(|(name, value)| format!("{name} {value:.3e}")).collect();
        // Validity decides what is compared, so it must agree by itself.
        let verdict = if a.valid != b.valid {
            Err("different receivers are valid".to_owned())
        } else {
            agrees(&scores, &tolerance).map_err(|why| why.to_string())
        };
        let told = verdict.as_ref().map_or_else(|why| format!("DIFFERS: {why}"), |()| "same".to_owned());
        say(&format!("{label}: {told}; {}", measures.join(", ")));
        verdict.is_ok()
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let expected = || "expected a number from 0".to_owned();
    text.parse().ok().filter(|t: &f64| t.is_finite() && *t >= 0.0).ok_or_else(expected)
}

fn read(path: &Path) -> anyhow::Result<Picture> {
    let bytes = std::fs::read(path).with_context(|| format!("{}: expected an EXR picture", path.display()))?;
    Ok(Picture::from_exr(&bytes, path)?)
}

fn open(dir: &Path) -> anyhow::Result<Store> {
    let store = Store::open(dir)?;
    ensure!(store.path().exists(), "{}: expected the results of a run", store.path().display());
    Ok(store)
}

fn runs(store: &Store) -> BTreeMap<Asked, &Run> {
    let mut runs = BTreeMap::new();
    for record in store.outcomes() {
        if let Record::Run(run) = record {
            runs.insert(asked(run), &**run);
        }
    }
    runs
}

fn asked(run: &Run) -> Asked {
    let cell = &run.cell;
    let params = serde_json::Value::from_iter(cell.params.clone()).to_string();
    let (quantity, backend) = (cell.quantity.clone(), cell.backend.clone());
    (cell.scene.clone(), cell.method.clone(), params, quantity, backend, cell.seed, cell.frame)
}

fn label(run: &Run) -> String {
    let cell = &run.cell;
    let params: String = cell.params.iter().map(|(name, value)| format!(" {name}={value}")).collect();
    format!("{} · {}{params} frame {}", cell.scene, cell.method, cell.frame)
}
