//! The tracer against loops over everything, closed forms and hard input.

mod brute_force;
mod hard_cases;
mod oracle;
mod two_levels;
