//! The device: opened once, shared, with the pipelines that it compiled.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::{Arc, Mutex};

use halflight_contract::Backend;

use crate::adapter::{Adapter, Found, found};
use crate::pass::Clock;
use crate::{GpuError, Result};

/// A shader's text and its buffers.
type Text = (String, Vec<Access>);

/// An open device.
pub struct Gpu {
    /// The adapter's number.
    number: u8,
    adapter: Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// Why the device is gone, once it is.
    lost: Arc<Mutex<Option<String>>>,
    pipelines: Mutex<HashMap<Text, Arc<Pipeline>>>,
    /// Not in use at the moment.
    pub(crate) stages: Mutex<Vec<wgpu::Buffer>>,
    /// Not in use at the moment.
    pub(crate) clocks: Mutex<Vec<Clock>>,
}

/// What a shader does with a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// `var<storage, read>`
    Read,
    /// `var<storage, read_write>`
    Write,
}

/// A compiled shader: its entry point is `main`, its buffers are bindings 0, 1, … of group 0.
pub struct Pipeline {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
}

/// The devices that are open, by the backend's number.
static OPEN: Mutex<BTreeMap<u8, Arc<Gpu>>> = Mutex::new(BTreeMap::new());

impl Gpu {
    /// The device of a backend, which all that asks for it shares: opened on first need, and again, as it was, once it was lost.
    ///
    /// # Errors
    /// As [`Gpu::open`], and for the CPU.
    pub fn shared(backend: Backend) -> Result<Arc<Self>> {
        let Backend::Gpu(number) = backend else { return Err(GpuError::NoAdapter) };
        let mut open = OPEN.lock().expect("nothing panics while opening");
        let gpu = match open.get(&number) {
            Some(gpu) if gpu.present().is_ok() => return Ok(Arc::clone(gpu)),
            Some(lost) => Gpu::open_as(lost.number, lost.adapter.clone())?,
            None => Gpu::open(number)?,
        };
        let gpu = Arc::new(gpu);
        open.insert(number, Arc::clone(&gpu));
        Ok(gpu)
    }

    /// Makes this the device of a backend. Under a number that no adapter has, a lesser device ([`Gpu::open_as`]) is there for those
    /// who ask for it and for nobody else: so tests see what methods do on adapters that this machine does not have.
    ///
    /// # Panics
    /// For the CPU.
    pub fn share(self, backend: Backend) -> Arc<Self> {
        let Backend::Gpu(number) = backend else { panic!("{backend} has no device") };
        let gpu = Arc::new(self);
        OPEN.lock().expect("nothing panics while opening").insert(number, Arc::clone(&gpu));
        gpu
    }

    /// Opens the adapter of this number among [`crate::adapters`], with all that it can hold.
    ///
    /// # Errors
    /// There is no such adapter, or its driver refuses.
    pub fn open(number: u8) -> Result<Self> {
        Gpu::open_as(number, physical(number)?.0.clone())
    }

