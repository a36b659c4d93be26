//! Order statistics and the bootstrap.

/// The median of repeats with a 95% interval.
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

/// The median with its 95% percentile-bootstrap interval (2 000 resamples, fixed seed: equal values give equal
/// intervals); none for no values. With a single value the interval is that value and says nothing.
pub fn median_interval(values: &[f64]) -> Option<Interval> {
    const RESAMPLES: usize = 2000;
    let center = median(values)?;
    let count = values.len();
    let mut random = Pcg(0x853c_49e6_748f_ea9b);
    let mut resample = vec![0.0; count];
    let mut medians: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            resample.fill_with(|| values[random.below(count)]);
            resample.sort_by(f64::total_cmp);
            percentile(&resample, 50.0)
        })
        .collect();
    medians.sort_by(f64::total_cmp);
    Some(Interval { median: center, low: percentile(&medians, 2.5)?, high: percentile(&medians, 97.5)?, count })
}

/// PCG32 (O'Neill 2014, XSH-RR) on a fixed stream.
struct Pcg(u64);

impl Pcg {
    fn next(&mut self) -> u32 {
        let state = self.0;
        self.0 = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((((state >> 18) ^ state) >> 27) as u32).rotate_right((state >> 59) as u32)
    }

    fn below(&mut self, bound: usize) -> usize {
        ((u64::from(self.next()) * bound as u64) >> 32) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn interval_covers_the_true_median_in_about_95_of_100_trials() {
        let mut random = Pcg(42);
        let trials = 1000;
        let covered = (0..trials)
            .filter(|_| {
                // Exponential with median ln 2: skewed, as times are.
                let values: Vec<f64> =
                    (0..25).map(|_| -((f64::from(random.next()) + 0.5) / 2f64.powi(32)).ln()).collect();
                let interval = median_interval(&values).unwrap();
                assert!(interval.low <= interval.median && interval.median <= interval.high);
                (interval.low..=interval.high).contains(&std::f64::consts::LN_2)
            })
            .count();
        // The percentile bootstrap of a median over 25 values covers 93 to 97%.
        assert!((915..=985).contains(&covered), "{covered} of {trials}");
    }

    #[test]
    fn one_value_is_its_own_interval() {
        assert_eq!(median_interval(&[7.0]), Some(Interval { median: 7.0, low: 7.0, high: 7.0, count: 1 }));
    }
}
