//! Ratio vectors: what makes the log of a bounding sphere's circle look like the logs of what it bounds (Ren 2006, eq. 37).

use halflight_proxies::Circle;
use halflight_sh::{Batch, Block, LANES};

/// Finds ratio vectors, detailed circles in a lane each.
///
/// The bounding log is zonal. By the addition theorem its dot product with the log of a detailed circle is, band by band, the product of
/// their zonal coefficients times `P_l` of the angle between the axes: no vector needs to be rotated for
/// `w_l = Σ z_l(detail) P_l(cos γ) / z_l(bound)`.
pub(crate) struct Ratios {
    batch: Batch,
    sines: Block<f32>,
    cosines: Block<f32>,
    filled: usize,
    zonal: Vec<Block<f32>>,
    sums: Vec<f32>,
}

impl Ratios {
    pub(crate) fn new(batch: Batch) -> Self {
        let order = batch.order();
        let (zonal, sums) = (vec![Block::ZERO; order], vec![0.0; order]);
        Ratios { batch, sines: Block::ZERO, cosines: Block::ZERO, filled: 0, zonal, sums }
    }

    /// Writes the factors that bring the bands of a bounding log closest to the sum of detailed ones, and returns how many had to be bounded:
    /// none is larger than there are circles in detail, and a band that the bounding log lacks stays as it is.
    pub(crate) fn ratio(&mut self, bound: Circle, detail: impl Iterator<Item = Circle>, ratio: &mut [f32]) -> u64 {
        self.sums.fill(0.0);
        let mut circles = 0;
        for circle in detail {
            self.sines.0[self.filled] = circle.sin_angle;
            self.cosines.0[self.filled] = circle.axis.dot(bound.axis);
            self.filled += 1;
            circles += 1;
            if self.filled == LANES {
                self.flush();
            }
        }
        self.flush();
        self.batch.circle_logs(&[Block::splat(bound.sin_angle)], &mut self.zonal);
        let mut bounded = 0;
        for ((sum, zonal), ratio) in self.sums.iter().zip(&self.zonal).zip(ratio) {
            let exact = sum / zonal.0[0];
            *ratio = if exact.is_nan() { 1.0 } else { exact.clamp(-circles as f32, circles as f32) };
            bounded += u64::from(*ratio != exact);
        }
        bounded
    }

    /// Adds `z_l P_l` of all lanes to the sums.
    fn flush(&mut self) {
        self.sines.0[self.filled..].fill(0.0); // blocks nothing: all bands are 0
        self.batch.circle_logs(&[self.sines], &mut self.zonal);
        let (mut below, mut legendre) = ([0.0; LANES], [1.0; LANES]);
        for (l, (zonal, sum)) in self.zonal.iter().zip(&mut self.sums).enumerate() {
            let (factor, rest) = ((2 * l + 1) as f32 / (l + 1) as f32, l as f32 / (l + 1) as f32);
            for lane in 0..LANES {
                *sum += zonal.0[lane] * legendre[lane];
                let above = factor * self.cosines.0[lane] * legendre[lane] - rest * below[lane];
                (below[lane], legendre[lane]) = (legendre[lane], above);
            }
        }
        self.filled = 0;
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use halflight_sh::{CircleTable, MAX_ORDER, coefficients, rotate_zonal};

    use super::*;

    fn circle(x: f32, y: f32, degrees: f32) -> Circle {
        Circle { axis: Vec3::new(x, y, 1.0).normalize(), sin_angle: degrees.to_radians().sin() }
    }

    fn log(order: usize, circle: &Circle) -> Vec<f32> {
        let (mut zonal, mut log) = (vec![0.0; order], vec![0.0; coefficients(order)]);
        CircleTable::log(order).lookup(circle.sin_angle, &mut zonal);
        rotate_zonal(order, &zonal, circle.axis.to_array(), &mut log);
        log
    }

    /// (37) as printed.
    fn printed(order: usize, bound: &Circle, detail: &[Circle]) -> Vec<f32> {
        let (bounding, mut detailed) = (log(order, bound), vec![0.0; coefficients(order)]);
        for circle in detail {
            detailed.iter_mut().zip(log(order, circle)).for_each(|(sum, value)| *sum += value);
        }
        let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
        let band = |l: usize| coefficients(l)..coefficients(l + 1);
        (0..order)
            .map(|l| dot(&bounding[band(l)], &detailed[band(l)]) / dot(&bounding[band(l)], &bounding[band(l)]))
            .collect()
    }

    #[test]
    fn ratios_are_the_least_squares_scaling_of_bands() {
        let bound = circle(0.1, -0.2, 22.0);
        let detail: Vec<Circle> = (0..37)
            .map(|i| {
                let (angle, reach) = (2.4 * i as f32, 0.05 * (i as f32).sqrt());
                circle(0.1 + reach * angle.cos(), -0.2 + reach * angle.sin(), 1.0 + 0.15 * i as f32)
            })
            .collect();
        for order in 1..=MAX_ORDER {
            let mut ratio = vec![f32::NAN; order];
            let bounded = Ratios::new(Batch::new(order)).ratio(bound, detail.iter().copied(), &mut ratio);
            assert_eq!(bounded, 0);
            for (found, expected) in ratio.iter().zip(printed(order, &bound, &detail)) {
                assert!(
                    (found - expected).abs() < 2e-4 * expected.abs().max(1.0),
                    "order {order}: {found}, {expected}"
                );
            }
        }
    }

    #[test]
    fn a_circle_that_bounds_itself_alone_is_not_scaled() {
        let mut ratios = Ratios::new(Batch::new(4));
        for degrees in [1e-3, 1.0, 30.0, 60.0, 90.0] {
            let (one, mut ratio) = (circle(0.3, 0.4, degrees), [0.0; 4]);
            ratios.ratio(one, [one].into_iter(), &mut ratio);
            assert!(ratio.iter().all(|value| (value - 1.0).abs() < 1e-4), "{degrees}°: {ratio:?}");
        }
    }

    #[test]
    fn ratios_are_bounded() {
        let mut ratios = Ratios::new(Batch::new(4));
        let (small, large) = (circle(0.0, 0.0, 0.1), circle(0.0, 0.0, 60.0));
        let mut ratio = [f32::NAN; 4];
        assert_eq!(ratios.ratio(small, [large, large].into_iter(), &mut ratio), 4);
        assert!(ratio.iter().all(|value| value.abs() == 2.0), "{ratio:?}");
        let nothing = Circle { sin_angle: 0.0, ..small };
        assert_eq!(ratios.ratio(nothing, [nothing].into_iter(), &mut ratio), 4);
        assert_eq!(ratio, [1.0; 4]);
        assert_eq!(ratios.ratio(large, [].into_iter(), &mut ratio), 0);
        assert_eq!(ratio, [0.0; 4]);
    }
}
