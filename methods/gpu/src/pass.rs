//! Compute passes and their times.

use halflight_contract::{Meter, timed};

use crate::buffer::Part;
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

impl Gpu {
    /// Carries out passes, each after those before it, and waits. The device's times go to [`Meter::gpu`]; a device that cannot tell
    /// them gets the passes one by one, each in a span of wall time of its name.
    ///
    /// # Errors
    /// A buffer does not suit its shader or is too large to be bound, or the device is lost.
    pub fn run(&self, passes: &[Pass<'_>], meter: &mut dyn Meter) -> Result<()> {
        for part in passes.iter().flat_map(|pass| pass.buffers) {
            self.fits(part)?;
        }
        if self.adapter().timestamps {
            return self.run_timed(passes, meter);
        }
        for pass in passes {
            timed(meter, pass.name, |_| self.submit(std::slice::from_ref(pass), None))?;
        }
        Ok(())
    }

    fn fits(&self, part: &Part<'_>) -> Result<()> {
        let limit = self.max_binding();
        let what = part.buffer.name().into();
        let too_large = || GpuError::TooLarge { adapter: self.adapter().name.clone(), what, bytes: part.bytes, limit };
        if part.bytes <= limit { Ok(()) } else { Err(too_large()) }
    }

    fn run_timed(&self, passes: &[Pass<'_>], meter: &mut dyn Meter) -> Result<()> {
        // Query sets hold at most 4096.
        for passes in passes.chunks(1024) {
            let count = 2 * passes.len() as u32;
            let mut times = Resident::new("timestamps");
            times.reserve_queries(self, u64::from(count) * 8)?;
            let queries = self.checked("timestamps", || {
                self.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("timestamps"),
                    ty: wgpu::QueryType::Timestamp,
                    count,
                })
            })?;
            self.submit(passes, Some((&queries, &times)))?;
            let mut quiet = halflight_contract::NoMeter; // what times themselves cost is not the method's
            let ticks: Vec<u64> = self.download(&times, count as usize, &mut quiet)?;
            let period = f64::from(self.queue.get_timestamp_period());
            for (pass, ticks) in passes.iter().zip(ticks.chunks_exact(2)) {
                meter.gpu(pass.name, (ticks[1].saturating_sub(ticks[0]) as f64 * period) as u64);
            }
        }
        Ok(())
    }

    fn submit(&self, passes: &[Pass<'_>], times: Option<(&wgpu::QuerySet, &Resident)>) -> Result<()> {
        let what = passes.iter().map(|pass| pass.name).collect::<Vec<_>>().join(", ");
        let mut buffers = passes.iter().flat_map(|pass| pass.buffers);
        buffers.try_for_each(|part| part.buffer.buffer().map(|_| ()))?;
        self.checked(&what, || {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            for (number, pass) in passes.iter().enumerate().filter(|(_, pass)| pass.threads > 0) {
                let number = number as u32;
                let timestamp_writes = times.map(|(query_set, _)| wgpu::ComputePassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(2 * number),
                    end_of_pass_write_index: Some(2 * number + 1),
                });
                let bindings = self.bindings(pass);
                let descriptor = wgpu::ComputePassDescriptor { label: Some(pass.name), timestamp_writes };
                let mut open = encoder.begin_compute_pass(&descriptor);
                open.set_pipeline(&pass.pipeline.pipeline);
                open.set_bind_group(0, &bindings, &[]);
                let [across, down] = groups(pass.threads, self.adapter().max_groups);
                open.dispatch_workgroups(across, down, 1);
            }
            if let Some((queries, times)) = times {
                let buffer = times.buffer().expect("reserved");
                encoder.resolve_query_set(queries, 0..2 * passes.len() as u32, buffer, 0);
            }
            self.queue.submit([encoder.finish()]);
        })?;
        self.wait()
    }

    fn bindings(&self, pass: &Pass<'_>) -> wgpu::BindGroup {
        let buffers = pass.buffers.iter().enumerate();
        let entries: Vec<_> = buffers.map(|(binding, part)| entry(binding as u32, part)).collect();
        let layout = &pass.pipeline.layout;
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(pass.name), layout, entries: &entries })
    }
}

fn entry<'a>(binding: u32, part: &Part<'a>) -> wgpu::BindGroupEntry<'a> {
    let buffer = part.buffer.buffer().expect("looked at before");
    let size = std::num::NonZeroU64::new(part.bytes);
    let resource = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: part.offset, size });
    wgpu::BindGroupEntry { binding, resource }
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
