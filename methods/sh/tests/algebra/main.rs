//! The crate's identities, closed forms and printed figures, over its whole valid range.

mod circles;
mod common;
mod exponentials;
mod guard;
mod products;
mod rotations;
