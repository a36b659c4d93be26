//! CPU and GPU of the same cell: how far their pictures are apart, and what each takes.

mod columns;
mod differences;
mod pairs;

pub(crate) use columns::columns;
pub(crate) use differences::{maps, section};
pub use pairs::{Twins, twins};
