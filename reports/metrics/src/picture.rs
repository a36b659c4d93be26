//! What is compared, and why a comparison is refused.

use glam::Vec3;

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
    /// No arrangement.
    List,
}

/// Radiance at receivers, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Linear RGB radiance of each receiver.
    pub radiance: &'a [Vec3],
    /// Whether each receiver counts.
    pub valid: &'a [bool],
    /// How the receivers are arranged.
    pub layout: Layout,
}

impl Picture<'_> {
    /// How many receivers the layout has.
    pub(crate) fn receivers(&self) -> usize {
        match self.layout {
            Layout::Image { width, height } => width.saturating_mul(height),
            Layout::List => self.radiance.len(),
        }
    }
}

/// Why two pictures cannot be compared. A comparison that says nothing is an error, never a pass.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum CompareError {
    /// A field's length differs from the number of receivers.
    #[error("{what} has {actual} values, expected {expected}, one a receiver")]
    Length {
        /// Which field.
        what: &'static str,
        /// Its length.
        actual: usize,
        /// The number of receivers of the picture's layout, or of the tested picture.
        expected: usize,
    },
    /// The two pictures are arranged differently.
    #[error("the picture's layout is {picture:?}, the reference's {reference:?}: expected the same")]
    Layout {
        /// The tested picture's.
        picture: Layout,
        /// The reference's.
        reference: Layout,
    },
    /// A value that counts is NaN or infinite, or a standard error is negative.
    #[error("{what} at receiver {receiver} is not finite (or negative where it may not be)")]
    NotFinite {
        /// Which of the inputs.
        what: &'static str,
        /// The receiver's index.
        receiver: usize,
    },
    /// No receiver is valid in both pictures.
    #[error("no receiver is valid in both the picture and the reference")]
    NothingToCompare,
    /// Both pictures are the same memory.
    #[error("the picture and the reference are the same memory: a picture cannot be its own reference")]
    SamePicture,
}

/// The receivers that are valid in both of two pictures that are arranged alike.
pub(crate) fn comparable(x: &Picture, reference: &Picture) -> Result<Vec<usize>, CompareError> {
    if x.layout != reference.layout {
        return Err(CompareError::Layout { picture: x.layout, reference: reference.layout });
    }
    let expected = x.receivers();
    for (what, actual) in [
        ("the picture's radiance", x.radiance.len()),
        ("the picture's validity", x.valid.len()),
        ("the reference's radiance", reference.radiance.len()),
        ("the reference's validity", reference.valid.len()),
    ] {
        if actual != expected {
            return Err(CompareError::Length { what, actual, expected });
        }
    }
    let receivers: Vec<usize> = (0..expected).filter(|i| x.valid[*i] && reference.valid[*i]).collect();
    if receivers.is_empty() {
        return Err(CompareError::NothingToCompare);
    }
    // After the check for emptiness, since empty slices may share an address.
    if std::ptr::eq(x.radiance, reference.radiance) {
        return Err(CompareError::SamePicture);
    }
    Ok(receivers)
}

/// Checks both pictures and lists the receivers that are valid in both; values that count must be finite.
pub(crate) fn common(x: &Picture, reference: &Picture, error: &[Vec3]) -> Result<Vec<usize>, CompareError> {
    let receivers = comparable(x, reference)?;
    if error.len() != x.radiance.len() {
        let what = "the reference's standard error";
        return Err(CompareError::Length { what, actual: error.len(), expected: x.radiance.len() });
    }
    for &receiver in &receivers {
        let (what, bad) = if !x.radiance[receiver].is_finite() {
            ("the picture's radiance", true)
        } else if !reference.radiance[receiver].is_finite() {
            ("the reference's radiance", true)
        } else {
            let e = error[receiver];
            ("the reference's standard error", !e.is_finite() || e.min_element() < 0.0)
        };
        if bad {
            return Err(CompareError::NotFinite { what, receiver });
        }
    }
    Ok(receivers)
}
