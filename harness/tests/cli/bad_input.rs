//! Bad input: exit code 2, one line that names what is wrong and what was expected, nothing written.

use crate::bench::{Bench, SCENE};

/// Commands, and what their message must name.
const WRONG: [(&str, &[&str]); 32] = [
    ("run --scene nowhere", &["nowhere", "sphere-plane"]),
    ("run --scene nowhere.toml", &["nowhere.toml"]),
    ("run --scene unknown-field.toml", &["unknown-field.toml", "colour"]),
    ("run --scene missing-mesh.toml", &["absent.ply"]),
    ("run --scene tiny.toml --method shexp/none", &["method `shexp/none`", "shexp/hyb"]),
    ("run --scene tiny.toml --method shexp/hyb --set order=0", &["order", "1 to 8", "0"]),
    ("run --scene tiny.toml --method shexp/hyb --set order=3..9", &["order", "1 to 8", "9"]),
    ("run --scene tiny.toml --method shexp/hyb --set order=four", &["order", "four"]),
    ("run --scene tiny.toml --method shexp/hyb --set odrer=4", &["parameter `odrer`", "order"]),
    ("run --scene tiny.toml --set order", &["order", "NAME=VALUES"]),
    ("run --scene tiny.toml --set order=4 --set order=5", &["order", "once"]),
    ("run --scene tiny.toml --reference thruth", &["thruth", "truth"]),
    ("run --scene tiny.toml --reference sh-light:9", &["sh-light:9", "1 to 8"]),
    ("run --scene tiny.toml --quantity glow", &["quantity `glow`", "direct"]),
    ("run --suite none", &["suite `none`", "quick"]),
    ("run --suite bad-suite.toml", &["bad-suite.toml", "sed"]),
    ("run --suite quick --scene tiny.toml", &["--suite", "--scene"]),
    ("run --scene tiny.toml --threads 0", &["--threads"]),
    ("ledger measure S1 S12", &["row `S12`", "S11"]),
    ("ledger measure S1 --rounds 0", &["--rounds 0", "at least 1"]),
    ("ledger --check --out absent.md", &["absent.md"]),
    ("probe --scene tiny.toml --method shexp/hyb --at absent.csv", &["absent.csv"]),
    ("probe --scene tiny.toml --reference truth --samples 0 --at short.csv", &["samples", "0", "expected 1"]),
    ("probe --scene tiny.toml --method shexp/hyb --at short.csv", &["short.csv", "line 2", "x,y,z,nx,ny,nz"]),
    ("refs build --scene nowhere", &["nowhere", "sphere-plane"]),
    ("refs build --scene tiny.toml --samples 0", &["min_samples", "0"]),
    ("refs check --scene tiny.toml --standard-error=-1", &["standard_error", "-1"]),
    ("refs prune --suite quick", &["--all"]),
    ("budget --scene tiny.toml --method shexp/none", &["method `shexp/none`", "shexp/hyb"]),
    ("budget --scene tiny.toml --method shexp/hyb --quantity total", &["shexp/hyb does not serve total of tiny"]),
    ("budget --scene tiny.toml --method shexp/hyb --frame 1", &["frame 1", "below 1"]),
    ("diff tiny.toml tiny.toml", &["tiny.toml", "EXR"]),
];

#[test]
fn bad_input_is_named_and_nothing_is_written() {
    let bench = Bench::new();
    bench.write("unknown-field.toml", &SCENE.replace("albedo", "colour"));
    bench.write(
        "missing-mesh.toml",
        &SCENE.replace("sphere = { center = [0.0, 0.0, 1.0], radius = 0.5 }", "mesh = { file = \"absent.ply\" }"),
    );
    bench.write("bad-suite.toml", "about = ''\n[[entry]]\nscenes = ['tiny.toml']\nmethods = []\nsed = 3\n");
    bench.write("short.csv", "x,y,z,nx,ny,nz\n0,0,0\n");
    let before = bench.files("");
    for (command, parts) in WRONG {
        let said = bench.halflight(command);
        assert_eq!(said.code, 2, "{command}: {}{}", said.out, said.err);
        for part in parts {
            assert!(said.err.contains(part), "{command}: expected {part} in: {}", said.err);
        }
        assert!(!said.err.contains("panicked") && said.out.is_empty(), "{command}: {}{}", said.out, said.err);
        assert!(bench.files("") == before, "{command} wrote something");
    }
}

#[test]
fn a_store_that_cannot_be_read_is_left_alone() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("out")).unwrap();
    bench.write("out/results.jsonl", "{\"schema\":2,\"kind\":\"run\"}\n{}\n");
    let before = bench.files("");
    let said = bench.halflight("run --scene tiny.toml --method shexp/hyb --out out");
    assert!(said.code == 2 && said.err.contains("results.jsonl, line 1"), "{}", said.err);
    let said = bench.halflight("run --scene tiny.toml --method shexp/hyb --out tiny.toml");
    assert!(said.code == 2 && said.err.contains("tiny.toml"), "{}", said.err);
    let said = bench.halflight("run --scene tiny.toml --method shexp/hyb --cache tiny.toml");
    assert!(said.code == 2 && said.err.contains("tiny.toml"), "{}", said.err);
    assert!(bench.files("") == before);
}
