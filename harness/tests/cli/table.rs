//! `halflight export --csv`, `--parquet`.

use crate::bench::{Bench, of_kind};
use serde_json::Value;

const RUN: &str = "run --scene tiny.toml --method shexp/hyb --method sh-product/ordered --set order=2..3 \
                   --quantity direct --quantity total --reference truth --reference sh-light --out out";

/// Rows by column; the fields of these tests hold neither commas nor quotes where it matters.
fn rows(csv: &str) -> Vec<std::collections::HashMap<String, String>> {
    let mut lines = csv.lines().map(fields);
    let names = lines.next().unwrap();
    lines.map(|fields| names.iter().cloned().zip(fields).collect()).collect()
}

/// Splits at commas outside quotes.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

#[test]
fn csv_has_a_row_a_cell_and_reference() {
    let bench = Bench::new();
    bench.well(RUN);
    let before = bench.files("out");
    let told = bench.well("export --csv results.csv --out out");
    // Four cells by two references, and four that were skipped.
    assert_eq!(told, "12 rows: results.csv\n");
    assert!(bench.files("out") == before);
    let rows = rows(&std::fs::read_to_string(bench.path("results.csv")).unwrap());
    let lines = bench.lines("out");
    let [runs, scores, times] = ["run", "score", "times"].map(|kind| of_kind(&lines, kind));
    for score in &scores {
        let run = runs.iter().find(|run| run["key"] == score["run"]).unwrap();
        let is =
            |row: &&_| row_is(row, "key", run["key"].as_str()) && row_is(row, "reference", score["reference"].as_str());
        let [row] = rows.iter().filter(is).collect::<Vec<_>>()[..] else { panic!("one row a score") };
        for (name, value) in score["measures"].as_object().unwrap() {
            assert_eq!(row[&format!("score_{name}")].parse::<f64>().ok(), value.as_f64(), "{name}");
        }
        let samples = &times.iter().find(|times| times["run"] == run["key"]).unwrap()["phases"];
        let mut shade: Vec<f64> =
            samples["shade"]["nanoseconds"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        shade.sort_by(f64::total_cmp);
        let time = |end: &str| row[&format!("time_shade_{end}_ns")].parse::<f64>().unwrap();
        assert_eq!(time("median"), shade[2] + 0.5 * (shade[3] - shade[2]));
        assert_eq!((time("low"), time("high")), (shade[0], shade[5]));
        assert_eq!(row["time_shade_samples"], "6");
        assert!(row["calibration_memory_ns"].parse::<f64>().unwrap() > 0.0);
        assert_eq!(row["param_order"], run["params"]["order"].to_string());
        assert_eq!(row["resolved"], score["resolved"].to_string());
        for (name, count) in run["counters"].as_object().unwrap() {
            assert_eq!(row[&format!("count_{name}")], count.to_string());
        }
        let bytes: u64 = run["footprint"].as_array().unwrap().iter().map(|s| s["host_bytes"].as_u64().unwrap()).sum();
        assert_eq!(row["host_bytes"], bytes.to_string());
        assert_eq!(row["profile"], run["environment"]["profile"].as_str().unwrap());
    }
    let skips: Vec<_> = rows.iter().filter(|row| row["kind"] == "skip").collect();
    assert_eq!(skips.len(), 4);
    assert!(skips.iter().all(|row| row["why"] == "computes direct light only" && row["score_rmse"].is_empty()));
}

fn row_is(row: &std::collections::HashMap<String, String>, column: &str, value: Option<&str>) -> bool {
    row.get(column).map(String::as_str) == value
}

#[test]
fn every_column_is_documented() {
    let bench = Bench::new();
    bench.well(RUN);
    bench.well("export --csv results.csv --out out");
    let listed: Vec<Value> = serde_json::from_str(&bench.well("list columns --json")).unwrap();
    let patterns: Vec<(&str, &str)> = listed
        .iter()
        .map(|entry| entry["id"].as_str().unwrap())
        .map(|id| id.split_once("NAME").unwrap_or((id, "")))
        .collect();
    let text = std::fs::read_to_string(bench.path("results.csv")).unwrap();
    for column in fields(text.lines().next().unwrap()) {
        let fits = |(start, end): &(&str, &str)| column.starts_with(start) && column.ends_with(end);
        assert!(patterns.iter().any(fits), "{column}");
    }
}

#[test]
fn an_export_asks_for_what_it_needs() {
    let bench = Bench::new();
    for (command, part) in [
        ("export", "--csv"),
        ("export --csv a.csv --out nowhere", "nowhere/results.jsonl"),
        ("export --csv a.csv --scene tiny.toml --to mitsuba --out x", "--scene"),
        ("export --scene tiny.toml --out x", "--to"),
        ("export --scene tiny.toml --to mitsuba", "--out"),
    ] {
        let said = bench.halflight(command);
        assert!(said.code == 2 && said.err.contains(part), "{command}: {}", said.err);
    }
    assert!(!bench.path("a.csv").exists() && !bench.path("nowhere").exists());
}

#[cfg(not(feature = "parquet"))]
#[test]
fn without_its_feature_parquet_says_so() {
    let bench = Bench::new();
    bench.well("run --scene tiny.toml --method shexp/hyb --reference truth --out out");
    let said = bench.halflight("export --parquet a.parquet --out out");
    assert!(said.code == 2 && said.err.contains("feature `parquet`"), "{}", said.err);
}

/// Reads the Parquet file by pyarrow and prints its schema, its metadata and its rows as JSON.
#[cfg(feature = "parquet")]
const READ: &str = "
import json, sys
import pyarrow.parquet as parquet
table = parquet.read_table(sys.argv[1])
types = {field.name: str(field.type) for field in table.schema}
about = {name.decode(): text.decode() for name, text in (table.schema.metadata or {}).items()}
json.dump({'types': types, 'about': about, 'rows': table.to_pylist()}, sys.stdout)
";

/// The Python that `HALFLIGHT_PYTHON` names, or `python3` if that has pyarrow.
#[cfg(feature = "parquet")]
fn python() -> Option<String> {
    if let Ok(named) = std::env::var("HALFLIGHT_PYTHON") {
        return Some(named);
    }
    let imports = std::process::Command::new("python3").args(["-c", "import pyarrow"]).output();
    imports.is_ok_and(|said| said.status.success()).then(|| "python3".to_owned())
}

#[cfg(feature = "parquet")]
#[test]
fn pyarrow_reads_what_csv_says() {
    let Some(python) = python() else {
        // Straight to the terminal: what print macros say is hidden when a test passes.
        let _ = std::io::Write::write_all(
            &mut std::io::stderr(),
            b"SKIPPED, not tested: pyarrow_reads_what_csv_says needs python3 with pyarrow\n",
        );
        return;
    };
    let bench = Bench::new();
    bench.well(RUN);
    bench.well("export --csv results.csv --parquet results.parquet --out out");
    let said =
        std::process::Command::new(python).args(["-c", READ]).arg(bench.path("results.parquet")).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let read: Value = serde_json::from_slice(&said.stdout).unwrap();
    let text = std::fs::read_to_string(bench.path("results.csv")).unwrap();
    let names = fields(text.lines().next().unwrap());
    let expected = rows(&text);
    assert_eq!(read["rows"].as_array().unwrap().len(), expected.len());
    for name in &names {
        assert!(read["about"][name].as_str().is_some_and(|about| !about.is_empty()), "{name}");
        for (row, expected) in read["rows"].as_array().unwrap().iter().zip(&expected) {
            let same = match (&row[name], expected[name].as_str()) {
                (Value::Null, text) => text.is_empty(),
                (Value::String(value), text) => value.replace('"', "") == text,
                (Value::Number(value), text) => value.as_f64() == text.parse().ok(),
                (Value::Bool(value), text) => text.parse() == Ok(*value),
                _ => false,
            };
            assert!(same, "{name}: {} and {}", row[name], expected[name]);
        }
    }
    let types = &read["types"];
    for (name, kind) in [("method", "string"), ("seed", "uint64"), ("score_rmse", "double"), ("resolved", "bool")] {
        assert_eq!(types[name], kind, "{name}");
    }
}
