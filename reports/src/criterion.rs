//! What `cargo bench` measured: criterion's results, read from its folder, as a table.

use crate::format::{count, escape, time};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A benchmark's time an iteration, in nanoseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Benchmark {
    /// Its full name, such as `sh/product/4`.
    pub name: String,
    /// The median.
    pub median: f64,
    /// Lower end of the median's bootstrap interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The interval's confidence, such as 0.95.
    pub confidence: f64,
    /// Elements that an iteration handles, where the benchmark tells.
    pub elements: Option<u64>,
}

/// Why criterion's results could not be read.
#[derive(Debug, thiserror::Error)]
pub enum CriterionError {
    /// A file or folder could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is not what criterion writes.
    #[error("{}: not of criterion 0.5 to 0.8: {why}; `cargo bench` writes it anew", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// There is no result in the folder.
    #[error("{}: no results of criterion (*/new/estimates.json); `cargo bench` makes them", .0.display())]
    Empty(PathBuf),
}

/// The parts of `benchmark.json` that are of interest.
#[derive(Deserialize)]
struct Name {
    full_id: String,
    throughput: Option<serde_json::Value>,
}

/// The part of `estimates.json` that is of interest.
#[derive(Deserialize)]
struct Estimates {
    median: Estimate,
}

#[derive(Deserialize)]
struct Estimate {
    point_estimate: f64,
    confidence_interval: Confidence,
}

#[derive(Deserialize)]
struct Confidence {
    confidence_level: f64,
    lower_bound: f64,
    upper_bound: f64,
}

