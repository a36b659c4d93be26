//! Revisions in a workspace of four crates: `top` → `left` → `ground`, `right` → `ground`.

use halflight_revision::of_crate;
use std::fs;
use std::path::Path;

fn write(root: &Path, file: &str, content: &str) {
    let path = root.join(file);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, content).unwrap();
}

fn package(root: &Path, dir: &str, name: &str, rest: &str) {
    write(root, &format!("{dir}/Cargo.toml"), &format!("[package]\nname = \"{name}\"\n{rest}\n"));
    write(root, &format!("{dir}/src/lib.rs"), "//! A crate.\n");
}

fn workspace() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    write(
        root.path(),
        "Cargo.toml",
        "[workspace]\nmembers = []\n[workspace.dependencies]\nground = { path = \"low/ground\" }\nserde = \"1\"\n",
    );
    package(root.path(), "low/ground", "ground", "");
    package(root.path(), "left", "left", "[target.'cfg(unix)'.dependencies]\nground.workspace = true\n");
    package(root.path(), "right", "right", "[dependencies]\nground = { workspace = true }\nserde.workspace = true\n");
    let top = "[dependencies]\nleft = { path = \"../left\" }\n[dev-dependencies]\nright = { path = \"../right\" }\n";
    package(root.path(), "top", "top", top);
    // A crate inside a crate's folder is not a part of it.
    package(root.path(), "top/inner", "inner", "");
    root
}

/// Which of top, left, right, ground and inner have another revision after the change.
fn changed(change: impl Fn(&Path)) -> Vec<&'static str> {
    let root = workspace();
    let crates =
        [("top", "top"), ("left", "left"), ("right", "right"), ("ground", "low/ground"), ("inner", "top/inner")];
    let revisions = || crates.map(|(_, dir)| of_crate(&root.path().join(dir)).unwrap());
    let before = revisions();
    change(root.path());
    let after = revisions();
    crates.iter().zip(before.iter().zip(after)).filter(|(_, (b, a))| **b != *a).map(|(c, _)| c.0).collect()
}

#[test]
fn a_change_reaches_the_crates_above_only() {
    assert_eq!(changed(|_| ()), [""; 0]);
    assert_eq!(changed(|r| write(r, "low/ground/src/lib.rs", "// new")), ["top", "left", "right", "ground"]);
    assert_eq!(changed(|r| write(r, "left/src/deep/new.rs", "")), ["top", "left"]);
    assert_eq!(changed(|r| write(r, "right/src/lib.rs", "// new")), ["right"]);
    assert_eq!(changed(|r| write(r, "top/inner/src/lib.rs", "// new")), ["inner"]);
}

#[test]
fn every_kind_of_source_counts_and_nothing_else() {
    for file in ["right/build.rs", "right/kernels/a.wgsl", "right/src/table.bin"] {
        assert_eq!(changed(|r| write(r, file, "1")), ["right"], "{file}");
    }
    for file in ["right/tests/a.rs", "right/benches/b.rs", "right/README.md", "right/target/debug/x.wgsl"] {
        assert_eq!(changed(|r| write(r, file, "1")), [""; 0], "{file}");
    }
}

#[test]
fn another_version_of_any_library_reaches_every_crate() {
    let lock = |r: &Path| write(r, "Cargo.lock", "version = 4");
    assert_eq!(changed(lock), ["top", "left", "right", "ground", "inner"]);
}

#[test]
fn an_included_file_counts() {
    let root = workspace();
    let revision = |text: &str| {
        write(root.path(), "left/src/lib.rs", "pub const X: &str = include_str!(\"../data/x.txt\");");
        write(root.path(), "left/data/x.txt", text);
        of_crate(&root.path().join("left")).unwrap()
    };
    assert_ne!(revision("1"), revision("2"));
}

#[test]
fn the_place_of_the_checkout_does_not_count() {
    let (one, two) = (workspace(), workspace());
    // Written in another order, a folder may be listed in another order.
    for (root, names) in [(&one, ["a", "b", "c"]), (&two, ["c", "b", "a"])] {
        names.iter().for_each(|name| write(root.path(), &format!("left/src/{name}.rs"), ""));
    }
    assert_eq!(of_crate(&one.path().join("top")).unwrap(), of_crate(&two.path().join("top")).unwrap());
    assert_eq!(of_crate(&one.path().join("top/../top")).unwrap(), of_crate(&two.path().join("top")).unwrap());
}

#[test]
fn names_and_contents_do_not_run_together() {
    let revision = |file: &str, text: &str| {
        let root = workspace();
        write(root.path(), file, text);
        of_crate(&root.path().join("left")).unwrap()
    };
    assert_ne!(revision("left/src/a.rs", "bc"), revision("left/src/a.rsb", "c"));
}

#[test]
fn errors_name_the_manifest() {
    let root = workspace();
    write(root.path(), "left/Cargo.toml", "[package]\nname = \"left\"\n[dependencies]\nabsent.workspace = true\n");
    let error = of_crate(&root.path().join("top")).unwrap_err().to_string();
    assert!(error.contains("left/Cargo.toml") && error.contains("`absent`"), "{error}");
    assert!(of_crate(&root.path().join("nowhere")).unwrap_err().to_string().contains("nowhere/Cargo.toml"));
}
