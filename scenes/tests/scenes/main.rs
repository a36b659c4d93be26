//! Scene files from disk to frames: formats, receivers, identity, shipped scenes, and everything that can be wrong.

mod bad_input;
mod emission;
mod folder;
mod formats;
mod heights;
mod identity;
mod imports;
mod lights;
mod models;
mod mutations;
mod oiio;
mod readme;
mod receivers;
mod resolution;
mod shipped;
mod truncations;
