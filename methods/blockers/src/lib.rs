//! Sphere blockers as seen from receivers, and the direct light that they leave.
//!
//! Ren et al. 2006 shadow a receiver by the circles under which it sees spheres. This crate holds what every method of that
//! kind shares: the gathering of circles over receivers' blockers with work counted and skipped ([`Gather`]), the overlap guard,
//! the parameters, and the whole of [`halflight_contract::Prepared`] around one [`Accumulator`] that says how circles become
//! visibility.
//!
//! # The way of the data
//!
//! Valid receivers go 16 together, a lane each: spheres → [`Circles`], some spheres at a time → the accumulator's state →
//! visibility in blocks → one vector a receiver, which the guard and the window change → blocks → `H(N) * g` → colours. Lanes do
//! not influence one another: a receiver's result does not depend on its company.

mod clustered;
mod clusters;
mod cut;
mod direct;
mod gather;
pub mod params;
mod seen;
mod shading;

pub use clusters::clusters;
pub use direct::{Accumulator, DirectLight, Work, fill_open, supports};
pub use gather::{Blockers, Gather, Tally};
pub use halflight_proxies::SelfShadow;
pub use seen::Circles;
