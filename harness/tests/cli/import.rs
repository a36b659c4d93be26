//! `halflight import`, `export --to gltf`, and both in turn.

use crate::bench::Bench;

/// A wedge with its base on the ground, y up.
const WEDGE: &str = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0 1 0.5\nv 1 1 0.5\n\
    f 1 2 3 4\nf 1 5 6 2\nf 4 3 6 5\nf 1 4 5\nf 2 6 3\n";

#[test]
fn a_model_is_imported_run_exported_and_imported_again() {
    let bench = Bench::new();
    bench.write("wedge.obj", WEDGE);
    let told = bench.well("import wedge.obj --out first --size 4x3");
    for part in ["8 triangles, 1 x 1 x 1 m", "y up by guess", "metres by guess", "overcast", "first/wedge.toml"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let text = std::fs::read_to_string(bench.path("first/wedge.toml")).unwrap();
    assert!(text.starts_with("# Made by `halflight import`:") && text.contains("sha256"), "{text}");
    bench.well("run --scene first/wedge.toml --method shexp/hyb --set order=2 --reference truth --out out");

    let told = bench.well("export --scene first/wedge.toml --to gltf --out away");
    assert!(told.contains("away/wedge.glb"), "{told}");
    bench.well("import away/wedge.glb --out second");
    // The same content: nothing is left to run, whatever the folder.
    let told = bench.well("run --scene second/wedge.toml --method shexp/hyb --set order=2 --reference truth --out out");
    assert!(told.contains("0 cells run, 1 cached"), "{told}");
}

#[test]
fn bad_requests_are_named_and_nothing_is_written() {
    let bench = Bench::new();
    bench.write("wedge.obj", WEDGE);
    bench.write("wedge.txt", WEDGE);
    bench.write("open.obj", &WEDGE.replace("f 1 2 3 4", "f 1 2 3 9"));
    std::fs::create_dir(bench.path("there")).unwrap();
    let before = bench.files("");
    for (command, parts) in [
        ("import", &["<FILE>"][..]),
        ("import absent.obj", &["absent.obj", "readable"]),
        ("import wedge.txt", &["wedge.txt", "extension", "glb"]),
        ("import open.obj", &["open.obj", "line 7", "6 vertices"]),
        ("import wedge.obj --out there", &["there", "--force"]),
        ("import wedge.obj --unit ell", &["--unit", "ell", "mm"]),
        ("import wedge.obj --size 20", &["--size", "160x120"]),
        ("import wedge.obj --light-scale 0", &["--light-scale"]),
        ("import wedge.obj --no-ground --receivers ground", &["--receivers", "no ground"]),
        ("export --scene tiny.toml --to gltf --out away --frame 1", &["frame 1", "below 1"]),
    ] {
        let said = bench.halflight(command);
        assert_eq!(said.code, 2, "{command}: {}{}", said.out, said.err);
        for part in parts {
            assert!(said.err.contains(part), "{command}: expected {part} in: {}", said.err);
        }
        assert!(bench.files("") == before, "{command} wrote something");
    }
    bench.well("import wedge.obj --out there --force");
}
