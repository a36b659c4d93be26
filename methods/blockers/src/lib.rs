//! Sphere blockers as seen from receivers, and the direct light that they leave.
//!
//! Ren et al. 2006 shadow a receiver by the circles under which it sees spheres. This crate holds what every method of that
//! kind shares: the gathering of circles over a receiver's blockers with work counted and skipped ([`Gather`]), the overlap guard,
//! the parameters, and the whole of [`halflight_contract::Prepared`] around one [`Accumulator`] that says how circles become
//! visibility.

mod direct;
mod gather;
pub mod params;

pub use direct::{Accumulator, DirectLight, Work, supports};
pub use gather::{Gather, Tally};
pub use halflight_proxies::{Circle, SelfShadow};
