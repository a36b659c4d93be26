//! What can go wrong with a reference.

use std::path::PathBuf;

/// Result of making or keeping a reference.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of a reference or of its store.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Making what the reference needs failed, or the caller cancelled.
    #[error(transparent)]
    Contract(#[from] halflight_contract::Error),
    /// There is no such reference of the quantity in the scene.
    #[error("reference {reference} of {quantity}: {reason}")]
    NotServed {
        /// Its id.
        reference: String,
        /// What was asked for.
        quantity: halflight_contract::Quantity,
        /// Why not.
        reason: String,
    },
    /// A quality that cannot be met by any number of samples.
    #[error("reference quality: {field} is {value}, expected {expected}")]
    Quality {
        /// Field of [`crate::Quality`].
        field: &'static str,
        /// What it holds.
        value: String,
        /// What it should hold.
        expected: &'static str,
    },
    /// The store's folder or one of its files cannot be made or written.
    #[error("reference store: {path}: {message}")]
    Store {
        /// The file or folder.
        path: PathBuf,
        /// What the system or the image library said.
        message: String,
    },
}
