//! Closed forms that estimates are tested against.

mod circle;
mod enclosure;
mod parallel;
mod polygon;
#[cfg(test)]
mod quadrature;
mod sky;

pub use circle::{circle, sphere_over_receiver};
pub use enclosure::{enclosure, enclosure_after};
pub use parallel::{disc_over_point, parallel_squares, rectangle_over_point};
pub use polygon::polygon_over_receiver;
pub use sky::{overcast, ramp, trench, trench_horizon};
