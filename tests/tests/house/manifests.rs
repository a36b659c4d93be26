//! The workspace's manifests.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

/// A crate of the workspace, as its manifest says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Manifest {
    /// Folder below the workspace's root.
    pub(crate) folder: String,
    /// Package name.
    pub(crate) name: String,
    /// Names of what it links: dependencies and build dependencies, for every target, without dev-dependencies.
    pub(crate) dependencies: BTreeSet<String>,
}

/// The workspace's root folder.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ lies in the workspace").to_path_buf()
}

/// Every member of the workspace.
pub(crate) fn members() -> Vec<Manifest> {
    let workspace = parse(&root().join("Cargo.toml"));
    let members = workspace["workspace"]["members"].as_array().expect("members is an array");
    members.iter().map(|folder| read(folder.as_str().expect("members are folders"))).collect()
}

/// The crate in a folder below the root.
pub(crate) fn read(folder: &str) -> Manifest {
    let table = parse(&root().join(folder).join("Cargo.toml"));
    let name = table["package"]["name"].as_str().expect("a package has a name").into();
    Manifest { folder: folder.into(), name, dependencies: dependencies(&table) }
}

fn parse(path: &Path) -> Table {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn dependencies(table: &Table) -> BTreeSet<String> {
    let targets = table.get("target").and_then(Value::as_table).into_iter().flat_map(Table::values);
    let sections = targets.filter_map(Value::as_table).chain([table]);
    let linked = sections.flat_map(|section| ["dependencies", "build-dependencies"].map(|kind| section.get(kind)));
    linked.flatten().filter_map(Value::as_table).flat_map(Table::keys).cloned().collect()
}
