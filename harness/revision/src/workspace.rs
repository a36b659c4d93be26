//! The crates below a crate, as the manifests declare them.

use crate::{RevisionError, read};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// A crate of the workspace.
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) dir: PathBuf,
}

/// The crate in `dir` and all crates below it that it reaches by path, sorted by name.
pub(crate) fn closure(dir: &Path) -> Result<Vec<Package>, RevisionError> {
    let root = root(dir)?;
    let shared = manifest(&root)?;
    let mut found = BTreeMap::new();
    let mut waiting = vec![dir.to_owned()];
    while let Some(dir) = waiting.pop() {
        let manifest = manifest(&dir)?;
        let name = manifest.get("package").and_then(|p| p.get("name")).and_then(Value::as_str).ok_or_else(|| {
            RevisionError::Manifest { path: dir.join("Cargo.toml"), message: "expected a `package.name`".into() }
        })?;
        if found.contains_key(name) {
            continue;
        }
        for (name, value) in dependencies(&manifest) {
            waiting.extend(place(&dir, name, value, &root, &shared)?);
        }
        found.insert(name.to_owned(), dir);
    }
    Ok(found.into_iter().map(|(name, dir)| Package { name, dir }).collect())
}

/// The folder of the workspace that `dir` belongs to.
pub(crate) fn root(dir: &Path) -> Result<PathBuf, RevisionError> {
    let absolute = std::path::absolute(dir).map_err(|source| RevisionError::Io { path: dir.to_owned(), source })?;
    for above in absolute.ancestors() {
        if above.join("Cargo.toml").is_file() && manifest(above)?.contains_key("workspace") {
            return Ok(above.to_owned());
        }
    }
    let message = "expected a workspace in this folder or one above it".into();
    Err(RevisionError::Manifest { path: dir.join("Cargo.toml"), message })
}

fn manifest(dir: &Path) -> Result<Table, RevisionError> {
    let path = dir.join("Cargo.toml");
    let wrong = |message: String| RevisionError::Manifest { path: path.clone(), message };
    let text = String::from_utf8(read(&path)?).map_err(|e| wrong(e.to_string()))?;
    text.parse().map_err(|e: toml::de::Error| wrong(e.to_string()))
}

/// What the crate is built from: `dependencies` and `build-dependencies`, for all targets.
fn dependencies(manifest: &Table) -> impl Iterator<Item = (&String, &Value)> {
    let targets = manifest.get("target").and_then(Value::as_table).into_iter().flat_map(Table::values);
    std::iter::once(manifest)
        .chain(targets.filter_map(Value::as_table))
        .flat_map(|table| ["dependencies", "build-dependencies"].map(|kind| table.get(kind)))
        .filter_map(|table| table.and_then(Value::as_table))
        .flatten()
}

/// The folder of a dependency; none where it comes from elsewhere than a path.
fn place(dir: &Path, name: &str, value: &Value, root: &Path, shared: &Table) -> Result<Option<PathBuf>, RevisionError> {
    let path = |value: &Value| value.get("path").and_then(Value::as_str).map(str::to_owned);
    if value.get("workspace").and_then(Value::as_bool) != Some(true) {
        return Ok(path(value).map(|p| dir.join(p)));
    }
    let value = shared.get("workspace").and_then(|w| w.get("dependencies")).and_then(|d| d.get(name));
    let value = value.ok_or_else(|| RevisionError::Manifest {
        path: dir.join("Cargo.toml"),
        message: format!("dependency `{name}` is not in `workspace.dependencies`"),
    })?;
    Ok(path(value).map(|p| root.join(p)))
}
