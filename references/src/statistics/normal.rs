//! The standard normal distribution, to nearly full relative precision far into the tail.

use std::f64::consts::TAU;

/// Probability of a value above `x`.
pub fn normal_survival(x: f64) -> f64 {
    if x < 0.0 { 1.0 - normal_survival(-x) } else { (-0.5 * x * x).exp() / TAU.sqrt() * mills(x) }
}

/// The value that is exceeded with `probability` in `(0, 1)`; infinite at 0 and 1.
pub fn normal_quantile_above(probability: f64) -> f64 {
    if probability > 0.5 {
        return -normal_quantile_above(1.0 - probability);
    }
    if probability <= 0.0 {
        return f64::INFINITY;
    }
    // Newton on the logarithm, which is concave: every step after the first stays on one side.
    let target = probability.ln();
    let mut x = (-2.0 * target).sqrt();
    for _ in 0..40 {
        let step = ((mills(x) / TAU.sqrt()).ln() - 0.5 * x * x - target) * mills(x);
        x += step;
        if step.abs() <= 1e-15 * x.abs() {
            break;
        }
    }
    x.max(0.0)
}

/// Mills' ratio: survival over density, for `x ≥ 0`.
fn mills(x: f64) -> f64 {
    if x < 2.5 {
        // Marsaglia 2004: Φ(x) − 1/2 = φ(x)·(x + x³/3 + x⁵/(3·5) + …).
        let (mut term, mut sum, mut odd) = (x, x, 1.0);
        while term > 1e-18 * sum {
            odd += 2.0;
            term *= x * x / odd;
            sum += term;
        }
        0.5 * TAU.sqrt() * (0.5 * x * x).exp() - sum
    } else {
        // Laplace's continued fraction, from within.
        (1..=120).rev().fold(x, |inner, k| x + f64::from(k) / inner).recip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survival_agrees_with_scipy() {
        for (x, expected) in [
            (0.0, 0.5),
            (0.5, 0.3085375387259869),
            (1.0, 0.15865525393145707),
            (2.0, 0.022750131948179195),
            (4.5, 3.3976731247300535e-06),
            (6.0, 9.865876450376946e-10),
            (10.0, 7.61985302416047e-24),
            (30.0, 4.906713927147908e-198),
            (-1.5, 0.9331927987311419),
        ] {
            assert!((normal_survival(x) / expected - 1.0).abs() < 1e-12, "{x}: {}", normal_survival(x));
        }
    }

    #[test]
    fn quantiles_agree_with_scipy() {
        for (p, expected) in [
            (0.5, 0.0),
            (0.1, 1.2815515655446004),
            (0.975, -1.959963984540054),
            (1e-3, 3.090232306167813),
            (2.5e-6, 4.564787730280885),
            (1e-12, 7.034483825301131),
            (1e-100, 21.273453560965322),
            (1e-300, 37.0470962993612),
        ] {
            let x = normal_quantile_above(p);
            assert!((x - expected).abs() < 1e-11 * expected.abs().max(1.0), "{p}: {x}");
        }
        assert_eq!(normal_quantile_above(0.0), f64::INFINITY);
        assert_eq!(normal_quantile_above(1.0), f64::NEG_INFINITY);
    }
}
