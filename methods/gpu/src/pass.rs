//! Compute passes and their times.

use bytemuck::Pod;
use halflight_contract::{Meter, timed};

use crate::buffer::{Copy, Part};
use crate::device::{Gpu, Pipeline};
use crate::{GpuError, Resident, Result};

/// Threads of a group: what every shader's `@workgroup_size` is.
pub const THREADS: u64 = 64;

/// One run of a shader.
pub struct Pass<'a> {
    /// What it does, for the meter.
    pub name: &'static str,
    /// The shader.
    pub pipeline: &'a Pipeline,
    /// Its buffers, in the order of their bindings.
    pub buffers: &'a [Part<'a>],
    /// How many threads are wanted. There may be more, and groups may lie in two dimensions: a thread's number is
    /// `(group.y · groups.x + group.x) · 64` plus its place in the group.
    pub threads: u64,
}

/// Passes that one submission times.
const TIMED: usize = 256;

/// What passes are timed with: two marks a pass, and where they are put.
pub(crate) struct Clock {
    marks: wgpu::QuerySet,
    ticks: wgpu::Buffer,
}

impl Gpu {
    /// Carries out passes, each after those before it, and waits. The device's times go to [`Meter::gpu`]; a device that cannot tell
    /// them gets the passes one by one, each in a span of wall time of its name.
    ///
    /// # Errors
    /// A buffer does not suit its shader or is too large to be bound, or the device is lost.
    pub fn run(&self, passes: &[Pass<'_>], meter: &mut dyn Meter) -> Result<()> {
        self.carry_out(passes, None, meter).map(drop)
    }

    /// The same, then the first values of a buffer: submitted and waited for together. For a few numbers; [`Gpu::download`] brings back
    /// what is large.
    ///
    /// # Errors
    /// As [`Gpu::run`] and [`Gpu::download`].
    pub fn run_and_read<T: Pod>(
        &self,
        passes: &[Pass<'_>],
        from: &Resident,
        count: usize,
        meter: &mut dyn Meter,
    ) -> Result<Vec<T>> {
        let bytes = (count * size_of::<T>()) as u64;
        meter.count("bytes downloaded", bytes);
        let read = self.carry_out(passes, Some(Copy { from: from.buffer(self)?, offset: 0, bytes }), meter)?;
        Ok(bytemuck::pod_collect_to_vec(&read))
    }

    fn carry_out(&self, passes: &[Pass<'_>], last: Option<Copy<'_>>, meter: &mut dyn Meter) -> Result<Vec<u8>> {
        for part in passes.iter().flat_map(|pass| pass.buffers) {
            self.fits(part)?;
        }
        // A mark that is never set is waited for forever.
        let passes: Vec<&Pass<'_>> = passes.iter().filter(|pass| pass.threads > 0).collect();
        if passes.is_empty() && last.is_none() {
            return self.present().map(|()| Vec::new());
        }
        if !self.adapter().timestamps {
            for pass in &passes {
                timed(meter, pass.name, |_| {
                    self.submit(pass.name, |encoder| self.record(encoder, pass, None), &[], |_| ())
                })?;
            }
            return self.timed(&[], last, meter);
        }
        let (before, rest) = passes.split_at(passes.len().saturating_sub(1) / TIMED * TIMED);
        for passes in before.chunks(TIMED) {
            self.timed(passes, None, meter)?;
        }
        self.timed(rest, last, meter)
    }

    fn fits(&self, part: &Part<'_>) -> Result<()> {
        part.buffer.buffer(self)?;
        let limit = self.max_binding();
        let what = part.buffer.name().into();
        let too_large = || GpuError::TooLarge { adapter: self.adapter().name.clone(), what, bytes: part.bytes, limit };
        if part.bytes <= limit { Ok(()) } else { Err(too_large()) }
    }

    /// Runs passes between marks and reads something after them.
    fn timed(&self, passes: &[&Pass<'_>], last: Option<Copy<'_>>, meter: &mut dyn Meter) -> Result<Vec<u8>> {
        let clock = if passes.is_empty() { None } else { Some(self.clock()?) };
        let marks = 2 * passes.len() as u32;
        let ticks = clock.as_ref().map(|clock| Copy { from: &clock.ticks, offset: 0, bytes: 8 * u64::from(marks) });
        let copies: Vec<Copy<'_>> = ticks.into_iter().chain(last).collect();
        let what = passes.iter().map(|pass| pass.name).collect::<Vec<_>>().join(", ");
        let record = |encoder: &mut wgpu::CommandEncoder| {
            let Some(clock) = &clock else { return };
            for (number, pass) in passes.iter().enumerate() {
                let begin = 2 * number as u32;
                let writes = wgpu::ComputePassTimestampWrites {
                    query_set: &clock.marks,
                    beginning_of_pass_write_index: Some(begin),
                    end_of_pass_write_index: Some(begin + 1),
                };
                self.record(encoder, pass, Some(writes));
            }
            encoder.resolve_query_set(&clock.marks, 0..marks, &clock.ticks, 0);
        };
        let (mut ticks, mut read) = (Vec::<u64>::new(), Vec::new());
        self.submit(&what, record, &copies, |bytes| {
            let (times, rest) = bytes.split_at(8 * marks as usize);
            ticks = bytemuck::pod_collect_to_vec(times);
            read = rest.to_vec();
        })?;
        let period = f64::from(self.queue.get_timestamp_period());
        for (pass, ticks) in passes.iter().zip(ticks.chunks_exact(2)) {
            meter.gpu(pass.name, (ticks[1].saturating_sub(ticks[0]) as f64 * period) as u64);
        }
        self.clocks.lock().expect("only stores").extend(clock);
        Ok(read)
    }

    /// A clock that nobody uses.
    fn clock(&self) -> Result<Clock> {
        if let Some(clock) = self.clocks.lock().expect("only stores").pop() {
            return Ok(clock);
        }
        let count = 2 * TIMED as u32;
        let descriptor = wgpu::QuerySetDescriptor { label: Some("timestamps"), ty: wgpu::QueryType::Timestamp, count };
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let ticks = self.create("timestamps", 8 * u64::from(count), usage)?;
        Ok(Clock { marks: self.checked("timestamps", || self.device.create_query_set(&descriptor))?, ticks })
    }

    fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &Pass<'_>,
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let bindings = self.bindings(pass);
        let descriptor = wgpu::ComputePassDescriptor { label: Some(pass.name), timestamp_writes };
        let mut open = encoder.begin_compute_pass(&descriptor);
        open.set_pipeline(&pass.pipeline.pipeline);
        open.set_bind_group(0, &bindings, &[]);
        let [across, down] = groups(pass.threads, self.adapter().max_groups);
        open.dispatch_workgroups(across, down, 1);
    }

    fn bindings(&self, pass: &Pass<'_>) -> wgpu::BindGroup {
        let buffers = pass.buffers.iter().enumerate();
        let entries: Vec<_> = buffers.map(|(binding, part)| self.entry(binding as u32, part)).collect();
        let layout = &pass.pipeline.layout;
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(pass.name), layout, entries: &entries })
    }

    fn entry<'a>(&self, binding: u32, part: &Part<'a>) -> wgpu::BindGroupEntry<'a> {
        let buffer = part.buffer.buffer(self).expect("looked at before");
        let size = std::num::NonZeroU64::new(part.bytes);
        let resource = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: part.offset, size });
        wgpu::BindGroupEntry { binding, resource }
    }
}

/// Groups in two dimensions, none above the limit, that hold so many threads.
fn groups(threads: u64, limit: u32) -> [u32; 2] {
    let groups = threads.div_ceil(THREADS);
    let down = groups.div_ceil(u64::from(limit)).max(1);
    [groups.div_ceil(down) as u32, down as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_suffice_and_keep_the_limit() {
        for threads in [1, 64, 65, 64 * 65_535, 64 * 65_535 + 1, 1 << 30] {
            let [across, down] = groups(threads, 65_535).map(u64::from);
            assert!(across <= 65_535 && across * down * THREADS >= threads, "{threads}: {across} by {down}");
            assert!(across * down * THREADS < threads + THREADS * (down + 1), "{threads}: {across} by {down}");
        }
    }
}
