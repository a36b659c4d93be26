//! The shaders' texts and what they are compiled to.

use std::sync::Arc;

use halflight_gpu::Access::{Read, Write};
use halflight_gpu::{Gpu, Pipeline};
use halflight_sh::wgsl;

/// The text of each pass.
pub(super) struct Shaders {
    pub(super) elements: String,
    pub(super) groups: String,
    pub(super) receivers: String,
}

/// The passes, compiled.
pub(super) struct Pipelines {
    pub(super) elements: Arc<Pipeline>,
    pub(super) groups: Arc<Pipeline>,
    pub(super) receivers: Arc<Pipeline>,
}

const FOREST: &str = include_str!("../wgsl/forest.wgsl");
const SHADOW: &str = include_str!("../wgsl/shadow.wgsl");

impl Shaders {
    /// For light of this order.
    pub(super) fn new(order: usize) -> Self {
        Shaders {
            elements: [FOREST, SHADOW, include_str!("../wgsl/elements.wgsl")].join("\n"),
            groups: [FOREST, include_str!("../wgsl/groups.wgsl")].join("\n"),
            receivers: [wgsl::generated(order), FOREST, SHADOW, include_str!("../wgsl/receivers.wgsl")].join("\n"),
        }
    }

    pub(super) fn compile(&self, gpu: &Gpu) -> halflight_gpu::Result<Pipelines> {
        Ok(Pipelines {
            elements: gpu.pipeline("elements", &self.elements, &[Read, Read, Read, Write, Read, Write])?,
            groups: gpu.pipeline("groups", &self.groups, &[Read, Read, Write])?,
            receivers: gpu.pipeline("receivers", &self.receivers, &[Read, Read, Read, Write, Read, Read, Write])?,
        })
    }
}
