//! Where cells run: this machine's cores, a graphics processor, or both side by side.

use crate::Error;
use crate::plan::{Group, Plan};
use halflight_contract::{Backend, Request, Support};
use halflight_results::Cell;

/// Where methods are asked to run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Where {
    /// On this machine's cores.
    #[default]
    Cpu,
    /// On a graphics processor.
    Gpu,
    /// On both.
    Both,
}

/// A graphics processor that cells run on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Processor {
    /// For [`Request::backend`].
    pub backend: Backend,
    /// What [`Cell::backend`] says. It is part of the key: each processor rounds in its own way.
    pub name: String,
    /// What times depend on besides the machine; none where they mean nothing, since the processor's cores do the work.
    pub timed_on: Option<String>,
    /// The device's name.
    pub device: String,
    /// Kind, driver, clock and limits, in words.
    pub about: String,
}

/// The processor that is asked for by number or part of its name, the first if nothing is said; or why there is none.
///
/// # Errors
/// There are some, but none such.
#[cfg(feature = "gpu")]
pub fn processor(wanted: Option<&str>) -> Result<Result<Processor, String>, Error> {
    let number = match halflight_gpu::find(wanted) {
        Ok(number) => number,
        Err(halflight_gpu::GpuError::Unknown { wanted, known }) => {
            return Err(Error::Unknown { kind: "adapter", name: wanted, known });
        }
        Err(error) => return Ok(Err(error.to_string())),
    };
    let adapter = halflight_gpu::adapters().nth(number.into()).expect("just found");
    let timed_on = (!adapter.is_software()).then(|| format!("{} | {}", adapter.name, adapter.driver));
    Ok(Ok(Processor {
        backend: Backend::Gpu(number),
        name: format!("gpu: {adapter}"),
        timed_on,
        device: adapter.name.clone(),
        about: about(adapter),
    }))
}

/// The processor that is asked for, which this build has no way to find.
///
/// # Errors
/// Never.
#[cfg(not(feature = "gpu"))]
pub fn processor(_: Option<&str>) -> Result<Result<Processor, String>, Error> {
    Ok(Err("this program was built without the feature gpu".into()))
}

/// What there is to be said of each adapter, for `halflight doctor`.
#[cfg(feature = "gpu")]
pub(crate) fn adapters() -> Vec<String> {
    let line = |(number, adapter)| format!("{number}: {}", about(adapter));
    let lines: Vec<String> = halflight_gpu::adapters().enumerate().map(line).collect();
    if lines.is_empty() { vec![halflight_gpu::GpuError::NoAdapter.to_string()] } else { lines }
}

#[cfg(feature = "gpu")]
fn about(adapter: &halflight_gpu::Adapter) -> String {
    let halflight_gpu::Adapter { driver, kind, timestamps, max_binding, max_buffer, max_groups, subgroup, .. } =
        adapter;
    let clock = if *timestamps { "a clock of its own" } else { "no clock" };
    format!(
        "{adapter} ({kind}, {driver}); {clock}, bindings of {} MiB, buffers of {} MiB, {max_groups} groups a dimension, {} to {} \
         threads in step",
        max_binding >> 20,
        max_buffer >> 20,
        subgroup[0],
        subgroup[1]
    )
}

/// The same without a way to find them.
#[cfg(not(feature = "gpu"))]
pub(crate) fn adapters() -> Vec<String> {
    vec!["not built in (feature `gpu`)".into()]
}

impl Plan {
    /// The same work on other backends. Where there is no processor, the cells are skipped for the reason given.
    #[must_use]
    pub fn on_backends(mut self, wanted: Where, processor: &Result<Processor, String>) -> Self {
        let scenes = &self.scenes;
        // Side by side, so that they stand side by side.
        let both = |group: Group| {
            let gpu = (wanted != Where::Cpu).then(|| {
                let facts = scenes[group.scene].scene.facts();
                on(&group, processor, |request| group.method.supports(&facts, request))
            });
            (wanted != Where::Gpu).then_some(group.clone()).into_iter().chain(gpu)
        };
        self.groups = std::mem::take(&mut self.groups).into_iter().flat_map(both).collect();
        self
    }
}

fn on(group: &Group, processor: &Result<Processor, String>, supports: impl FnOnce(&Request<'_>) -> Support) -> Group {
    let (name, timed_on) = match processor {
        Ok(processor) => (processor.name.as_str(), processor.timed_on.as_deref()),
        Err(_) => ("gpu", None),
    };
    let cell = |cell: &Cell| Cell {
        backend: name.to_owned(),
        timed_on: cell.timed_on.as_ref().zip(timed_on).map(|(machine, adapter)| format!("{machine} | {adapter}")),
        ..cell.clone()
    };
    let backend = processor.as_ref().map_or(Backend::GPU, |processor| processor.backend);
    let request = Request { quantity: group.quantity, backend, params: &group.params };
    let support = match processor {
        _ if !group.method.info().runs_on(backend) && cfg!(feature = "gpu") => {
            Support::Skip("the method has no GPU backend".into())
        }
        Err(why) => Support::Skip(why.clone()),
        Ok(_) => supports(&request),
    };
    Group { backend, support, cells: group.cells.iter().map(cell).collect(), ..group.clone() }
}
