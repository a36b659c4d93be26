//! The adapters of this machine.

use std::fmt;
use std::sync::OnceLock;

use crate::{GpuError, Result};

/// A graphics processor, or a program that stands for one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// The device's name.
    pub name: String,
    /// The driver's name and version.
    pub driver: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// Whether passes can be timed by the device's clock.
    pub timestamps: bool,
    /// The most bytes of a buffer that a shader can be given.
    pub max_binding: u64,
    /// The most bytes of a buffer.
    pub max_buffer: u64,
    /// The most groups of threads in a dimension.
    pub max_groups: u32,
    /// The least and the most threads that run in step.
    pub subgroup: [u32; 2],
}

impl Adapter {
    /// Whether the processor's cores do the work: results count, times do not.
    pub fn is_software(&self) -> bool {
        self.kind == "software"
    }
}

impl fmt::Display for Adapter {
    /// The name, with what is to be known of its times.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        if self.is_software() { f.write_str(", correctness only") } else { Ok(()) }
    }
}

/// An adapter and what opens it.
pub(crate) type Found = (Adapter, wgpu::Adapter);

/// All adapters: discrete ones first, software last, otherwise as the system lists them. Asked once a process.
pub fn adapters() -> impl Iterator<Item = &'static Adapter> {
    found().iter().map(|(adapter, _)| adapter)
}

/// The number among [`adapters`] of the one wanted: by number or by part of its name, case ignored; the first if nothing is said.
///
/// # Errors
/// There is none at all, or none such.
pub fn find(wanted: Option<&str>) -> Result<u8> {
    let names: Vec<&str> = adapters().map(|adapter| adapter.name.as_str()).collect();
    choose(&names, wanted)
}

fn choose(names: &[&str], wanted: Option<&str>) -> Result<u8> {
    if names.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let Some(wanted) = wanted else { return Ok(0) };
    let named = |name: &&str| name.to_lowercase().contains(&wanted.to_lowercase());
    let number = wanted.parse().ok().filter(|number| *number < names.len());
    let found = number.or_else(|| names.iter().position(named).filter(|_| !wanted.is_empty()));
    found.and_then(|number| u8::try_from(number).ok()).ok_or_else(|| {
        let known: Vec<String> = names.iter().enumerate().map(|(number, name)| format!("{number}: {name}")).collect();
        GpuError::Unknown { wanted: wanted.into(), known: known.join(", ") }
    })
}

pub(crate) fn found() -> &'static [Found] {
    static FOUND: OnceLock<Vec<Found>> = OnceLock::new();
    FOUND.get_or_init(|| {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::VULKAN;
        let instance = wgpu::Instance::new(descriptor);
        let listed = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
        let mut found: Vec<Found> = listed.into_iter().map(|adapter| (describe(&adapter), adapter)).collect();
        let kinds = ["discrete", "integrated", "virtual", "other", "software"];
        found.sort_by_key(|(adapter, _)| kinds.iter().position(|kind| *kind == adapter.kind));
        found
    })
}

fn describe(adapter: &wgpu::Adapter) -> Adapter {
    let (info, limits) = (adapter.get_info(), adapter.limits());
    Adapter {
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete",
            wgpu::DeviceType::IntegratedGpu => "integrated",
            wgpu::DeviceType::VirtualGpu => "virtual",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        },
        name: info.name,
        timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        max_binding: limits.max_storage_buffer_binding_size,
        max_buffer: limits.max_buffer_size,
        max_groups: limits.max_compute_workgroups_per_dimension,
        subgroup: [info.subgroup_min_size, info.subgroup_max_size],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adapters_are_chosen_by_number_or_name() {
        let names = ["NVIDIA H100", "llvmpipe (LLVM 15)"];
        for (wanted, number) in [(None, 0), (Some("1"), 1), (Some("LLVMpipe"), 1), (Some("h100"), 0), (Some("15"), 1)] {
            assert_eq!(choose(&names, wanted), Ok(number), "{wanted:?}");
        }
        let error = choose(&names, Some("radeon")).unwrap_err().to_string();
        assert!(error.contains("\"radeon\"") && error.contains("1: llvmpipe"), "{error}");
        assert!(choose(&names, Some("")).is_err());
        assert_eq!(choose(&[], Some("0")), Err(GpuError::NoAdapter));
    }
}
