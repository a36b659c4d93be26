//! Lamps on the device.

use halflight_contract::{Meter, Result};
use halflight_gpu::{Gpu, Part, Resident, Revision};

use super::shader::Lamplight;
use crate::stage::Stage;

/// What shaders read of lamps.
pub(super) struct Lamps {
    lamps: Resident,
    /// The paper's table, if lamps light by it.
    lobes: Option<Resident>,
}

impl Lamps {
    /// None if no lamp is lit.
    pub(super) fn new(stage: &Stage<'_>) -> Option<Self> {
        let lobes = stage.lobes.as_ref().map(|_| Resident::new("lobes of lamps"));
        stage.lamplit.then(|| Lamps { lamps: Resident::new("lamps"), lobes })
    }

    pub(super) fn kind(&self) -> Lamplight {
        if self.lobes.is_some() { Lamplight::Lobe } else { Lamplight::Share }
    }

    /// Uploads the lamps of the frame, for a shader of this order of accumulation; the table once.
    pub(super) fn upload(&mut self, gpu: &Gpu, stage: &Stage<'_>, order: usize, meter: &mut dyn Meter) -> Result<()> {
        let window = stage.light_window.iter().copied().chain(std::iter::repeat(0.0));
        // Lamps begin at a multiple of 16 bytes.
        let mut values: Vec<f32> = window.take(order.next_multiple_of(4)).collect();
        for lamp in &stage.lamps {
            values.extend(lamp.sphere.center.extend(lamp.sphere.radius).to_array());
            values.extend(lamp.radiance.extend(0.0).to_array());
        }
        if stage.lamps.is_empty() {
            values.extend([0.0; 8]); // no buffer ends before its first lamp, and this one is dark
        }
        self.lamps.upload(gpu, meter, &values)?;
        if let (Some(table), Some(lobes)) = (&mut self.lobes, &stage.lobes) {
            table.sync(gpu, Revision(0), meter, || lobes.entries().to_vec())?;
        }
        Ok(())
    }

    /// In the order of their bindings.
    pub(super) fn buffers(&self) -> impl Iterator<Item = Part<'_>> {
        std::iter::once(&self.lamps).chain(&self.lobes).map(Resident::whole)
    }

    /// Device bytes, by purpose.
    pub(super) fn bytes(&self) -> Vec<(&'static str, u64)> {
        let lobes = self.lobes.as_ref().map(|lobes| ("lobes of lamps", lobes.bytes()));
        std::iter::once(("lamps", self.lamps.bytes())).chain(lobes).collect()
    }
}
