//! SSIM and FLIP of displayed pictures.

use crate::Exposure;
use glam::Vec3;

/// The window: a Gaussian of σ = 1.5 cut at 11 × 11 (Wang et al. 2004, section III.B).
const SIGMA: f64 = 1.5;
const RADIUS: usize = 5;
/// `(0.01 L)²` and `(0.03 L)²` for the range L = 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// An image of two pictures and the pixels that count in both.
pub(crate) struct Pair<'a> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) x: &'a [Vec3],
    pub(crate) reference: &'a [Vec3],
    pub(crate) counts: &'a [bool],
    pub(crate) exposure: Exposure,
}

impl Pair<'_> {
    /// Mean structural similarity (Wang et al. 2004, eq. 13) of the displayed luma, population covariances.
    ///
    /// As in scikit-image (`gaussian_weights`, `use_sample_covariance=False`, `data_range=1`) the mean is over the pixels
    /// whose whole window lies inside the image. Pixels that do not count have no weight in any window: a background
    /// that both pictures share raises nothing. None where no window fits.
    pub(crate) fn ssim(&self) -> Option<f64> {
        if self.width <= 2 * RADIUS || self.height <= 2 * RADIUS {
            return None;
        }
        let luma = |picture: &[Vec3]| -> Vec<f64> {
            let masked = picture.iter().zip(self.counts);
            masked.map(|(r, c)| if *c { f64::from(self.exposure.luma(*r)) } else { 0.0 }).collect()
        };
        let (x, y) = (luma(self.x), luma(self.reference));
        let product = |a: &[f64], b: &[f64]| self.blur(a.iter().zip(b).map(|(a, b)| a * b).collect());
        let weight = self.blur(self.counts.iter().map(|c| f64::from(u8::from(*c))).collect());
        let (xx, yy, xy) = (product(&x, &x), product(&y, &y), product(&x, &y));
        let (x, y) = (self.blur(x), self.blur(y));

        let (mut sum, mut count) = (0.0, 0usize);
        for i in self.inner().filter(|i| self.counts[*i]) {
            let of = |moment: &[f64]| moment[i] / weight[i];
            let (mx, my) = (of(&x), of(&y));
            let (vx, vy, cov) = (of(&xx) - mx * mx, of(&yy) - my * my, of(&xy) - mx * my);
            sum += (2.0 * mx * my + C1) * (2.0 * cov + C2) / ((mx * mx + my * my + C1) * (vx + vy + C2));
            count += 1;
        }
        (count > 0).then(|| sum / count as f64)
    }

    /// Mean FLIP (Andersson et al. 2020; LDR, 67 pixels a degree) over the pixels that count, 0 to 1. The others are
    /// black in both pictures. None where the image is too large for the library's 32-bit sizes.
    pub(crate) fn flip(&self) -> Option<f64> {
        let (width, height) = (u32::try_from(self.width).ok()?, u32::try_from(self.height).ok()?);
        width.checked_mul(height)?.checked_mul(3)?;
        let image = |picture: &[Vec3]| {
            let masked = picture.iter().zip(self.counts);
            let bytes: Vec<u8> =
                masked.flat_map(|(r, c)| if *c { self.exposure.display8(*r) } else { [0; 3] }).collect();
            nv_flip::FlipImageRgb8::with_data(width, height, &bytes)
        };
        let map = nv_flip::flip(image(self.reference), image(self.x), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
        let (mut sum, mut count) = (0.0, 0usize);
        for (error, _) in map.iter().zip(self.counts).filter(|(_, c)| **c) {
            sum += f64::from(*error);
            count += 1;
        }
        (count > 0).then(|| sum / count as f64)
    }

    /// Indices of the pixels whose whole window lies inside the image.
    fn inner(&self) -> impl Iterator<Item = usize> {
        let (width, height) = (self.width, self.height);
        (RADIUS..height - RADIUS).flat_map(move |row| (RADIUS..width - RADIUS).map(move |column| row * width + column))
    }

    /// The window's weighted sum around every pixel, 0 beyond the border.
    fn blur(&self, field: Vec<f64>) -> Vec<f64> {
        let across = convolve(&field, self.width, 1, field.len());
        convolve(&across, self.height, self.width, field.len())
    }
}

/// One pass of the separable window along an axis of `length` pixels that lie `stride` apart.
fn convolve(field: &[f64], length: usize, stride: usize, total: usize) -> Vec<f64> {
    let kernel = kernel();
    let mut out = vec![0.0; total];
    for (i, out) in out.iter_mut().enumerate() {
        let place = i / stride % length;
        let (first, last) = (place.saturating_sub(RADIUS), (place + RADIUS).min(length - 1));
        let start = i - place * stride;
        *out = (first..=last).map(|k| kernel[k + RADIUS - place] * field[start + k * stride]).sum();
    }
    out
}

fn kernel() -> [f64; 2 * RADIUS + 1] {
    let raw: [f64; 2 * RADIUS + 1] = std::array::from_fn(|i| {
        let d = i as f64 - RADIUS as f64;
        (-d * d / (2.0 * SIGMA * SIGMA)).exp()
    });
    let sum: f64 = raw.iter().sum();
    raw.map(|k| k / sum)
}
