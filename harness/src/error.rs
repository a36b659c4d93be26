//! What is wrong with a request, or stops carrying it out.

use std::path::PathBuf;

/// Why a request is not carried out. All but what the system does to files is found before anything is written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No thing of this kind has this name.
    #[error("unknown {kind} `{name}`: expected one of {known}")]
    Unknown {
        /// Scene, method, reference, …
        kind: &'static str,
        /// What was given.
        name: String,
        /// What there is.
        known: String,
    },
    /// A setting that cannot be read.
    #[error("--set {text}: {message}")]
    Setting {
        /// What was given.
        text: String,
        /// What was expected.
        message: String,
    },
    /// A parameter's value does not fit its declaration.
    #[error("{method}: {source}")]
    Param {
        /// The method.
        method: &'static str,
        /// What is wrong.
        source: halflight_contract::ParamError,
    },
    /// A suite file is not what was expected.
    #[error("suite {name}: {message}")]
    Suite {
        /// The suite's name or path.
        name: String,
        /// What is wrong.
        message: String,
    },
    /// A scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] halflight_scenes::SceneError),
    /// The results cannot be read.
    #[error(transparent)]
    Store(#[from] halflight_results::StoreError),
    /// References cannot be made or kept.
    #[error(transparent)]
    References(#[from] halflight_references::Error),
    /// References that a gate stands on are not there.
    #[error("{count} of {of} references are not there, expected all; `halflight refs build` makes them: {which}")]
    MissingReferences {
        /// How many.
        count: usize,
        /// Of how many.
        of: usize,
        /// Which, and what there is of them.
        which: String,
    },
    /// A file cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Anything else: the message names what was found and what was expected.
    #[error("{0}")]
    Other(String),
}

impl Error {
    /// An unknown name, with all that are known.
    pub(crate) fn unknown<'a>(kind: &'static str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known = known.into_iter().collect::<Vec<_>>().join(", ");
        Self::Unknown { kind, name: name.to_owned(), known }
    }
}
