//! The house as drawn: what may depend on what, and that every method is on the list.

mod layers;
mod manifests;
mod registered;
