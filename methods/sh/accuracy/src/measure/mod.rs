//! One file a family of operations: each runs an operation in every form that there is and compares with the oracle.

pub(crate) mod basis;
pub(crate) mod circles;
pub(crate) mod exponentials;
pub(crate) mod products;
pub(crate) mod rotations;
