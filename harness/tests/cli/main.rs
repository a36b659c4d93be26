//! The program as a user runs it.

mod bad_input;
mod bench;
mod budget;
mod commands;
mod export;
mod failing;
mod figure;
mod gate;
mod gate_controls;
mod gpu;
#[cfg(feature = "gpu")]
mod gpu_lost;
mod import;
mod killed;
mod ledger;
mod lost;
mod measured;
mod refs;
mod rescore;
mod run;
mod same;
mod shared;
mod spending;
mod sweeps;
mod table;
mod unchanged;
