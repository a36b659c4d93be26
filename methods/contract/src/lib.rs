//! The one trait that every method implements, and what it works with: parameters, derived data, the meter.
//!
//! The shape of a method is: declare ([`Info`]), say what it supports ([`Support`]), [`Method::prepare`] once, then for
//! every frame [`Prepared::update`], [`Prepared::evaluate`] and [`Prepared::read`]. A method never sees a camera, a tone
//! curve, a file or a clock.

mod derived;
mod disk;
mod error;
mod info;
mod job;
mod meter;
mod method;
mod params;

pub use derived::{BuildTime, Cache, Codec, Derived};
pub use error::{Error, Result};
pub use info::{Backend, Coupling, Info, Quantity, Request, Support};
pub use job::Job;
pub use meter::{Flow, Meter, NoMeter, counted, timed};
pub use method::{Footprint, Method, Output, Prepared};
pub use params::{Kind, ParamError, ParamSpec, Params, Phase, Value};
