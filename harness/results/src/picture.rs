//! Pictures and references in memory.

use glam::Vec3;
use std::path::PathBuf;

/// How receivers are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// An image in rows from the top, `width × height` receivers.
    Image {
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// No arrangement, so many receivers; stored as an image one pixel high.
    List(usize),
}

impl Layout {
    /// The number of receivers; none where it overflows.
    pub fn receivers(self) -> Option<usize> {
        match self {
            Layout::Image { width, height } => width.checked_mul(height),
            Layout::List(count) => Some(count),
        }
    }

    /// Width and height of the stored image.
    pub fn size(self) -> (usize, usize) {
        match self {
            Layout::Image { width, height } => (width, height),
            Layout::List(count) => (count, 1),
        }
    }
}

/// Outgoing radiance (linear RGB) at every receiver. EXR channels `R`, `G`, `B`, `valid`.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Arrangement of the receivers.
    pub layout: Layout,
    /// Radiance of each receiver.
    pub radiance: Vec<Vec3>,
    /// Whether each receiver counts: false where a camera's ray met nothing.
    pub valid: Vec<bool>,
}

/// A reference with its statistics. EXR channels `mean.*`, `variance.*`, `samples`, `valid`.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferencePicture {
    /// Arrangement of the receivers.
    pub layout: Layout,
    /// The estimate of each receiver's radiance.
    pub mean: Vec<Vec3>,
    /// The variance *of that mean*: its square root is the standard error. 0 for a reference by quadrature.
    pub variance: Vec<Vec3>,
    /// Samples taken at each receiver.
    pub samples: Vec<u32>,
    /// Whether each receiver counts.
    pub valid: Vec<bool>,
}

impl ReferencePicture {
    /// The standard error of each receiver's mean: `√variance`.
    pub fn standard_error(&self) -> Vec<Vec3> {
        self.variance.iter().map(|v| Vec3::new(v.x.sqrt(), v.y.sqrt(), v.z.sqrt())).collect()
    }

    /// The mean as a picture.
    pub fn picture(&self) -> Picture {
        Picture { layout: self.layout, radiance: self.mean.clone(), valid: self.valid.clone() }
    }
}

/// Why a picture could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not an EXR that can be read.
    #[error("{path}: not a readable EXR: {message}")]
    Exr {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        message: String,
    },
    /// A channel is missing.
    #[error("{path}: channel `{channel}` is missing; found {found}")]
    Channel {
        /// The file.
        path: PathBuf,
        /// The channel that was looked for.
        channel: &'static str,
        /// The channels that are there.
        found: String,
    },
    /// The file's bytes are not those that its name promises.
    #[error("{path}: the content's sha-256 is {actual}, not the file's name: the image is damaged")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The hash of what is there.
        actual: String,
    },
    /// A field's length does not fit the layout.
    #[error("picture: `{field}` has {actual} values, expected {expected} for the layout {layout:?}")]
    Length {
        /// The field.
        field: &'static str,
        /// Its length.
        actual: usize,
        /// The layout's number of receivers.
        expected: usize,
        /// The layout.
        layout: Layout,
    },
    /// There is no receiver to store.
    #[error("picture: the layout {0:?} holds no receivers, expected at least one")]
    Empty(Layout),
}
