//! The device: opened once, shared, with the pipelines that it compiled.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex};

use halflight_contract::Backend;

use crate::adapter::{Adapter, found};
use crate::{GpuError, Result};

/// A shader's text and its buffers.
type Text = (String, Vec<Access>);

/// An open device.
pub struct Gpu {
    adapter: &'static Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// Why the device is gone, once it is.
    lost: Arc<Mutex<Option<String>>>,
    pipelines: Mutex<HashMap<Text, Arc<Pipeline>>>,
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

/// The devices that are open, by the adapter's number.
static OPEN: Mutex<BTreeMap<u8, Arc<Gpu>>> = Mutex::new(BTreeMap::new());

impl Gpu {
    /// The device of a backend, which all that asks for it shares: opened on first need, and again once it was lost.
    ///
    /// # Errors
    /// As [`Gpu::open`], and for the CPU.
    pub fn shared(backend: Backend) -> Result<Arc<Self>> {
        let Backend::Gpu(number) = backend else { return Err(GpuError::NoAdapter) };
        let mut open = OPEN.lock().expect("nothing panics while opening");
        if let Some(gpu) = open.get(&number).filter(|gpu| gpu.present().is_ok()) {
            return Ok(Arc::clone(gpu));
        }
        let gpu = Arc::new(Gpu::open(number)?);
        open.insert(number, Arc::clone(&gpu));
        Ok(gpu)
    }

    /// Opens the adapter of this number among [`crate::adapters`], with all that it can hold.
    ///
    /// # Errors
    /// There is no such adapter, or its driver refuses.
    pub fn open(number: u8) -> Result<Self> {
        let Some((adapter, physical)) = found().get(usize::from(number)) else {
            return Err(match found().len() {
                0 => GpuError::NoAdapter,
                count => GpuError::Unknown { wanted: number.to_string(), known: format!("{count} adapters") },
            });
        };
        let timestamps = if adapter.timestamps { wgpu::Features::TIMESTAMP_QUERY } else { wgpu::Features::empty() };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("halflight"),
            required_features: timestamps,
            required_limits: physical.limits(),
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
        Ok(Gpu { adapter, device, queue, lost, pipelines: Mutex::default() })
    }

    /// What it runs on.
    pub fn adapter(&self) -> &'static Adapter {
        self.adapter
    }

    /// The most bytes of a buffer that a pass can be given; work on more goes part by part.
    pub fn max_binding(&self) -> u64 {
        self.adapter.max_binding.min(self.adapter.max_buffer)
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
            Some(error) => Err(GpuError::Invalid { adapter: adapter(), what: what.into(), message: error.to_string() }),
        }
    }

    /// Waits until the device has done all that it was told.
    pub(crate) fn wait(&self) -> Result<()> {
        let done = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.present()?;
        done.map(|_| ())
            .map_err(|error| GpuError::Lost { adapter: self.adapter.name.clone(), message: error.to_string() })
    }

    /// Refuses if the device is lost.
    fn present(&self) -> Result<()> {
        match self.lost.lock().expect("only stores").clone() {
            None => Ok(()),
            Some(message) => Err(GpuError::Lost { adapter: self.adapter.name.clone(), message }),
        }
    }

    /// Gives the device up, as if it had been lost: every later call is [`GpuError::Lost`].
    pub fn give_up(&self) {
        self.device.destroy();
        // The callback comes with the next look at the device, which cannot fail in a way that matters.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.lost.lock().expect("only stores").get_or_insert_with(|| "given up".into());
    }
}
