//! The files that a crate is built from.

use crate::{RevisionError, read};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A file, and the name that stands for it in the hash: its path as seen from the crate.
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
}

/// All sources of the crate in `dir`, sorted by name.
pub(crate) fn of(dir: &Path) -> Result<Vec<Source>, RevisionError> {
    let mut files = BTreeMap::new();
    for name in ["Cargo.toml", "build.rs"] {
        if dir.join(name).is_file() {
            files.insert(name.to_owned(), dir.join(name));
        }
    }
    walk(dir, "", &|name| name.starts_with("src/") || name.ends_with(".wgsl"), &mut files)?;
    let rust: Vec<_> =
        files.iter().filter(|(name, _)| name.ends_with(".rs")).map(|(n, p)| (n.clone(), p.clone())).collect();
    for (name, path) in rust {
        let text = String::from_utf8_lossy(&read(&path)?).into_owned();
        let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
        for included in included(&text) {
            let (from, file) = match included {
                Included::FromFile(file) => (folder, file),
                Included::FromCrate(file) => ("", file),
            };
            let name = if from.is_empty() { file } else { format!("{from}/{file}") };
            // What only a comment names, or cargo generates, is no source.
            if dir.join(&name).is_file() {
                files.insert(name.clone(), dir.join(&name));
            }
        }
    }
    Ok(files.into_iter().map(|(name, path)| Source { name, path }).collect())
}

/// What cargo has to watch for the crate in `dir`: the folder `src`, where files may appear, and the other sources.
pub(crate) fn watched(dir: &Path) -> Result<Vec<PathBuf>, RevisionError> {
    let mut paths: Vec<_> = of(dir)?.into_iter().filter(|s| !s.name.starts_with("src/")).map(|s| s.path).collect();
    // A path through `src/..` is outside the folder again.
    paths.extend(of(dir)?.into_iter().filter(|s| s.name.starts_with("src/") && s.name.contains("..")).map(|s| s.path));
    paths.push(dir.join("src"));
    Ok(paths)
}

/// Collects the files below `dir` whose name `wanted` accepts, but none of a crate that lies inside this one.
fn walk(
    dir: &Path,
    prefix: &str,
    wanted: &dyn Fn(&str) -> bool,
    files: &mut BTreeMap<String, PathBuf>,
) -> Result<(), RevisionError> {
    let io = |source| RevisionError::Io { path: dir.to_owned(), source };
    for entry in std::fs::read_dir(dir).map_err(io)? {
        let entry = entry.map_err(io)?;
        let base = entry.file_name().to_string_lossy().into_owned();
        let name = format!("{prefix}{base}");
        let path = entry.path();
        if path.is_dir() {
            let foreign = base.starts_with('.') || base == "target" || path.join("Cargo.toml").is_file();
            if !foreign {
                walk(&path, &format!("{name}/"), wanted, files)?;
            }
        } else if wanted(&name) {
            files.insert(name, path);
        }
    }
    Ok(())
}

/// A file that a source takes in.
#[derive(Debug, PartialEq)]
enum Included {
    /// Its path starts at the source's folder.
    FromFile(String),
    /// Its path starts at the crate's folder (`concat!(env!("CARGO_MANIFEST_DIR"), …)`).
    FromCrate(String),
}

/// The files named by the `include` macros in a Rust source. A path that is not made of literals is not seen.
fn included(text: &str) -> Vec<Included> {
    let mut found = Vec::new();
    for macro_name in ["include!(", "include_str!(", "include_bytes!("] {
        for (at, _) in text.match_indices(macro_name) {
            let literals = literals(&text[at + macro_name.len()..]);
            found.extend(match literals.as_slice() {
                [] => None,
                [first, rest @ ..] if first == "CARGO_MANIFEST_DIR" => {
                    Some(Included::FromCrate(rest.concat().trim_start_matches('/').to_owned()))
                }
                parts => Some(Included::FromFile(parts.concat())),
            });
        }
    }
    found
}

/// The string literals before the parenthesis that closes a macro's arguments.
fn literals(arguments: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut depth = 1;
    let mut quoted: Option<String> = None;
    for c in arguments.chars() {
        match (&mut quoted, c) {
            (Some(_), '"') => found.extend(quoted.take()),
            (Some(text), c) => text.push(c),
            (None, '"') => quoted = Some(String::new()),
            (None, '(') => depth += 1,
            (None, ')') => depth -= 1,
            (None, _) => {}
        }
        if depth == 0 {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn include_macros_name_files() {
        let text = r#"
            const A: &str = include_str!("../suites/quick.toml");
            const B: &[u8] = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/data/", "x.bin"));
            include!(concat!(env!("OUT_DIR"), "/gamma.rs")); let other = "not.this";
        "#;
        let mut found = included(text);
        found.sort_by_key(|i| format!("{i:?}"));
        let expected = [
            Included::FromCrate("data/x.bin".into()),
            Included::FromFile("../suites/quick.toml".into()),
            Included::FromFile("OUT_DIR/gamma.rs".into()),
        ];
        assert_eq!(found, expected);
    }
}
