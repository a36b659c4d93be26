//! Sixteen vectors at a time, coefficient by coefficient.

use crate::real::Real;

/// Vectors that a [`Block`] holds a value of.
pub const LANES: usize = 16;

/// One value of each of 16 vectors, "lanes".
///
/// Batches are slices of blocks: the `n²` coefficients of the first 16 vectors, one block each, then those of the next 16.
/// A batch whose last lanes are not needed holds anything finite there, 0 for example.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Block<T>(
    /// The lanes.
    pub [T; LANES],
);

impl<T: Real> Block<T> {
    /// All lanes 0.
    pub const ZERO: Self = Self([T::ZERO; LANES]);

    /// All lanes the same.
    pub fn splat(value: T) -> Self {
        Self([value; LANES])
    }
}

impl<T: Real> Default for Block<T> {
    fn default() -> Self {
        Self::ZERO
    }
}
