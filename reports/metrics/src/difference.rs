//! How far apart two noisy pictures are.

use crate::picture::common;
use crate::{CompareError, Picture};
use glam::Vec3;

/// The difference of two pictures whose receivers have independent errors, by what is known of these errors.
///
/// Variances are taken as known. Channels of a receiver may share their errors in any way: standard errors are those of the
/// worst case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Root mean square difference without the noise: `√(mean(d²) − mean(σ²))`, 0 where the noise is larger; radiance.
    pub rmse: f64,
    /// Standard error of `rmse`, to first order.
    pub rmse_error: f64,
    /// What the root mean square difference is below, with two standard errors.
    pub rmse_bound: f64,
    /// Mean signed difference; negative where the picture is darker than the reference; radiance.
    pub bias: f64,
    /// Standard error of `bias`.
    pub bias_error: f64,
    /// Root mean square of the standard error `σ` of one receiver's difference.
    pub noise: f64,
    /// Whether the mean square difference stands out of the noise by two of its standard errors. If not, the pictures are not
    /// told apart.
    pub resolved: bool,
    /// Receivers compared.
    pub receivers: usize,
    /// As many receivers of equal weight would know `rmse_error` and `bias_error` as well as these do, of the two the fewer
    /// (Satterthwaite 1946); 0 without noise.
    pub effective: f64,
}

/// Measures a picture against a reference; each has a variance at every receiver, zeros where there is no noise.
///
/// # Errors
/// Lengths or layouts differ, no receiver is valid in both, or a value that counts is not finite.
pub fn difference(
    x: &Picture,
    x_variance: &[Vec3],
    reference: &Picture,
    reference_variance: &[Vec3],
) -> Result<Difference, CompareError> {
    common(x, reference, x_variance)?;
    let receivers = common(x, reference, reference_variance)?;
    let count = receivers.len() as f64;
    let (mut square, mut signed, mut noise, mut doubt, mut least_doubt) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let mut channels = [0.0; 3];
    let (mut square_doubt, mut signed_doubt) = (Weights::default(), Weights::default());
    for &i in &receivers {
        let (mut own_doubt, mut own_variance) = (0.0, 0.0);
        for c in 0..3 {
            let d = f64::from(x.radiance[i][c]) - f64::from(reference.radiance[i][c]);
            let variance = f64::from(x_variance[i][c]) + f64::from(reference_variance[i][c]);
            square += d * d / 3.0;
            signed += d / 3.0;
            noise += variance / 3.0;
            channels[c] += variance;
            // The variance of d² for a normal d of mean δ is 4δ²σ² + 2σ⁴, and the mean of d² is δ² + σ².
            doubt += (4.0 * d * d * variance - 2.0 * variance * variance) / 3.0;
            least_doubt += 2.0 * variance * variance / 3.0;
            own_doubt += 4.0 * d * d * variance;
            own_variance += variance;
        }
        square_doubt.add(own_doubt);
        signed_doubt.add(own_variance);
    }
    let apart = (square - noise) / count;
    let apart_error = f64::max(doubt, least_doubt).sqrt() / count;
    let rmse = apart.max(0.0).sqrt();
    let rmse_bound = (apart.max(0.0) + 2.0 * apart_error).sqrt();
    Ok(Difference {
        rmse,
        rmse_error: if rmse > 0.0 { (apart_error / (2.0 * rmse)).min(rmse_bound) } else { rmse_bound },
        rmse_bound,
        bias: signed / count,
        bias_error: channels.iter().map(|variance| variance.sqrt()).sum::<f64>() / (3.0 * count),
        noise: (noise / count).sqrt(),
        resolved: apart_error == 0.0 || apart > 2.0 * apart_error,
        receivers: receivers.len(),
        effective: square_doubt.effective().min(signed_doubt.effective()),
    })
}

/// How evenly variance is spread.
#[derive(Default)]
struct Weights {
    sum: f64,
    squares: f64,
}

impl Weights {
    fn add(&mut self, weight: f64) {
        self.sum += weight;
        self.squares += weight * weight;
    }

    fn effective(&self) -> f64 {
        if self.squares > 0.0 { self.sum * self.sum / self.squares } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Layout;

    /// Uniform numbers (PCG's multiplier), and sums of twelve of them, which are all but normal.
    struct Random(u64);

    impl Random {
        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn normal(&mut self) -> f32 {
            ((0..12).map(|_| self.uniform()).sum::<f64>() - 6.0) as f32
        }
    }

    const COUNT: usize = 2000;

    /// Two pictures, `apart` from each other with alternating sign and `shift` on average, both with noise of this size.
    fn measured(random: &mut Random, apart: f32, shift: f32, sigma: f32) -> Difference {
        let noisy = |random: &mut Random, value: f32| Vec3::splat(value + sigma * random.normal());
        let a: Vec<Vec3> = (0..COUNT)
            .map(|i| if i % 2 == 0 { 1.0 + apart } else { 1.0 - apart } + shift)
            .map(|v| noisy(random, v))
            .collect();
        let b: Vec<Vec3> = (0..COUNT).map(|_| noisy(random, 1.0)).collect();
        let (valid, variance) = (vec![true; COUNT], vec![Vec3::splat(sigma * sigma); COUNT]);
        let picture = |radiance| Picture { radiance, valid: &valid, layout: Layout::List };
        difference(&picture(&a), &variance, &picture(&b), &variance).unwrap()
    }

    #[test]
    fn noise_is_taken_out_and_standard_errors_are_honest() {
        let mut random = Random(7);
        let (mut rmse, mut bias) = (Vec::new(), Vec::new());
        for _ in 0..200 {
            let d = measured(&mut random, 0.03, 0.01, 0.05);
            assert!(d.effective > 0.1 * COUNT as f64 && d.effective <= COUNT as f64);
            assert!(d.resolved && d.receivers == COUNT && (d.noise - 0.05 * 2f64.sqrt()).abs() < 1e-6);
            rmse.push((d.rmse - 0.001f64.sqrt()) / d.rmse_error);
            bias.push((d.bias - 0.01) / d.bias_error);
        }
        for z in [rmse, bias] {
            let mean = z.iter().sum::<f64>() / 200.0;
            let spread = (z.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / 199.0).sqrt();
            // Four standard errors of the mean and the spread of 200 normal numbers.
            assert!(
                mean.abs() < 4.0 / 200f64.sqrt() && (spread - 1.0).abs() < 4.0 / 400f64.sqrt(),
                "{mean} ± {spread}"
            );
        }
    }

    #[test]
    fn equal_pictures_are_not_told_apart_but_for_one_in_forty() {
        let mut random = Random(9);
        let resolved = (0..400).filter(|_| measured(&mut random, 0.0, 0.0, 0.05).resolved).count();
        assert!((1..=24).contains(&resolved), "{resolved} of 400, expected about 9");
    }

    #[test]
    fn without_noise_everything_is_known() {
        let d = measured(&mut Random(1), 0.25, 0.5, 0.0);
        assert!((d.rmse - 0.3125f64.sqrt()).abs() < 1e-6 && (d.bias - 0.5).abs() < 1e-6, "{d:?}");
        assert_eq!((d.rmse_error, d.bias_error, d.noise, d.resolved, d.effective), (0.0, 0.0, 0.0, true, 0.0));
        assert_eq!(measured(&mut Random(1), 0.0, 0.0, 0.0).rmse, 0.0);
    }
}
