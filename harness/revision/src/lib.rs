//! The revision of a crate: a hash of the sources that it is built from, its own and those of the workspace crates below it.
//!
//! A result is kept as long as its method's revision stands, so the hash depends on sources alone: not on where the
//! checkout lies, on file times or on the order in which a folder is listed. It covers `Cargo.toml`, `build.rs`,
//! everything under `src`, every `*.wgsl` file of the crate, and files that sources take in by `include!`, `include_str!`
//! or `include_bytes!` with a literal path. It follows path and workspace dependencies, build dependencies among them
//! since they may generate code, but not dev-dependencies. Crates of a registry come in through
//! `Cargo.lock`: another version of any of them is another revision.
//!
//! In a build script:
//!
//! ```no_run
//! # fn main() -> Result<(), halflight_revision::RevisionError> {
//! halflight_revision::emit("SHEXP_REVISION", "../methods/shexp".as_ref())?; // then env!("SHEXP_REVISION")
//! # Ok(())
//! # }
//! ```

mod sources;
mod workspace;

use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Why a revision could not be computed.
#[derive(Debug)]
pub enum RevisionError {
    /// A file or folder could not be read.
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A `Cargo.toml` is not what was expected.
    Manifest {
        /// The manifest.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
}

impl std::fmt::Display for RevisionError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Io { path, source } => write!(f, "{}: {source}", path.display()),
            Self::Manifest { path, message } => write!(f, "{}: {message}", path.display()),
        }
    }
}

impl std::error::Error for RevisionError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Manifest { .. } => None,
        }
    }
}

/// The revision of the crate in `manifest_dir`: SHA-256 as 64 lower-case hex digits.
///
/// # Errors
/// A source cannot be read, a `Cargo.toml` cannot be understood, or a dependency on the workspace is not in it.
pub fn of_crate(manifest_dir: &Path) -> Result<String, RevisionError> {
    hash(&workspace::closure(manifest_dir)?, &lock(&workspace::root(manifest_dir)?)?)
}

/// Gives the crate that is being built the environment variable `variable` with the revision of the crate in
/// `manifest_dir`, and asks cargo to run the build script again when one of the sources changes.
///
/// # Errors
/// As [`of_crate`].
pub fn emit(variable: &str, manifest_dir: &Path) -> Result<(), RevisionError> {
    let crates = workspace::closure(manifest_dir)?;
    let root = workspace::root(manifest_dir)?;
    println!("cargo:rustc-env={variable}={}", hash(&crates, &lock(&root)?)?);
    for package in &crates {
        for path in sources::watched(&package.dir)? {
            println!("cargo:rerun-if-changed={}", path.display());
        }
    }
    // The dependencies' paths and versions are declared there.
    for file in ["Cargo.toml", "Cargo.lock"] {
        println!("cargo:rerun-if-changed={}", root.join(file).display());
    }
    Ok(())
}

/// Every name and content goes in with its length before it, so that no two sets of files can run together to the same bytes.
fn hash(crates: &[workspace::Package], lock: &[u8]) -> Result<String, RevisionError> {
    let mut sha = Sha256::new();
    let mut feed = |bytes: &[u8]| {
        sha.update((bytes.len() as u64).to_le_bytes());
        sha.update(bytes);
    };
    feed(lock);
    for package in crates {
        feed(package.name.as_bytes());
        for source in sources::of(&package.dir)? {
            feed(source.name.as_bytes());
            feed(&read(&source.path)?);
        }
        // Ends the crate: no file's name is empty.
        feed(b"");
    }
    Ok(sha.finalize().iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    }))
}

/// The versions of all crates that do not lie in the workspace; empty where none are locked.
fn lock(root: &Path) -> Result<Vec<u8>, RevisionError> {
    let file = root.join("Cargo.lock");
    if file.is_file() { read(&file) } else { Ok(Vec::new()) }
}

fn read(path: &Path) -> Result<Vec<u8>, RevisionError> {
    std::fs::read(path).map_err(|source| RevisionError::Io { path: path.to_owned(), source })
}
