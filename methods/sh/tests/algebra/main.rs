//! The crate's identities, closed forms and printed figures, over its whole valid range.

mod batches;
mod circles;
mod common;
mod exponentials;
mod guard;
mod lanes;
mod logs;
mod products;
mod rotations;
