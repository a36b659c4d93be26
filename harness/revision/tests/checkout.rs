//! Revisions in a copy of this very workspace: which methods' results a change throws away.

use halflight_revision::of_crate;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Copies what crates are built from.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let (name, path) = (entry.file_name(), entry.path());
        if path.is_dir() && !["target", "data", "tests", ".git"].iter().any(|other| name == *other) {
            copy(&path, &to.join(&name));
        } else if ["rs", "toml", "lock", "wgsl"].iter().any(|kind| path.extension().is_some_and(|e| e == *kind)) {
            fs::copy(&path, to.join(&name)).unwrap();
        }
    }
}

/// Folders below `methods/` that are crates, with the crates of this workspace that their manifests name.
fn methods(root: &Path) -> Vec<(String, BTreeSet<String>)> {
    let folder = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
    let named = |folder: &str| {
        let manifest = fs::read_to_string(root.join("methods").join(folder).join("Cargo.toml")).ok()?;
        let built = manifest.split("[dev-dependencies]").next().unwrap().to_owned();
        Some(built.lines().filter_map(|line| line.split_once(".workspace").map(|(name, _)| name.to_owned())).collect())
    };
    let folders = fs::read_dir(root.join("methods")).unwrap().map(|entry| folder(entry.unwrap()));
    folders.filter_map(|folder| named(&folder).map(|named| (folder, named))).collect()
}

/// The methods' crates that have another revision after a change to a file.
fn changed(file: &str) -> BTreeSet<String> {
    let root = tempfile::tempdir().unwrap();
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."), root.path());
    let crates = methods(root.path());
    let revisions = || {
        let revision = |(folder, _): &(String, _)| of_crate(&root.path().join("methods").join(folder)).unwrap();
        crates.iter().map(revision).collect::<Vec<_>>()
    };
    let before = revisions();
    let source = fs::read_to_string(root.path().join(file)).unwrap();
    fs::write(root.path().join(file), source + "\n// A change.\n").unwrap();
    let different = crates.iter().zip(before.iter().zip(revisions())).filter(|(_, (before, after))| **before != *after);
    different.map(|((folder, _), _)| folder.clone()).collect()
}

#[test]
fn a_methods_source_changes_that_method_alone() {
    let of = |folder: &str| changed(&format!("methods/{folder}/src/lib.rs"));
    // The registry names all methods, so it is built from them.
    for family in ["shexp", "sh-product"] {
        assert_eq!(of(family), [family.to_owned(), "registry".into()].into());
    }
}

#[test]
fn sh_changes_those_that_use_it() {
    let crates = methods(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
    let mut users: BTreeSet<String> = ["sh".to_owned()].into();
    for _ in 0..crates.len() {
        let uses = |named: &BTreeSet<String>| users.iter().any(|user| named.contains(&format!("halflight-{user}")));
        let more: Vec<String> =
            crates.iter().filter(|(_, named)| uses(named)).map(|(folder, _)| folder.clone()).collect();
        users.extend(more);
    }
    assert!(users.contains("shexp") && users.contains("sh-product") && !users.contains("contract"), "{users:?}");
    assert_eq!(changed("methods/sh/src/lib.rs"), users);
}
