//! Power laws by least squares.

use halflight_metrics::Interval;
use halflight_references::statistics::{chi_squared_survival, student_survival};
use halflight_reports::Fit;

/// The least standard error of a time, relative: what few samples that happen to agree do not show.
const LEAST_ERROR: f64 = 0.005;

/// Half the width of a 95% interval in standard errors.
const WIDTH: f64 = 1.959_964;

/// Fits `y = c·xᵇ` to times at three different `x > 0` or more, in logarithms, each weighted by what its interval leaves open;
/// none for fewer, or for times that are not above zero.
///
/// The interval of the exponent is Student's, with the scatter about the line (Draper and Smith 1998, §1.4 and §9.2): of
/// the weights only their ratios count there, so it holds where the law does not describe all that there is, too. The lack of
/// fit is chi²'s probability of as much scatter, given the intervals alone.
pub(crate) fn power_law(points: &[(f64, Interval)]) -> Option<Fit> {
    let usable = |(x, time): &(f64, Interval)| *x > 0.0 && time.low > 0.0 && x.is_finite() && time.high.is_finite();
    if !points.iter().all(usable) {
        return None;
    }
    let points: Vec<Point> = points.iter().map(Point::new).collect();
    let degrees = points.len().checked_sub(2).filter(|degrees| *degrees > 0)? as f64;
    let mean = |value: fn(&Point) -> f64| {
        points.iter().map(|p| p.weight * value(p)).sum::<f64>() / points.iter().map(|p| p.weight).sum::<f64>()
    };
    let (x, y) = (mean(|p| p.x), mean(|p| p.y));
    let sum = |value: &dyn Fn(&Point) -> f64| points.iter().map(|p| p.weight * value(p)).sum::<f64>();
    let spread = sum(&|p| (p.x - x).powi(2));
    if spread <= 0.0 {
        return None;
    }
    let exponent = sum(&|p| (p.x - x) * (p.y - y)) / spread;
    let scatter = sum(&|p| (p.y - y - exponent * (p.x - x)).powi(2));
    let total = sum(&|p| (p.y - y).powi(2));
    let half = student_quantile(0.025, degrees) * (scatter / degrees / spread).sqrt();
    Some(Fit {
        exponent,
        low: exponent - half,
        high: exponent + half,
        factor: (y - exponent * x).exp(),
        r_squared: if total > 0.0 { 1.0 - scatter / total } else { 1.0 },
        lack_of_fit: chi_squared_survival(scatter, degrees),
    })
}

/// A time in logarithms.
struct Point {
    x: f64,
    y: f64,
    weight: f64,
}

impl Point {
    fn new((x, time): &(f64, Interval)) -> Self {
        let error = ((time.high / time.low).ln() / (2.0 * WIDTH)).max(LEAST_ERROR);
        Self { x: x.ln(), y: time.median.ln(), weight: error.powi(-2) }
    }
}

/// What Student's t exceeds with this probability, below one half.
fn student_quantile(probability: f64, degrees: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while student_survival(high, degrees) > probability {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if student_survival(middle, degrees) > probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal numbers (Knuth's MMIX generator, twelve uniform ones each).
    struct Random(u64);

    impl Random {
        fn normal(&mut self) -> f64 {
            let uniform = |state: &mut u64| {
                *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (*state >> 11) as f64 / (1u64 << 53) as f64
            };
            (0..12).map(|_| uniform(&mut self.0)).sum::<f64>() - 6.0
        }
    }

    fn time(median: f64, error: f64) -> Interval {
        Interval { median, low: median * (-WIDTH * error).exp(), high: median * (WIDTH * error).exp(), count: 6 }
    }

    /// Times by a law, with normal errors in the logarithm, at `x` = 1, 2, 4, …
    fn points(random: &mut Random, errors: &[f64], law: impl Fn(f64) -> f64) -> Vec<(f64, Interval)> {
        let at = |(i, error): (usize, &f64)| {
            let x = 2f64.powi(i as i32);
            (x, time(law(x) * (error * random.normal()).exp(), *error))
        };
        errors.iter().enumerate().map(at).collect()
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, expected) in [(1.0, 12.7062), (3.0, 3.182_45), (10.0, 2.228_14), (1e6, 1.959_97)] {
            let found = student_quantile(0.025, degrees);
            assert!((found - expected).abs() < 1e-4 * expected, "{degrees}: {found}");
        }
    }

    #[test]
    fn an_exact_law_is_found_exactly() {
        let exact: Vec<_> = [1.0, 2.0, 3.0, 7.0].map(|x: f64| (x, time(5.0 * x.powf(1.75), 0.01))).to_vec();
        let fit = power_law(&exact).unwrap();
        assert!((fit.exponent - 1.75).abs() < 1e-12 && (fit.factor - 5.0).abs() < 1e-12, "{fit:?}");
        assert!(fit.high - fit.low < 1e-6 && fit.r_squared > 1.0 - 1e-12 && fit.lack_of_fit > 0.999, "{fit:?}");
    }

    #[test]
    fn intervals_hold_the_exponent_as_often_as_they_say() {
        let (mut random, trials) = (Random(3), 4000);
        for errors in [&[0.02; 4][..], &[0.01, 0.1, 0.03, 0.05, 0.02, 0.2, 0.01]] {
            let (mut held, mut lacking) = (0, 0);
            for _ in 0..trials {
                let fit = power_law(&points(&mut random, errors, |x| 3.0 * x.powf(1.5))).unwrap();
                held += u32::from((fit.low..=fit.high).contains(&1.5));
                lacking += u32::from(fit.lack_of_fit < 0.05);
            }
            let share = |count: u32| f64::from(count) / f64::from(trials);
            // Standard error 0.0034.
            assert!((share(held) - 0.95).abs() < 0.014, "{}", share(held));
            assert!((share(lacking) - 0.05).abs() < 0.014, "{}", share(lacking));
        }
    }

    #[test]
    fn another_exponent_and_another_law_are_told() {
        let mut random = Random(9);
        let fit = power_law(&points(&mut random, &[0.02; 7], |x| x * x)).unwrap();
        assert!(!(fit.low..=fit.high).contains(&1.9) && fit.lack_of_fit > 0.01, "{fit:?}");
        // A constant cost beside the one that grows.
        let fit = power_law(&points(&mut random, &[0.02; 7], |x| 10.0 + x * x)).unwrap();
        assert!(fit.lack_of_fit < 1e-6, "{fit:?}");
        assert!(fit.high - fit.low > 0.5, "the interval knows of the misfit: {fit:?}");
        // Weights: a point that is known badly moves little.
        let mut bad = points(&mut random, &[0.01; 5], |x| x);
        bad[4] = (16.0, time(160.0, 2.0));
        assert!((power_law(&bad).unwrap().exponent - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_has_no_fit_has_none() {
        let at = |x: f64, y: f64| (x, time(y, 0.01));
        for points in [vec![], vec![at(1.0, 1.0), at(2.0, 2.0)], vec![at(2.0, 1.0); 4], vec![at(0.0, 1.0); 4]] {
            assert!(power_law(&points).is_none());
        }
        let zero = (3.0, Interval { median: 0.0, low: 0.0, high: 0.0, count: 6 });
        assert!(power_law(&[at(1.0, 1.0), at(2.0, 2.0), zero]).is_none());
    }
}
