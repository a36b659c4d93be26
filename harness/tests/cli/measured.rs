//! `halflight measured`.

use crate::bench::Bench;

const TAKE: &str = "measured take --scene tiny.toml --method sh-product/ordered --set order=2 --reference truth --samples 16 \
                    --device Bench --note idle --peak cpu=1e11,2e10 --files kept --repeats 2";

#[test]
fn one_command_keeps_a_device_and_writes_the_page() {
    let bench = Bench::new();
    let told = bench.well(TAKE);
    assert!(told.contains("kept/bench.jsonl") && told.ends_with("kept.md\n"), "{told}");
    let page = std::fs::read_to_string(bench.path("kept.md")).unwrap();
    for part in
        ["## Bench", "- note: idle", "100 Gflop/s, 20 GB/s", "| update again | shade | read |", "No graphics processor"]
    {
        assert!(page.contains(part), "{part}: {page}");
    }
    let file = std::fs::read_to_string(bench.path("kept/bench.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> = file.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines[0]["conditions"]["peaks"]["cpu"]["flops"], 1e11);
    assert!(
        lines[0]["conditions"]["command"].as_str().unwrap().starts_with("halflight measured take --scene tiny.toml")
    );
    assert_eq!((lines.len(), &lines[1]["outcome"]["kind"]), (2, &"run".into()));
    assert_eq!(lines[1]["times"]["phases"]["update again"]["nanoseconds"].as_array().unwrap().len(), 2);

    // A peak is a fact of the device: it stays where it is not told again.
    bench.well(&TAKE.replace(" --peak cpu=1e11,2e10", ""));
    assert!(std::fs::read_to_string(bench.path("kept.md")).unwrap().contains("100 Gflop/s"));

    bench.well("measured --check --files kept");
    bench.write("kept.md", &page.replace("idle", "busy"));
    assert_eq!(bench.halflight("measured --check --files kept").code, 1);
    bench.well("measured --files kept");
    bench.well("measured --check --files kept");
}

#[test]
fn what_is_wrong_is_told() {
    let bench = Bench::new();
    bench.write("kept/x.jsonl", "");
    for (command, part) in [
        ("measured --files kept", "kept/x.jsonl, line 1: expected the conditions"),
        ("measured take --peak gpu=1", "gpu=67e12,3.35e12"),
        ("measured take --device ? --scene tiny.toml", "expected a name with letters or digits"),
    ] {
        let said = bench.halflight(command);
        assert!(said.code == 2 && said.err.contains(part), "{command}: {}", said.err);
    }
}