    /// Opens an adapter as if it were one of less memory or without a clock; what it lacks then is refused as that one would.
    ///
    /// # Errors
    /// As [`Gpu::open`]; a limit is beyond what the adapter has.
    pub fn open_as(number: u8, adapter: Adapter) -> Result<Self> {
        let (_, physical) = physical(number)?;
        let timestamps = if adapter.timestamps { wgpu::Features::TIMESTAMP_QUERY } else { wgpu::Features::empty() };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("halflight"),
            required_features: timestamps,
            required_limits: wgpu::Limits {
                max_storage_buffer_binding_size: adapter.max_binding,
                max_buffer_size: adapter.max_buffer,
                max_compute_workgroups_per_dimension: adapter.max_groups,
                ..physical.limits()
            },
            ..wgpu::DeviceDescriptor::default()
        };
        let opened = pollster::block_on(physical.request_device(&descriptor));
        let unusable = |message: String| GpuError::Unusable { adapter: adapter.name.clone(), message };
        let (device, queue) = opened.map_err(|error| unusable(error.to_string()))?;
        let lost = Arc::new(Mutex::new(None));
        let note = Arc::clone(&lost);
        device.set_device_lost_callback(move |_, message| {
            let message = if message.is_empty() { "no reason given".into() } else { message };
            *note.lock().expect("only stores") = Some(message);
        });
        let (stages, clocks) = (Mutex::default(), Mutex::default());
        Ok(Gpu { number, adapter, device, queue, lost, pipelines: Mutex::default(), stages, clocks })
    }

    /// What it runs on.
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// The most bytes of a buffer that a pass can be given; work on more goes part by part ([`Gpu::parts`]).
    pub fn max_binding(&self) -> u64 {
        self.adapter.max_binding.min(self.adapter.max_buffer)
    }

    /// So many items as ranges that a pass can be given, if the largest buffer has so many bytes an item. Each range begins at a
    /// multiple of 64 items, and so of 256 bytes of any buffer.
    pub fn parts(&self, items: u64, bytes: u64) -> impl Iterator<Item = Range<u64>> {
        let fit = self.max_binding() / bytes;
        let most = if items <= fit { items.max(1) } else { (fit & !63).max(64) };
        (0..items).step_by(most as usize).map(move |first| first..items.min(first + most))
    }

    /// Compiles WGSL for these buffers, or takes what was compiled of the same text before.
    ///
    /// # Errors
    /// The text is not valid WGSL, or its buffers are others.
    pub fn pipeline(&self, label: &str, source: &str, buffers: &[Access]) -> Result<Arc<Pipeline>> {
        let key = (source.to_owned(), buffers.to_vec());
        if let Some(known) = self.pipelines.lock().expect("only looks up").get(&key) {
            return Ok(Arc::clone(known));
        }
        let pipeline = Arc::new(self.checked(label, || self.compile(label, source, buffers))?);
        Ok(Arc::clone(self.pipelines.lock().expect("only inserts").entry(key).or_insert(pipeline)))
    }

    fn compile(&self, label: &str, source: &str, buffers: &[Access]) -> Pipeline {
        let label = Some(label);
        let source = wgpu::ShaderSource::Wgsl(source.into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source });
        let entry = |(binding, access): (usize, &Access)| wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: *access == Access::Read },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<_> = buffers.iter().enumerate().map(entry).collect();
        let layout =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let whole = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&whole),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Pipeline { pipeline, layout }
    }

    /// Does something on the device and tells what went wrong with it.
    pub(crate) fn checked<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T> {
        self.present()?;
        let filters = [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let result = work();
        // innermost first; all are popped before any is looked at
        let errors = scopes.into_iter().rev().map(|scope| pollster::block_on(scope.pop())).collect::<Vec<_>>();
        self.present()?;
        let adapter = || self.adapter.name.clone();
        match errors.into_iter().flatten().next() {
            None => Ok(result),
            Some(wgpu::Error::OutOfMemory { .. }) => {
                Err(GpuError::OutOfMemory { adapter: adapter(), what: what.into() })
            }
            Some(error) => Err(self.failed(what, error.to_string())),
        }
    }

    /// Why something failed: the device's loss if it is lost, which may be told later than what it does.
    pub(crate) fn failed(&self, what: &str, message: String) -> GpuError {
        let _ = self.device.poll(wgpu::PollType::Poll);
        let adapter = self.adapter.name.clone();
        self.present().err().unwrap_or_else(|| GpuError::Invalid { adapter, what: what.into(), message })
    }

    /// Waits until the device has done what it was told then.
    pub(crate) fn wait(&self, submission: wgpu::SubmissionIndex) -> Result<()> {
        let done = self.device.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: None });
        if let Err(error) = done {
            self.lost.lock().expect("only stores").get_or_insert_with(|| error.to_string());
        }
        self.present()
    }

    /// Refuses if the device is lost.
    pub(crate) fn present(&self) -> Result<()> {
        match self.lost.lock().expect("only stores").clone() {
            None => Ok(()),
            Some(message) => Err(GpuError::Lost { adapter: self.adapter.name.clone(), message }),
        }
    }

    /// Gives the device up, as if it had been lost: every later call is [`GpuError::Lost`].
    pub fn give_up(&self) {
        // First, so that others know why what they are at fails.
        self.lost.lock().expect("only stores").get_or_insert_with(|| "given up".into());
        self.device.destroy();
    }
}

fn physical(number: u8) -> Result<&'static Found> {
    let missing = || match found().len() {
        0 => GpuError::NoAdapter,
        count => GpuError::Unknown { wanted: number.to_string(), known: format!("{count} adapters") },
    };
    found().get(usize::from(number)).ok_or_else(missing)
}
