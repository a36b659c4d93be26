//! Ray tracing over slices of triangles and spheres: the ground on which the house stands.
//! Scenes cast camera rays with it, methods visibility rays, references integrate through it.
//!
//! What never moves is one body; what moves rigidly is an instance of a body built once; what changes its form is
//! refitted. The interface is batch first: callers hand over many rays at once, so that the traversal may change
//! without touching them. Nothing here has an absolute epsilon: a scene scaled by any factor that `f32` can
//! hold gives the same hits, and what lies at the very start of a ray is left out by its `t_min`.

mod body;
mod clearance;
mod instance;
mod sphere;
mod traced_ray;
mod triangle;
mod wide;
mod world;

pub use body::{Body, Geometry};
pub use clearance::{clearance, clearance_of_point};
pub use instance::Instance;
pub use sphere::Sphere;
pub use world::{Hit, Ray, World};
