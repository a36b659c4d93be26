//! What can go wrong inside a method.

/// Result of a method's phase.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of a method or of derived data.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The caller asked to stop through [`crate::Meter::progress`].
    #[error("cancelled")]
    Cancelled,
    /// The request is outside what the method supports; `supports` says so beforehand.
    #[error("{method}: {what} is not supported")]
    Unsupported {
        /// Method id.
        method: &'static str,
        /// What was asked.
        what: String,
    },
    /// `retune` was given a change that only `prepare` can take.
    #[error("parameter {name} takes effect in prepare: prepare again instead of retuning")]
    NeedsPrepare {
        /// The parameter.
        name: &'static str,
    },
    /// `read` was given an output of another kind or length than the last `evaluate` left.
    #[error("{quantity}: expected an output of that quantity with {expected} floats, found {found}")]
    Output {
        /// What was evaluated.
        quantity: crate::Quantity,
        /// Floats of the result.
        expected: usize,
        /// Floats of the output.
        found: usize,
    },
    /// The scene or its data cannot be used.
    #[error("{0}")]
    Input(String),
    /// A graphics processor is missing, too small or was lost.
    #[error("{0}")]
    Device(String),
    /// A cache file cannot be read or written.
    #[error("{path}: {source}")]
    Cache {
        /// The file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
}
