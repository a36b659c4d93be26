//! Receivers on the device: the valid ones, without gaps.

use std::ops::Range;

use halflight_contract::{Meter, Result};
use halflight_gpu::{Gpu, Part, Resident};
use halflight_horizons::place;
use halflight_scenes::Receivers;

use crate::shading::Ground;

/// Bytes of a receiver's normal and albedo, each padded.
pub(super) const BYTES: u64 = 32;

/// Bytes of where a receiver is on the field.
const PLACE: u64 = 16;

/// Receivers, and where they are on the field.
pub(super) struct Seers {
    known: Vec<[u32; 4]>,
    places: Resident,
    receivers: Resident,
    /// Their numbers by their place on the device, of how many.
    valid: Vec<u32>,
    count: usize,
}

impl Seers {
    /// None.
    pub(super) fn new() -> Self {
        let [places, receivers] = ["places", "receivers"].map(Resident::new);
        Seers { known: Vec::new(), places, receivers, valid: Vec::new(), count: 0 }
    }

    /// Uploads those that are not there yet, on a field of so many columns and rows.
    pub(super) fn sync(
        &mut self,
        gpu: &Gpu,
        from: &Receivers,
        ground: (Ground, [usize; 2]),
        meter: &mut dyn Meter,
    ) -> Result<()> {
        let (valid, (ground, size)) = (&mut self.valid, ground);
        self.count = from.len();
        self.receivers.sync(gpu, from.revision, meter, || {
            *valid = (0..from.len() as u32).filter(|&i| from.valid[i as usize]).collect();
            let seer = |&i: &u32| [from.normal[i as usize], from.albedo[i as usize]].map(|v| v.extend(0.0).to_array());
            valid.iter().map(seer).collect::<Vec<_>>()
        })?;
        let at = |&i: &u32| place(ground.place(from, i as usize).to_array(), size);
        let places: Vec<[u32; 4]> = self.valid.iter().map(at).collect();
        if places != self.known || self.places.bytes() == 0 {
            self.places.upload(gpu, meter, &places)?;
            self.known = places;
        }
        Ok(())
    }

    /// How many there are on the device.
    pub(super) fn len(&self) -> u64 {
        self.valid.len() as u64
    }

    /// Where some are on the field.
    pub(super) fn places(&self, part: &Range<u64>) -> Part<'_> {
        self.places.items(part.clone(), PLACE)
    }

    /// Normals and albedos of some.
    pub(super) fn receivers(&self, part: &Range<u64>) -> Part<'_> {
        self.receivers.items(part.clone(), BYTES)
    }

    /// Values of those on the device, so many each, among those of all, which are 0.
    pub(super) fn spread(&self, values: &[f32], each: usize) -> Vec<f32> {
        let mut all = vec![0.0; self.count * each];
        for (&receiver, values) in self.valid.iter().zip(values.chunks_exact(each)) {
            all[receiver as usize * each..][..each].copy_from_slice(values);
        }
        all
    }

    /// Bytes on the host and on the device.
    pub(super) fn bytes(&self) -> (usize, u64) {
        let host = size_of_val(&self.known[..]) + size_of_val(&self.valid[..]);
        (host, self.places.bytes() + self.receivers.bytes())
    }
}
