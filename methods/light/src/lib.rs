//! Lights in spherical harmonics: every distant light of a scene, summed, to any order that the house knows.
//!
//! Radiance from direction `s` is `L(s) = Σ_i L_i y_i(s)`, one coefficient vector a colour channel. Projections are exact
//! integrals: an environment map is piecewise constant over its texels and integrated analytically in azimuth and by
//! Gauss–Legendre in polar angle; a key light is the closed form of a circle; skies are polynomials of the height.

mod environment;
mod project;
mod recipe;

pub use project::project;
pub use recipe::{EachLightOf, LightOf, SceneLight, ShLight};
