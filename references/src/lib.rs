//! References: what the light at receivers is, by ray tracing, with a known standard error.
//!
//! [`Reference::Truth`] is the scene itself. The others isolate one approximation each: [`Reference::ShLight`] replaces the
//! light by its spherical harmonics, [`Reference::SphereProxies`] the meshes by their sphere sets. All give *outgoing
//! radiance* `albedo/π · ∫ L(ω) V(ω) max(0, n·ω) dω` with the shading normal `n`, as methods do.
//!
//! [`estimate()`] makes an [`Estimate`], [`obtain`] takes it from a [`ReferenceStore`] where it was made before.
//! [`statistics`] tests estimates against closed forms ([`analytic`]), each other, or methods that claim to be exact.
//!
//! How: randomised quasi-Monte Carlo. Each receiver's samples are independently scrambled replicates ("batches") of Sobol
//! points (Owen 1995; Burley 2020), shared between the cosine lobe and the lights by the balance heuristic (Veach 1995). The
//! unoccluded integral is known by quadrature and serves as control variate: light with nothing in its way has no error. The
//! spread of the batches' means gives the variance without bias, with `batches − 1` degrees of freedom.

pub mod analytic;
mod emission;
mod error;
mod estimate;
pub mod horizon;
mod integrand;
mod kind;
mod pixels;
mod quality;
mod receiver;
mod sampling;
pub mod statistics;
mod store;
mod unoccluded;
mod visibility;

pub use error::{Error, Result};
pub use estimate::{Estimate, estimate};
pub use kind::{Kind, ParseError, Reference};
pub use quality::Quality;
pub use store::{ReferenceStore, key, obtain};

/// Revision of everything that a reference is computed with: a hash of the sources of this crate and of those below it.
pub const REVISION: &str = env!("HALFLIGHT_REFERENCES_REVISION");
