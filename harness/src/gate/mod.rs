//! The gate: what a run gave, held against what is known to be right.
//!
//! [`observe()`] measures the pictures of a store, [`Baselines`] are such measurements as they were blessed, and [`compare()`] says
//! where the two differ. What can be compared depends on what is noisy:
//!
//! | what | how |
//! |---|---|
//! | pictures: block means | within [`ROUNDING`] of the picture's level |
//! | references, RMSE and bias under the same reference's key | as pictures: equal keys have equal bits |
//! | references, RMSE and bias after a reference was estimated anew | within chance: all such checks together reject honest estimates with probability [`LEVEL`] |
//! | memory by purpose | exactly |
//! | counters of work | exactly on the same vector extensions, else within [`ROUNDING`] of their value |
//! | shading time, relative to [`PACE`] on the same scene in the same run | up to [`SLOWER`] times the ratio that it was |
//! | instructions of a small frame, where they are asked for and valgrind is there | within [`MORE`] of their number, by the same compiler |
//!
//! Kernels for different processors round differently, which may tip a rare decision (a squaring more, a guard): that is what
//! [`ROUNDING`] is for. References trace the same bits everywhere. A picture that changes fails whether its error shrinks or
//! grows: a bias may well bring a method nearer to the truth. What was not measured, or never blessed, fails too.

mod baselines;
mod chance;
mod changes;
mod compare;
pub(crate) mod instructions;
mod observe;
mod pace;

pub use baselines::{Baselines, CellBaseline, Noisy, ReferenceBaseline, ScoreBaseline};
pub use chance::LEVEL;
pub use changes::changes;
pub use compare::{Comparison, Finding, ROUNDING, SLOWER, Verdict, compare};
pub use instructions::{Instructions, MORE, count};
pub use observe::{Observed, observe};
pub use pace::{PACE, Ratio};

/// The suite that is gated when nothing is said.
pub const SUITE: &str = "gate";
