//! Sphere blockers as seen from receivers, and the direct light that they leave.
//!
//! Ren et al. 2006 shadow a receiver by the circles under which it sees spheres. This crate holds what every method of that
//! kind shares: the gathering of circles over receivers' blockers with work counted and skipped ([`Gather`]), the overlap guard,
//! the parameters, and the whole of [`halflight_contract::Prepared`] around one [`Accumulator`] that says how circles become
//! visibility.
//!
//! Methods that sum logs may also look at cuts through hierarchies of spheres instead of all spheres ([`params::CUT`]).
//!
//! What blockers that never move leave may be kept from frame to frame ([`params::BAKE`]).
//!
//! # The way of the data
//!
//! Valid receivers go 16 together, a lane each: spheres → [`Circles`], some spheres at a time → the accumulator's state →
//! visibility in blocks, which the guard and the window change → `H(N) * g` → colours. Lanes do
//! not influence one another: without cuts a receiver's result does not depend on its company. With cuts receivers go cluster by
//! cluster, and the spheres are those that its cut selects, some with a ratio vector.

mod backends;
mod bake;
mod clustered;
mod clusters;
mod cut;
mod direct;
mod gather;
#[cfg(feature = "gpu")]
mod gpu;
mod lamps;
pub mod params;
mod ratio;
mod seen;
mod shading;
mod stage;

pub use backends::{backends, prepare, supports};
pub use clusters::clusters;
pub use direct::{Accumulator, Counts, DirectLight, Work, fill_open};
pub use gather::{Blockers, Gather, Tally};
#[cfg(feature = "gpu")]
pub use gpu::{GpuDirectLight, Needs, Text, source};
pub use halflight_proxies::SelfShadow;
pub use seen::Circles;
