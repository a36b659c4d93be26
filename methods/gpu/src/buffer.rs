//! Buffers that stay on the device between frames.

use std::ops::Range;
use std::sync::mpsc;

use bytemuck::Pod;
use halflight_contract::Meter;
use halflight_scenes::Revision;

use crate::device::Gpu;
use crate::{GpuError, Result};

/// The most bytes that one copy brings back.
const STAGE: u64 = 64 << 20;

/// A buffer on the device, empty at first.
#[derive(Debug)]
pub struct Resident {
    what: &'static str,
    buffer: Option<wgpu::Buffer>,
    revision: Option<Revision>,
}

/// Some bytes of a buffer, as a pass is given them.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    pub(crate) buffer: &'a Resident,
    pub(crate) offset: u64,
    pub(crate) bytes: u64,
}

impl Resident {
    /// A buffer of this name, without content.
    pub fn new(what: &'static str) -> Self {
        Resident { what, buffer: None, revision: None }
    }

    /// Uploads what `fill` gives if the buffer holds another revision; otherwise `fill` is not called.
    ///
    /// # Errors
    /// It does not fit, or the device is lost.
    pub fn sync<T: Pod>(
        &mut self,
        gpu: &Gpu,
        revision: Revision,
        meter: &mut dyn Meter,
        fill: impl FnOnce() -> Vec<T>,
    ) -> Result<()> {
        if self.revision == Some(revision) {
            return Ok(());
        }
        self.upload(gpu, meter, &fill())?;
        self.revision = Some(revision);
        Ok(())
    }

    /// Uploads values, whatever it held.
    ///
    /// # Errors
    /// As [`Resident::sync`].
    pub fn upload<T: Pod>(&mut self, gpu: &Gpu, meter: &mut dyn Meter, values: &[T]) -> Result<()> {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        self.reserve(gpu, bytes.len() as u64)?;
        let buffer = self.buffer.as_ref().expect("just reserved");
        if !bytes.is_empty() {
            gpu.checked(self.what, || gpu.queue.write_buffer(buffer, 0, bytes))?;
        }
        meter.count("bytes uploaded", bytes.len() as u64);
        Ok(())
    }

    /// Uploads values over those from `first` on, and leaves the rest as it is.
    ///
    /// # Errors
    /// The buffer does not hold so many, or the device is lost.
    pub fn write<T: Pod>(&self, gpu: &Gpu, meter: &mut dyn Meter, first: usize, values: &[T]) -> Result<()> {
        let (buffer, offset) = (self.buffer(gpu)?, (first * size_of::<T>()) as u64);
        let bytes: &[u8] = bytemuck::cast_slice(values);
        if !bytes.is_empty() {
            gpu.checked(self.what, || gpu.queue.write_buffer(buffer, offset, bytes))?;
        }
        meter.count("bytes uploaded", bytes.len() as u64);
        Ok(())
    }

    /// Makes room for so many bytes, a multiple of 4; what it held may be gone.
    ///
    /// # Errors
    /// As [`Resident::sync`].
    pub fn reserve(&mut self, gpu: &Gpu, bytes: u64) -> Result<()> {
        self.revision = None;
        // A binding is never empty.
        let size = bytes.max(16);
        if self.buffer.as_ref().is_some_and(|buffer| buffer.size() == size) {
            return Ok(());
        }
        let (what, limit) = (self.what, gpu.adapter().max_buffer);
        if size > limit {
            let adapter = gpu.adapter().name.clone();
            return Err(GpuError::TooLarge { adapter, what: what.into(), bytes, limit });
        }
        self.buffer = None;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let asked = format!("{what}, {size} bytes");
        self.buffer = Some(gpu.create(&asked, size, usage)?);
        Ok(())
    }

