//! From radiance to display colours, for the measures that judge what is seen.

use crate::percentile;
use glam::Vec3;

/// A linear exposure followed by the sRGB transfer curve (IEC 61966-2-1), clipped to 0..1.
///
/// One exposure serves a reference and every picture that is held against it, so that a picture that is too dark looks
/// too dark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Radiance is multiplied by this before clipping.
    pub scale: f32,
}

impl Exposure {
    /// The exposure that a reference asks for: the 99th percentile of its valid receivers' largest channel comes to 1.
    /// 1 for a reference that is black.
    pub fn of_reference(radiance: &[Vec3], valid: &[bool]) -> Self {
        let lit = radiance.iter().zip(valid).filter(|(r, valid)| **valid && r.is_finite());
        let mut peaks: Vec<f64> = lit.map(|(r, _)| f64::from(r.max_element())).collect();
        peaks.sort_by(f64::total_cmp);
        let white = percentile(&peaks, 99.0).unwrap_or(0.0);
        // Below this the reciprocal would leave the range of f32.
        Self { scale: if white > 1e-30 { (1.0 / white) as f32 } else { 1.0 } }
    }

    /// Display colour of a radiance, each channel in 0..=1. NaN gives 0.
    pub fn display(self, radiance: Vec3) -> Vec3 {
        Vec3::from(radiance.to_array().map(|c| srgb((c * self.scale).clamp(0.0, 1.0))))
    }

    /// The same in 8 bits.
    pub fn display8(self, radiance: Vec3) -> [u8; 3] {
        // A cast of NaN gives 0.
        self.display(radiance).to_array().map(|c| (c * 255.0 + 0.5) as u8)
    }

    /// Luma of the display colour (Rec. 709 weights on the encoded channels), in 0..=1.
    pub fn luma(self, radiance: Vec3) -> f32 {
        self.display(radiance).dot(Vec3::new(0.2126, 0.7152, 0.0722))
    }
}

fn srgb(linear: f32) -> f32 {
    if linear.is_nan() {
        0.0
    } else if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_at_known_points() {
        // IEC 61966-2-1: linear 0.214041 is encoded 0.5, 0.0030399346 is 10/255.
        let one = Exposure { scale: 1.0 };
        assert!((one.display(Vec3::splat(0.214_041)).x - 0.5).abs() < 1e-5);
        assert_eq!(one.display8(Vec3::new(0.003_039_934_6, 0.0, 7.0)), [10, 0, 255]);
        assert_eq!(one.display8(Vec3::new(f32::NAN, -1.0, f32::INFINITY)), [0, 0, 255]);
        assert!((one.luma(Vec3::ONE) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn exposure_brings_the_99th_percentile_to_white() {
        let radiance: Vec<Vec3> = (0..=100).map(|i| Vec3::new(0.0, i as f32 / 10.0, 0.5)).collect();
        let mut valid = vec![true; 101];
        assert!((Exposure::of_reference(&radiance, &valid).scale - 1.0 / 9.9).abs() < 1e-6);
        // What does not count does not expose.
        valid[51..].fill(false);
        assert!((Exposure::of_reference(&radiance, &valid).scale - 1.0 / 4.95).abs() < 1e-6);
        assert_eq!(Exposure::of_reference(&[Vec3::ZERO], &[true]).scale, 1.0);
        assert_eq!(Exposure::of_reference(&[], &[]).scale, 1.0);
    }
}
