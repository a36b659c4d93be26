//! Bounding sphere sets: objects as a few dozen spheres, for shadow methods whose blockers are spheres.
//!
//! [`sphere_set`] follows Ren et al. 2006, §6.2: points on the surface and in the interior are grouped by flood-fill
//! Lloyd clustering, each group is bounded by one sphere, and what is minimised is the *outside volume* `Σ V(Sᵢ − T)`
//! (35), the volume of the spheres outside the object; volume in the interior is free, however many spheres share it.
//! Where the paper sums signed volumes over the triangles, this crate measures the interior on a voxel grid. [`Maker`]
//! names two other ways to make sets, for comparison (`docs/spheres.md`).
//!
//! [`seen`] tells which circle of directions a sphere blocks at a receiver, by the self-shadow rules ([`SelfShadow`]).
//!
//! [`SpheresOf`] is the recipe that keeps a set in the cache, [`proxies`] derives one for every casting object,
//! and [`blockers`] carries them along with a frame: with poses, and bound to meshes that change their shape ([`Binding`]).
//! A [`Hierarchy`] bounds groups of them, coarser and coarser, for receivers that are far away.

mod binding;
mod body;
mod cluster;
mod competitors;
mod excess;
mod flood;
mod hierarchy;
mod levels;
mod minimise;
mod posed;
mod recipe;
mod samples;
mod search;
mod self_shadow;
mod set;
#[cfg(test)]
#[path = "../tests/shapes/mod.rs"]
#[allow(dead_code, reason = "shared with the integration tests")]
mod shapes;
mod voxels;

pub use binding::{Binding, BindingOf};
pub use excess::Excess;
pub use hierarchy::Hierarchy;
pub use posed::{PosedSpheres, Proxy, blockers};
pub use recipe::{SpheresOf, proxies};
pub use self_shadow::{Circle, SelfShadow, seen};
pub use set::{DEFAULT_COUNT, MAX_COUNT, Maker, SphereSet, sphere_set};