    /// All of it.
    pub fn whole(&self) -> Part<'_> {
        Part { buffer: self, offset: 0, bytes: self.bytes() }
    }

    /// Some of it, from a multiple of 256 bytes on.
    pub fn part(&self, offset: u64, bytes: u64) -> Part<'_> {
        Part { buffer: self, offset, bytes }
    }

    /// Some of its items, of so many bytes each ([`Gpu::parts`]).
    pub fn items(&self, range: Range<u64>, bytes: u64) -> Part<'_> {
        self.part(range.start * bytes, (range.end - range.start) * bytes)
    }

    /// Bytes held on the device.
    pub fn bytes(&self) -> u64 {
        self.buffer.as_ref().map_or(0, wgpu::Buffer::size)
    }

    pub(crate) fn name(&self) -> &'static str {
        self.what
    }

    pub(crate) fn buffer(&self, gpu: &Gpu) -> Result<&wgpu::Buffer> {
        let empty = || GpuError::Invalid {
            adapter: gpu.adapter().name.clone(),
            what: self.what.into(),
            message: "the buffer was never filled".into(),
        };
        self.buffer.as_ref().ok_or_else(empty)
    }
}

/// Bytes of a buffer that are to be brought back.
pub(crate) struct Copy<'a> {
    pub(crate) from: &'a wgpu::Buffer,
    pub(crate) offset: u64,
    pub(crate) bytes: u64,
}

impl Gpu {
    /// The first values of a buffer.
    ///
    /// # Errors
    /// The buffer does not hold so many, or the device is lost.
    pub fn download<T: Pod>(&self, from: &Resident, count: usize, meter: &mut dyn Meter) -> Result<Vec<T>> {
        let mut values = vec![T::zeroed(); count];
        let all: &mut [u8] = bytemuck::cast_slice_mut(&mut values);
        meter.count("bytes downloaded", all.len() as u64);
        let mut offset = 0;
        for out in all.chunks_mut(STAGE as usize) {
            let copy = Copy { from: from.buffer(self)?, offset, bytes: out.len() as u64 };
            self.submit(from.what, |_| (), &[copy], |bytes| out.copy_from_slice(bytes))?;
            offset += out.len() as u64;
        }
        Ok(values)
    }

    /// Has the device do what is recorded, waits, and reads what is to be brought back, one copy after the other.
    pub(crate) fn submit(
        &self,
        what: &str,
        record: impl FnOnce(&mut wgpu::CommandEncoder),
        copies: &[Copy<'_>],
        read: impl FnOnce(&[u8]),
    ) -> Result<()> {
        let bytes = copies.iter().map(|copy| copy.bytes).sum();
        let stage = self.stage(bytes)?;
        let (tell, told) = mpsc::channel();
        let submission = self.checked(what, || {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            record(&mut encoder);
            let mut to = 0;
            for copy in copies {
                encoder.copy_buffer_to_buffer(copy.from, copy.offset, &stage, to, copy.bytes);
                to += copy.bytes;
            }
            let submission = self.queue.submit([encoder.finish()]);
            if bytes > 0 {
                stage.map_async(wgpu::MapMode::Read, ..bytes, move |mapped| {
                    // Nobody listens any more where the device was lost.
                    let _ = tell.send(mapped);
                });
            }
            submission
        })?;
        self.wait(submission)?;
        if bytes > 0 {
            // Another thread that waits may be the one that tells.
            told.recv()
                .map_err(|error| self.failed(what, error.to_string()))?
                .map_err(|error| self.failed(what, error.to_string()))?;
            read(&stage.get_mapped_range(..bytes).map_err(|error| self.failed(what, error.to_string()))?);
            stage.unmap();
        }
        self.stages.lock().expect("only stores").push(stage);
        Ok(())
    }

    /// A buffer of at least so many bytes that the processor's cores can read: one that was used before if it is large enough.
    fn stage(&self, bytes: u64) -> Result<wgpu::Buffer> {
        let known = self.stages.lock().expect("only stores").pop();
        match known.filter(|stage| stage.size() >= bytes) {
            Some(stage) => Ok(stage),
            None => {
                let size = bytes.next_power_of_two().max(4096);
                self.create("stage", size, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ)
            }
        }
    }

    pub(crate) fn create(&self, what: &str, size: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer> {
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
        self.checked(what, || self.device.create_buffer(&descriptor))
    }
}
