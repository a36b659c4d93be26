//! Buffers that stay on the device between frames.

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
        self.create(gpu, size, usage)
    }

    /// Room for timestamps.
    pub(crate) fn reserve_queries(&mut self, gpu: &Gpu, size: u64) -> Result<()> {
        self.create(gpu, size, wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC)
    }

    fn create(&mut self, gpu: &Gpu, size: u64, usage: wgpu::BufferUsages) -> Result<()> {
        let what = self.what;
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
        let asked = format!("{what}, {size} bytes");
        self.buffer = Some(gpu.checked(&asked, || gpu.device.create_buffer(&descriptor))?);
        Ok(())
    }

    /// All of it.
    pub fn whole(&self) -> Part<'_> {
        Part { buffer: self, offset: 0, bytes: self.bytes() }
    }

    /// Some of it, from a multiple of 256 bytes on.
    pub fn part(&self, offset: u64, bytes: u64) -> Part<'_> {
        Part { buffer: self, offset, bytes: bytes.max(16) }
    }

    /// Bytes held on the device.
    pub fn bytes(&self) -> u64 {
        self.buffer.as_ref().map_or(0, wgpu::Buffer::size)
    }

    pub(crate) fn name(&self) -> &'static str {
        self.what
    }

    pub(crate) fn buffer(&self) -> Result<&wgpu::Buffer> {
        let empty = || GpuError::Invalid {
            adapter: String::new(),
            what: self.what.into(),
            message: "the buffer was never filled".into(),
        };
        self.buffer.as_ref().ok_or_else(empty)
    }
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
            self.fetch(from, offset, out)?;
            offset += out.len() as u64;
        }
        Ok(values)
    }

    fn fetch(&self, from: &Resident, offset: u64, out: &mut [u8]) -> Result<()> {
        let (source, size) = (from.buffer()?, out.len() as u64);
        let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        let descriptor = wgpu::BufferDescriptor { label: Some("stage"), size, usage, mapped_at_creation: false };
        let stage = self.checked(from.what, || {
            let stage = self.device.create_buffer(&descriptor);
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(source, offset, &stage, 0, size);
            self.queue.submit([encoder.finish()]);
            stage.map_async(wgpu::MapMode::Read, .., |_| ());
            stage
        })?;
        self.wait()?;
        let failed = |error: String| GpuError::Invalid {
            adapter: self.adapter().name.clone(),
            what: from.what.into(),
            message: error,
        };
        let view = stage.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
        out.copy_from_slice(&view);
        Ok(())
    }
}
