//! Files that strangers broke, loaded by a process of its own with bounds on time and memory.

mod child;
mod models;
mod sizes;
