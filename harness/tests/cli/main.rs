//! The program as a user runs it.

mod bad_input;
mod bench;
mod budget;
mod commands;
mod export;
mod failing;
mod gate;
mod gate_controls;
mod refs;
mod run;
