//! Student's t and chi² by the incomplete beta and gamma functions.

/// Probability that Student's t with `degrees > 0` of freedom exceeds `t`.
pub fn student_survival(t: f64, degrees: f64) -> f64 {
    let tail = 0.5 * incomplete_beta(degrees / (degrees + t * t), 0.5 * degrees, 0.5);
    if t < 0.0 { 1.0 - tail } else { tail }
}

/// Probability that chi² with `degrees > 0` of freedom exceeds `x`.
pub fn chi_squared_survival(x: f64, degrees: f64) -> f64 {
    let (a, x) = (0.5 * degrees, 0.5 * x);
    if x <= 0.0 {
        return 1.0;
    }
    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > 1e-17 * sum {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        1.0 - scale * sum
    } else {
        let fraction = continued_fraction(|k| {
            let k = k as f64;
            (-k * (k - a), x + 2.0 * k + 1.0 - a)
        });
        scale / (x + 1.0 - a + fraction)
    }
}

/// The regularised incomplete beta function `I_x(a, b)`.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let scale = (a * x.ln() + b * (-x).ln_1p() + ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b)).exp() / a;
    let fraction = continued_fraction(|k| {
        let m = (k / 2) as f64;
        let coefficient = if k % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        (coefficient, 1.0)
    });
    scale / (1.0 + fraction)
}

/// `a₁/(b₁ + a₂/(b₂ + …))` with `(a_k, b_k) = terms(k)`, by the modified Lentz method.
fn continued_fraction(terms: impl Fn(usize) -> (f64, f64)) -> f64 {
    const TINY: f64 = 1e-300;
    let (mut value, mut c, mut d) = (TINY, TINY, 0.0);
    for k in 1..10_000 {
        let (a, b) = terms(k);
        d = away_from_zero(b + a * d, TINY).recip();
        c = away_from_zero(b + a / c, TINY);
        value *= c * d;
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    value
}

fn away_from_zero(value: f64, tiny: f64) -> f64 {
    if value.abs() < tiny { tiny } else { value }
}

/// `ln Γ(x)` for `x > 0`: Stirling's series after shifting the argument up.
fn ln_gamma(x: f64) -> f64 {
    let (mut z, mut shift) = (x, 1.0);
    while z < 15.0 {
        shift *= z;
        z += 1.0;
    }
    let inverse = 1.0 / (z * z);
    let series = (1.0 / 12.0 - inverse * (1.0 / 360.0 - inverse * (1.0 / 1260.0 - inverse * (1.0 / 1680.0)))) / z;
    (z - 0.5) * z.ln() - z + 0.5 * std::f64::consts::TAU.ln() + series - f64::ln(shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_agrees_with_scipy() {
        for (degrees, t, expected) in [
            (7.0, 0.5, 0.3162035678446422),
            (7.0, 3.0, 0.009971063065996268),
            (7.0, -12.0, 0.9999968208448109),
            (15.0, 2.5, 0.012252901623256913),
            (31.0, 6.0, 6.135480976433499e-07),
            (1.0, 10.0, 0.03172551743055357),
            (1000.0, 4.0, 3.400495960439082e-05),
        ] {
            let p = student_survival(t, degrees);
            assert!((p / expected - 1.0).abs() < 1e-11, "t {t} with {degrees}: {p}");
        }
    }

    #[test]
    fn chi_squared_agrees_with_scipy() {
        for (x, degrees, expected) in [
            (1.0, 1.0, 0.31731050786291115),
            (3.84, 1.0, 0.05004352124870519),
            (250.0, 255.0, 0.5766352636499277),
            (400.0, 255.0, 1.6600025244123397e-08),
            (10.0, 5.0, 0.07523524614651217),
            (100.0, 50.0, 3.454931382984871e-05),
            (0.0, 3.0, 1.0),
        ] {
            let p = chi_squared_survival(x, degrees);
            assert!((p / expected - 1.0).abs() < 1e-11, "chi² {x} with {degrees}: {p}");
        }
    }
}
