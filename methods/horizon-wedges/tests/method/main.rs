//! The family's methods from outside.

mod common;
mod oracles;
mod stress;
mod updates;