/// Reads all results in criterion's folder, such as `target/criterion`, by name.
///
/// # Errors
/// The folder cannot be read or holds no results, or one of them is not as criterion writes it.
pub fn read_criterion(folder: &Path) -> Result<Vec<Benchmark>, CriterionError> {
    let mut found = Vec::new();
    collect(folder, &mut found)?;
    if found.is_empty() {
        return Err(CriterionError::Empty(folder.to_owned()));
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

fn collect(folder: &Path, found: &mut Vec<Benchmark>) -> Result<(), CriterionError> {
    let failed = |source| CriterionError::Io { path: folder.to_owned(), source };
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if !path.is_dir() {
            continue;
        }
        // `base` and `change` tell of earlier runs.
        if path.ends_with("new") { found.push(benchmark(&path)?) } else { collect(&path, found)? }
    }
    Ok(())
}

fn benchmark(folder: &Path) -> Result<Benchmark, CriterionError> {
    let name: Name = read(&folder.join("benchmark.json"))?;
    let path = folder.join("estimates.json");
    let Estimates { median } = read(&path)?;
    let Confidence { confidence_level: confidence, lower_bound: low, upper_bound: high } = median.confidence_interval;
    let median = median.point_estimate;
    if !(low >= 0.0 && low <= median && median <= high) {
        let why = format!("expected 0 ≤ lower_bound ≤ point_estimate ≤ upper_bound, found {low}, {median}, {high}");
        return Err(CriterionError::Malformed { path, why });
    }
    let elements = name.throughput.and_then(|throughput| throughput.get("Elements")?.as_u64());
    Ok(Benchmark { name: name.full_id, median, low, high, confidence, elements })
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, CriterionError> {
    let text = std::fs::read(path).map_err(|source| CriterionError::Io { path: path.to_owned(), source })?;
    serde_json::from_slice(&text)
        .map_err(|error| CriterionError::Malformed { path: path.to_owned(), why: error.to_string() })
}

/// The section, or nothing without benchmarks.
pub(crate) fn section(benchmarks: &[Benchmark]) -> String {
    let Some(first) = benchmarks.first() else { return String::new() };
    let mut html = format!(
        "<h2 id=\"benchmarks\">Benchmarks</h2><p class=\"note\">What <code>cargo bench</code> measured last, by criterion: the \
         median of an iteration with its {:.0}% bootstrap interval. Taken one after another, at another time than the runs: \
         for orders of magnitude; ratios need one run, interleaved.</p><div class=\"wide\"><table><thead><tr><th>benchmark</th>\
         <th>time</th><th>elements</th><th>time an element</th></tr></thead><tbody>",
        100.0 * first.confidence
    );
    for one in benchmarks {
        let elements = one.elements.filter(|elements| *elements > 0);
        let _ = write!(
            html,
            "<tr><th>{}</th><td>{}<small>{} to {}</small></td><td>{}</td><td>{}</td></tr>",
            escape(&one.name),
            time(one.median),
            time(one.low),
            time(one.high),
            elements.map_or("–".into(), count),
            elements.map_or("–".into(), |elements| time(one.median / elements as f64)),
        );
    }
    html + "</tbody></table></div>"
}

#[cfg(test)]
mod tests {
    use super::*;

    const ESTIMATES: &str = r#"{"mean":{"confidence_interval":{"confidence_level":0.95,"lower_bound":1.0,"upper_bound":3.0},
        "point_estimate":2.0,"standard_error":0.1},"median":{"confidence_interval":{"confidence_level":0.95,
        "lower_bound":1500.0,"upper_bound":3000.0},"point_estimate":2000.0,"standard_error":0.1},"slope":null}"#;
    const NAME: &str = r#"{"group_id":"g","function_id":"f","value_str":"4","throughput":{"Elements":100},
        "full_id":"g/<f>/4","directory_name":"g/f/4","title":"g/f/4"}"#;

    fn results(estimates: &str, name: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for run in ["new", "base"] {
            let path = folder.path().join("g/f/4").join(run);
            std::fs::create_dir_all(&path).unwrap();
            std::fs::write(path.join("estimates.json"), estimates).unwrap();
            std::fs::write(path.join("benchmark.json"), name).unwrap();
        }
        std::fs::create_dir_all(folder.path().join("report")).unwrap();
        folder
    }

    #[test]
    fn results_become_rows() {
        let found = read_criterion(results(ESTIMATES, NAME).path()).unwrap();
        let [one] = &found[..] else { panic!("{found:?}") };
        assert_eq!((one.name.as_str(), one.median, one.low, one.high), ("g/<f>/4", 2000.0, 1500.0, 3000.0));
        let html = section(&found);
        for part in ["g/&lt;f&gt;/4", "2.00 µs<small>1.50 µs to 3.00 µs", "20.0 ns", "95% bootstrap"] {
            assert!(html.contains(part), "{part}: {html}");
        }
        let unknown = NAME.replace("{\"Elements\":100}", "null");
        assert_eq!(read_criterion(results(ESTIMATES, &unknown).path()).unwrap()[0].elements, None);
        assert_eq!(section(&[]), "");
    }

    #[test]
    fn what_is_wrong_is_told_by_file() {
        for (estimates, name, part) in [
            (ESTIMATES.replace("\"median\"", "\"medium\""), NAME.to_owned(), "missing field `median`"),
            (ESTIMATES[..80].to_owned(), NAME.to_owned(), "EOF"),
            (ESTIMATES.replace("3000.0", "3.0"), NAME.to_owned(), "point_estimate ≤ upper_bound"),
            (ESTIMATES.to_owned(), NAME.replace("full_id", "id"), "missing field `full_id`"),
        ] {
            let error = read_criterion(results(&estimates, &name).path()).unwrap_err().to_string();
            assert!(error.contains("g/f/4/new/") && error.contains(part), "{error}");
        }
        let folder = results(ESTIMATES, NAME);
        std::fs::remove_file(folder.path().join("g/f/4/new/estimates.json")).unwrap();
        let error = read_criterion(folder.path()).unwrap_err().to_string();
        assert!(error.contains("estimates.json: No such file"), "{error}");
        let error = read_criterion(&folder.path().join("nowhere")).unwrap_err().to_string();
        assert!(error.contains("nowhere: No such file"), "{error}");
        let empty = tempfile::tempdir().unwrap();
        assert!(read_criterion(empty.path()).unwrap_err().to_string().contains("cargo bench"));
    }
}
