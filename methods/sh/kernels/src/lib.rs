//! What `halflight-sh` compiles for each instruction set: scalar types, vectors of lanes, blocks of 16 vectors, and the
//! generated SH products. A crate of its own, since the generated code takes longest to compile and changes least; use it
//! through `halflight-sh`.

mod block;
mod kernels;
mod pack;
mod product;
mod real;
mod simd;

pub use block::{Block, LANES};
pub use kernels::Kernels;
pub use real::Real;
pub use simd::{Lanes, Simd, Task, run};
