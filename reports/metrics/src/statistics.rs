//! Order statistics: medians, their intervals, outliers.

/// The median of repeats with its interval, as [`median_interval`] has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The median.
    pub median: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// How many values there were.
    pub count: usize,
}

/// The `p`-th percentile (0 to 100) of sorted values, linearly interpolated between the two nearest, as numpy's default;
/// none for no values.
pub fn percentile(sorted: &[f64], p: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let place = p.clamp(0.0, 100.0) / 100.0 * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    Some(sorted[below] + (sorted[above] - sorted[below]) * (place - below as f64))
}

/// The median; none for no values.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    percentile(&sorted, 50.0)
}

/// The median with an interval that holds the true median with a probability of 95% at least, whatever continuous distribution
/// the values come from (see [`confidence`] for fewer than six values); none for no values.
///
/// The ends are order statistics: the true median lies below the `k`-th smallest value exactly if fewer than `k` values lie
/// below it, and each does so with probability ½ (David and Nagaraja 2003, *Order Statistics*, §7.1). A bootstrap would be
/// no better: resampled medians are order statistics too, and for few values cover less than they promise.
pub fn median_interval(values: &[f64]) -> Option<Interval> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (median, count) = (percentile(&sorted, 50.0)?, sorted.len());
    let inside = outermost(count);
    Some(Interval { median, low: sorted[inside], high: sorted[count - 1 - inside], count })
}

/// The probability that [`median_interval`] of so many values holds the true median: 0.95 or a little more from six values
/// on, 0.9375 for five, 0.75 for three, 0 for one.
pub fn confidence(count: usize) -> f64 {
    if count == 0 { 0.0 } else { 1.0 - 2.0 * fewer_below(count, outermost(count)) }
}

/// How many values at each end lie outside a median's interval: as many as 95% allow.
fn outermost(count: usize) -> usize {
    (0..count.div_ceil(2)).rev().find(|&outside| fewer_below(count, outside) <= 0.025).unwrap_or(0)
}

/// Probability that at most so many of `count` values lie below the true median: binomial with probability ½.
fn fewer_below(count: usize, most: usize) -> f64 {
    // By logarithms: 2⁻ⁿ underflows for a thousand values.
    let mut term = -(count as f64) * std::f64::consts::LN_2;
    let mut sum = 0.0;
    for k in 0..=most {
        sum += term.exp();
        term += ((count - k) as f64).ln() - ((k + 1) as f64).ln();
    }
    sum
}

