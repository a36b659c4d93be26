//! References: what the light at receivers is, by ray tracing, with a known standard error.
//!
//! [`Reference::TRUTH`] is the scene itself. The others change one or several things, each an approximation that methods make
//! ([`Change`]): the light in spherical harmonics, meshes as sphere sets, truncated or averaged visibility. All give *outgoing
//! radiance* `albedo/π · ∫ L(ω) V(ω) max(0, n·ω) dω` with the shading normal `n`, as methods do; `L` is direct light, light
//! reflected by diffuse surfaces before, or both.
//!
//! [`estimate()`] answers a [`Request`] with an [`Estimate`], [`obtain`] takes it from a [`ReferenceStore`] where it was made
//! before, and goes on with one that was broken off. [`visibility()`] is the visibility itself. [`statistics`] tests estimates
//! against closed forms ([`analytic`]), each other, or methods that claim to be exact.
//!
//! How: randomised quasi-Monte Carlo. Each receiver's samples are independently scrambled replicates ("batches") of Sobol
//! points (Owen 1995; Burley 2020), shared between the cosine lobe and the lights by the balance heuristic (Veach 1995). The
//! unoccluded integral is known by quadrature and closed forms and serves as control variate: direct light with nothing in its
//! way has no error. The spread of the batches' means gives the variance without bias, with `batches − 1` degrees of freedom.

pub mod analytic;
mod coefficients;
mod emission;
mod emitters;
mod error;
mod estimate;
pub mod horizon;
mod kind;
mod partial;
mod pixels;
mod provenance;
mod quality;
mod receiver;
mod request;
mod sampling;
pub mod statistics;
mod store;
mod traced;
mod transport;
mod unoccluded;
mod visibility;

pub use coefficients::{VisibilityEstimate, visibility};
pub use error::{Error, Result};
pub use estimate::{Estimate, estimate};
pub use kind::{Change, Kind, ParseError, Reference};
pub use provenance::{Achieved, Provenance};
pub use quality::Quality;
pub use request::Request;
pub use store::{Entry, ReferenceStore, State, obtain};

/// Revision of everything that a reference is computed with: a hash of the sources of this crate and of those below it.
pub const REVISION: &str = env!("HALFLIGHT_REFERENCES_REVISION");
