//! Fractal heights from gradient noise (Perlin 2002), of additions and products alone, which every platform rounds alike.

use glam::DVec2;

use crate::random::SplitMix;

/// A sum of noises, each of half the wavelength and `gain` times the amplitude of the one before.
pub(super) struct Fractal {
    pub(super) seed: u64,
    /// Metres.
    pub(super) amplitude: f64,
    /// Metres.
    pub(super) wavelength: f64,
    pub(super) octaves: usize,
    pub(super) gain: f64,
}

/// Moves each noise against the one before, in wavelengths: noise is zero at its lattice's points, and those would coincide.
const SHIFT: DVec2 = DVec2::new(0.34, 0.78);

impl Fractal {
    /// Height in metres at a position in metres.
    pub(super) fn height(&self, at: DVec2) -> f64 {
        let (mut amplitude, mut wavelength, mut sum) = (self.amplitude, self.wavelength, 0.0);
        for octave in 0..self.octaves {
            sum += amplitude * noise(SplitMix(self.seed.wrapping_add(octave as u64)).bits(), at / wavelength + SHIFT);
            amplitude *= self.gain;
            wavelength *= 0.5;
        }
        sum
    }
}

/// Smooth noise within [−1, 1], zero at points of whole coordinates.
fn noise(seed: u64, at: DVec2) -> f64 {
    let low = at.floor();
    let inside = at - low;
    let slope = |corner: DVec2| gradient(seed, low + corner).dot(inside - corner);
    let weight = inside * inside * inside * (inside * (6.0 * inside - 15.0) + 10.0);
    let mix = |from: f64, to: f64, weight: f64| from + weight * (to - from);
    let near = mix(slope(DVec2::ZERO), slope(DVec2::X), weight.x);
    let far = mix(slope(DVec2::Y), slope(DVec2::ONE), weight.x);
    mix(near, far, weight.y)
}

/// Uniform within the square `[−1, 1)²`.
fn gradient(seed: u64, point: DVec2) -> DVec2 {
    let row = SplitMix(seed ^ point.y as i64 as u64).bits();
    let mut random = SplitMix(row ^ point.x as i64 as u64);
    let mut signed = || f64::from(2.0 * random.unit() - 1.0);
    DVec2::new(signed(), signed())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_bounded_continuous_and_zero_at_whole_points() {
        let mut greatest = 0f64;
        for i in 0..4000 {
            let at = DVec2::new(0.017, -0.013) * f64::from(i);
            let value = noise(5, at);
            greatest = greatest.max(value.abs());
            for step in [DVec2::X, DVec2::Y] {
                assert!((noise(5, at + 1e-7 * step) - value).abs() < 1e-6, "{at}");
            }
        }
        assert!((0.4..=1.0).contains(&greatest), "{greatest}");
        assert_eq!(noise(5, DVec2::new(-3.0, 7.0)), 0.0);
        assert_ne!(noise(5, DVec2::splat(0.5)), noise(6, DVec2::splat(0.5)));
    }

    #[test]
    fn the_same_bits_everywhere() {
        let fractal = Fractal { seed: 1, amplitude: 10.0, wavelength: 16.0, octaves: 5, gain: 0.5 };
        let heights = [DVec2::ZERO, DVec2::new(3.0, -7.5), DVec2::new(-120.25, 64.0)].map(|at| fractal.height(at));
        // By a second program in another language.
        let expected = [13_832_953_164_437_687_197, 4_610_399_344_356_177_876, 13_816_250_948_912_591_520];
        assert_eq!(heights.map(f64::to_bits), expected);
    }
}
