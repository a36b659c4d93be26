//! What the passes did: for `Meter::work`.

use halflight_contract::Meter;

use super::{GpuPyramid, looked_at, words};
use crate::Plane;
use crate::shape::Shape;

/// Operations on a height between samples: the samples' shares along both axes, a fused sum for each sample and each row.
fn height(plane: Plane) -> u64 {
    let (taps, shares) = match plane {
        Plane::Bilinear => (2, 1),
        Plane::BSpline => (4, 17),
    };
    2 * shares + 2 * taps * (taps + 1)
}

impl GpuPyramid {
    /// All levels made out of the heights and brought back, each level read once and written once.
    pub(super) fn tell_levels(&self, shape: &Shape, meter: &mut dyn Meter) {
        let [levels, back] = [&shape.levels, &shape.back].map(|grids| &grids[looked_at(shape)]);
        let coarser = &levels[..levels.len() - 1];
        let [all, made, back] = [levels, coarser, back].map(words::samples);
        meter.work("decimate", height(Plane::Bilinear) * made, 4 * (all + made));
        meter.work("bring back", height(self.settings.reconstruction.plane) * back, 4 * (all + back));
    }

    /// Horizons of so many receivers: two heights a sample, their difference over the distance.
    pub fn tell_horizons(&self, receivers: u64, meter: &mut dyn Meter) {
        let azimuths = self.azimuths.len() as u64;
        let each = 2 * height(self.settings.reconstruction.plane) + 2;
        let bytes = self.back.bytes() + self.steps.bytes() + receivers * (16 + 4 * azimuths);
        meter.work("horizons", receivers * azimuths * self.samples() as u64 * each, bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In `bilinear.wgsl`, `b_spline.wgsl` and `grids.wgsl`.
    #[test]
    fn heights_are_as_counted_by_hand() {
        assert_eq!(height(Plane::Bilinear), 2 + 4 * 2 + 2 * 2);
        // A share of an inner sample takes 5, of an outer one 3, what is left of the way 1.
        assert_eq!(height(Plane::BSpline), 2 * (2 * 5 + 2 * 3 + 1) + 16 * 2 + 4 * 2);
    }
}
