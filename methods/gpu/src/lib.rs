//! Graphics processors for methods: adapters, a shared device, buffers that stay, compute passes that are timed.
//!
//! A method's GPU backend is WGSL and the few lines that hand it buffers. Everything here is blocking: [`Gpu::run`] returns when the
//! device is done, so that phases mean what they mean on the CPU.
//!
//! - [`adapters`] lists what there is, the most capable first; software ones are marked: correctness only, their times mean nothing.
//! - [`Gpu::shared`] is the device of a backend, opened once and shared by all methods; one that was lost is opened again.
//! - A [`Resident`] buffer uploads only when the revision of what it holds changes, or the part of it that did. Uploads and downloads are
//!   counted apart.
//! - [`Gpu::run`] carries out named passes and leaves the device's own times on the meter; where a device cannot tell them, each pass
//!   is submitted and waited for by itself in a span of wall time. [`Gpu::run_and_read`] brings a few numbers back in the same wait.
//! - [`Gpu::parts`] splits items where a binding does not hold them all, [`Resident::items`] is what a pass is given of them.
//! - [`Gpu::open_as`] opens an adapter as if it had less, for tests of what methods do then.
//! - What can go wrong is a [`GpuError`]: no adapter, device lost, out of memory, a shader that does not compile.
//!
//! ```no_run
//! use halflight_contract::NoMeter;
//! use halflight_gpu::{Access, Gpu, Pass, Resident, Revision};
//!
//! # fn main() -> Result<(), halflight_gpu::GpuError> {
//! let (gpu, meter) = (Gpu::open(0)?, &mut NoMeter);
//! let source = "@group(0) @binding(0) var<storage, read_write> values: array<f32>;
//!     @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
//!         if id.x < arrayLength(&values) { values[id.x] *= 2.0; }
//!     }";
//! let double = gpu.pipeline("double", source, &[Access::Write])?;
//! let mut values = Resident::new("values");
//! values.sync(&gpu, Revision(1), meter, || vec![1.0f32, 2.0, 3.0])?;
//! gpu.run(&[Pass { name: "double", pipeline: &double, buffers: &[values.whole()], threads: 3 }], meter)?;
//! assert_eq!(gpu.download::<f32>(&values, 3, meter)?, [2.0, 4.0, 6.0]);
//! # Ok(())
//! # }
//! ```

mod adapter;
mod buffer;
mod device;
mod error;
mod pass;

pub use adapter::{Adapter, adapters, find};
pub use buffer::{Part, Resident};
pub use device::{Access, Gpu, Pipeline};
pub use error::{GpuError, Result};
pub use halflight_scenes::Revision;
pub use pass::{Pass, THREADS};