/// Which values are outliers by their modified score, 0.6745 |x − median| / MAD > 3.5 (Iglewicz and Hoaglin 1993); the median
/// absolute deviation counts as 1% of the median at least, so that no clock is blamed for its ticks. Fewer than five values
/// have none.
pub fn outliers(values: &[f64]) -> Vec<bool> {
    let Some(center) = median(values).filter(|_| values.len() >= 5) else { return vec![false; values.len()] };
    let deviations: Vec<f64> = values.iter().map(|value| (value - center).abs()).collect();
    let spread = median(&deviations).unwrap_or(0.0).max(0.01 * center.abs());
    deviations.iter().map(|deviation| 0.6745 * deviation > 3.5 * spread).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// PCG32 (O'Neill 2014, XSH-RR) on a fixed stream.
    struct Pcg(u64);

    impl Pcg {
        fn next(&mut self) -> u32 {
            let state = self.0;
            self.0 = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((((state >> 18) ^ state) >> 27) as u32).rotate_right((state >> 59) as u32)
        }
    }

    #[test]
    fn percentile_interpolates_like_numpy() {
        // numpy.percentile([1, 2, 4, 8], [0, 25, 50, 99, 100]).
        let values = [1.0, 2.0, 4.0, 8.0];
        for (p, expected) in [(0.0, 1.0), (25.0, 1.75), (50.0, 3.0), (99.0, 7.88), (100.0, 8.0)] {
            assert!((percentile(&values, p).unwrap() - expected).abs() < 1e-12, "{p}");
        }
        assert_eq!(percentile(&[5.0], 99.0), Some(5.0));
        assert_eq!(percentile(&[], 50.0), None);
    }

    #[test]
    fn medians_of_odd_even_and_no_values() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(&[]), None);
        assert_eq!(median_interval(&[]), None);
    }

    #[test]
    fn intervals_cover_the_true_median_as_often_as_they_say() {
        let mut random = Pcg(42);
        let mut uniform = || (f64::from(random.next()) + 0.5) / 2f64.powi(32);
        // With medians 0, ln 2 and 0: flat, skewed as times are, and without a variance.
        type Distribution = (fn(f64) -> f64, f64);
        let distributions: [Distribution; 3] = [
            (|u| u - 0.5, 0.0),
            (|u| -u.ln(), std::f64::consts::LN_2),
            (|u| (std::f64::consts::PI * (u - 0.5)).tan(), 0.0),
        ];
        let trials = 4000;
        for (count, (draw, truth)) in [3, 5, 7, 25, 100].into_iter().flat_map(|n| distributions.map(|d| (n, d))) {
            let covers = |_: &u32| {
                let values: Vec<f64> = (0..count).map(|_| draw(uniform())).collect();
                let interval = median_interval(&values).unwrap();
                assert!(interval.low <= interval.median && interval.median <= interval.high);
                (interval.low..=interval.high).contains(&truth)
            };
            let covered = (0..trials).filter(covers).count() as f64 / f64::from(trials);
            let told = confidence(count);
            let error = (told * (1.0 - told) / f64::from(trials)).sqrt();
            assert!((covered - told).abs() < 4.5 * error, "{covered} for {told} of {count} values");
            assert!(count < 6 || (0.95..0.985).contains(&told), "{told} for {count} values");
        }
    }

    #[test]
    fn confidence_is_that_of_the_tables() {
        // Coverage of (x₍ₖ₎, x₍ₙ₊₁₋ₖ₎): n = 6, k = 1: 0.96875; n = 10, k = 2: 0.978516; n = 20, k = 6: 0.958611.
        for (count, expected) in [(1, 0.0), (3, 0.75), (5, 0.9375), (6, 0.96875), (10, 0.978_516), (20, 0.958_611)] {
            assert!((confidence(count) - expected).abs() < 1e-6, "{count}: {}", confidence(count));
        }
        assert!((0.95..0.952).contains(&confidence(5000)), "{}", confidence(5000));
        assert_eq!(confidence(0), 0.0);
    }

    #[test]
    fn outliers_are_far_from_a_majority() {
        let found = |values: &[f64]| outliers(values).iter().map(|out| u8::from(*out)).collect::<Vec<_>>();
        assert_eq!(found(&[10.0, 10.1, 9.9, 10.2, 30.0]), [0, 0, 0, 0, 1]);
        assert_eq!(found(&[10.0, 10.0, 10.0, 10.0, 10.3]), [0; 5], "ticks");
        assert_eq!(found(&[1.0, 2.0, 3.0, 4.0, 5.0]), [0; 5], "an honest spread");
        assert_eq!(found(&[1.0, 1.0, 1.0, 9.0]), [0; 4], "too few");
        // Of normal values, 0.05% lie beyond 3.5 standard deviations.
        let mut random = Pcg(7);
        let mut normal = || (0..12).map(|_| f64::from(random.next()) / 2f64.powi(32)).sum::<f64>() - 6.0 + 100.0;
        let values: Vec<f64> = (0..10_000).map(|_| normal()).collect();
        assert!(outliers(&values).iter().filter(|out| **out).count() < 15);
    }

    #[test]
    fn one_value_is_its_own_interval() {
        assert_eq!(median_interval(&[7.0]), Some(Interval { median: 7.0, low: 7.0, high: 7.0, count: 1 }));
    }
}
