//! Whether scores are standard normal.

use super::normal_survival;

/// Probability that independent standard normal scores fit worse than these: the Anderson–Darling test with mean and variance
/// given. 0 for no scores, and for any that is NaN or infinite.
///
/// The limiting distribution of A² by Marsaglia and Marsaglia 2004, Evaluating the Anderson–Darling Distribution: probabilities
/// of `n` scores are right within `0.05/n`, and below 1e-4 only in their order.
pub fn normality_p(scores: &[f64]) -> f64 {
    let statistic = anderson_darling(scores);
    if statistic.is_finite() { limiting_survival(statistic) } else { 0.0 }
}

/// `A² = −n − 1/n·Σ (2i − 1)(ln Φ(zᵢ) + ln(1 − Φ(zₙ₊₁₋ᵢ)))` of the sorted scores.
fn anderson_darling(scores: &[f64]) -> f64 {
    let mut sorted = scores.to_vec();
    sorted.sort_by(f64::total_cmp);
    let pairs = sorted.iter().zip(sorted.iter().rev()).enumerate();
    let sum: f64 = pairs
        .map(|(i, (low, high))| (2 * i + 1) as f64 * (normal_survival(-low).ln() + normal_survival(*high).ln()))
        .sum();
    let count = scores.len() as f64;
    -count - sum / count
}

fn limiting_survival(z: f64) -> f64 {
    // Horner's rule, highest power first.
    let polynomial = |coefficients: [f64; 6]| coefficients.into_iter().fold(0.0, |sum, c| sum * z + c);
    if z <= 0.0 {
        1.0
    } else if z < 2.0 {
        let series = polynomial([0.001_686_91, -0.011_672, 0.034_796_2, -0.064_982_1, 0.247_105, 2.000_12]);
        1.0 - (-1.233_714_1 / z).exp() / z.sqrt() * series
    } else {
        let exponent = polynomial([-0.000_314_6, 0.008_056, -0.082_433, 0.434_24, -2.306_95, 1.077_6]);
        -(-exponent.exp()).exp_m1()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::{normals, uniforms};

    #[test]
    fn survival_agrees_with_the_limits_characteristic_function() {
        // Σ χ²/(j(j + 1)) by Imhof's integral with SciPy; Marsaglia and Marsaglia give 3.8781 for 1%.
        for (statistic, p) in [
            (0.3, 0.938_157_6),
            (0.8, 0.481_028_0),
            (1.5, 0.176_475_4),
            (1.933, 0.099_994_6),
            (2.492, 0.050_022_2),
            (3.8781, 0.010_000_3),
            (6.0, 9.674_5e-4),
        ] {
            let found = limiting_survival(statistic);
            assert!((found - p).abs() < 5e-6 + 0.001 * p, "{statistic}: {found} for {p}");
        }
        assert!((limiting_survival(9.0) / 3.95e-5 - 1.0).abs() < 0.2);
        let steps: Vec<f64> = (0..400).map(|i| limiting_survival(f64::from(i) * 0.05)).collect();
        assert!(steps.windows(2).all(|pair| pair[1] <= pair[0] + 2e-6) && steps[0] == 1.0 && steps[399] < 1e-9);
    }

    #[test]
    fn p_of_normal_scores_is_uniform() {
        let mut tenths = [0u32; 10];
        for seed in 0..1000 {
            let p = normality_p(&normals(seed).take(100).collect::<Vec<_>>());
            tenths[((p * 10.0) as usize).min(9)] += 1;
        }
        let chi: f64 = tenths.iter().map(|count| (f64::from(*count) - 100.0).powi(2) / 100.0).sum();
        assert!(crate::statistics::chi_squared_survival(chi, 9.0) > 1e-3, "{tenths:?}");
    }

    #[test]
    fn what_is_not_standard_normal_is_found_out() {
        type Plant = fn(f64, f64) -> f64;
        let planted: [(&str, Plant); 6] = [
            ("shifted", |z, _| z + 0.2),
            ("errors claimed a sixth too small", |z, _| z * 1.17),
            ("errors claimed a sixth too large", |z, _| z / 1.17),
            ("skewed", |_, u| -(1.0 - u).ln() - 1.0),
            ("uniform", |_, u| (u - 0.5) * 12f64.sqrt()),
            ("one in twenty ten times as large", |z, u| if u < 0.05 { 10.0 * z } else { z }),
        ];
        for (name, plant) in planted {
            let scores: Vec<f64> = normals(1).zip(uniforms(2)).take(1500).map(|(z, u)| plant(z, u)).collect();
            assert!(normality_p(&scores) < 1e-3, "{name}: {}", normality_p(&scores));
        }
        assert_eq!(normality_p(&[]), 0.0);
        for wrong in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e9] {
            assert_eq!(normality_p(&[0.1, wrong, -0.3]), 0.0, "{wrong}");
        }
    }
}
