//! OpenImageIO's reader and tools against our own pictures and measures.

mod exr;
mod measures;
mod numbers;
mod refusals;
mod tools;
