//! What can be wrong with a scene and its files.

use std::path::{Path, PathBuf};

/// Why a scene cannot be loaded: one line that names the file, the field and what was expected.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file does not exist or cannot be read.
    #[error("{}: expected a readable file: {reason}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// The file or folder cannot be written.
    #[error("{}: expected a place to write to: {reason}", file.display())]
    Unwritable {
        /// The file or folder.
        file: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// The file does not follow its format: syntax, unknown or missing fields, wrong types, truncation.
    #[error("{}: {place}: {problem}", file.display())]
    Malformed {
        /// The file.
        file: PathBuf,
        /// Line, element or byte where reading stopped.
        place: String,
        /// What was expected there.
        problem: String,
    },
    /// A field has a value outside its range.
    #[error("{}: {field}: expected {expected}, found {found}", file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// The field, as `lights[0].key.radiance` or `vertex 7`.
        field: String,
        /// What the field may hold.
        expected: String,
        /// What it holds.
        found: String,
    },
    /// Neither a shipped scene nor a file.
    #[error("{name}: expected the path of a scene file or one of the shipped scenes {shipped}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// Names of the shipped scenes.
        shipped: String,
    },
}

impl SceneError {
    /// The same of a file that is to move from one folder to another.
    pub(crate) fn told_of(mut self, from: &Path, to: &Path) -> Self {
        if let SceneError::Unreadable { file, .. }
        | SceneError::Unwritable { file, .. }
        | SceneError::Malformed { file, .. }
        | SceneError::Invalid { file, .. } = &mut self
            && let Ok(rest) = file.strip_prefix(from)
        {
            *file = to.join(rest);
        }
        self
    }
}
