//! Pareto fronts of two measured quantities, such as time and error, of which less is better.

/// A value that was measured and the interval in which it is held to lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    value: f64,
    low: f64,
    high: f64,
}

impl Measured {
    /// A value in its interval; `None` unless `low ≤ value ≤ high` and all are finite.
    pub fn new(value: f64, low: f64, high: f64) -> Option<Self> {
        let ordered = low <= value && value <= high && low.is_finite() && high.is_finite();
        ordered.then_some(Self { value, low, high })
    }

    /// A value that is known exactly; `None` unless it is finite.
    pub fn exact(value: f64) -> Option<Self> {
        Self::new(value, value, value)
    }

    /// The value.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Lower end of the interval.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// Upper end of the interval.
    pub fn high(&self) -> f64 {
        self.high
    }
}

/// Where a point stands among others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// No other is at least as good in both quantities and better in one.
    Front,
    /// Another is by the values, but none by more than the uncertainty.
    Undecided,
    /// Another is wherever in their intervals both lie.
    Dominated {
        /// Which: of several the one with the least second quantity.
        by: usize,
    },
}

/// The standing of every point among all.
pub fn standings(points: &[[Measured; 2]]) -> Vec<Standing> {
    let second = |i: &usize, j: &usize| points[*i][1].value.total_cmp(&points[*j][1].value);
    let standing = |point: &[Measured; 2]| {
        let surely = (0..points.len()).filter(|other| surely_dominates(&points[*other], point)).min_by(second);
        match surely {
            Some(by) => Standing::Dominated { by },
            None if points.iter().any(|other| dominates(other, point)) => Standing::Undecided,
            None => Standing::Front,
        }
    };
    points.iter().map(standing).collect()
}

/// By the values alone.
fn dominates(a: &[Measured; 2], b: &[Measured; 2]) -> bool {
    let pairs = || a.iter().zip(b);
    pairs().all(|(a, b)| a.value <= b.value) && pairs().any(|(a, b)| a.value < b.value)
}

/// Wherever in their intervals the values lie.
fn surely_dominates(a: &[Measured; 2], b: &[Measured; 2]) -> bool {
    let pairs = || a.iter().zip(b);
    pairs().all(|(a, b)| a.high <= b.low) && pairs().any(|(a, b)| a.high < b.low)
}

/// The geometric mean of positive values with independent errors; `None` for no values or one that is not positive.
///
/// Errors add in squares, relative to the values: the interval tells how well these values' mean is known, not how much others
/// would differ. A lower end of 0, a value known only to be small, makes the mean's lower end 0.
pub fn geometric_mean(values: &[Measured]) -> Option<Measured> {
    if values.is_empty() || values.iter().any(|v| v.value <= 0.0) {
        return None;
    }
    let count = values.len() as f64;
    let mean = (values.iter().map(|v| v.value.ln()).sum::<f64>() / count).exp();
    let spread = |ratio: &dyn Fn(&Measured) -> f64| {
        (values.iter().map(|v| ratio(v).ln().powi(2)).sum::<f64>().sqrt() / count).exp()
    };
    let low = mean / spread(&|v| v.value / v.low.max(0.0));
    let high = mean * spread(&|v| v.high / v.value);
    Measured::new(mean, low.min(mean), high.max(mean))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Values on a coarse lattice, so that ties are common, with intervals that often touch.
    fn measured() -> impl Strategy<Value = Measured> {
        (1..12u8, 0..3u8, 0..3u8).prop_map(|(value, below, above)| {
            let (value, below, above) = (f64::from(value), f64::from(below), f64::from(above));
            Measured::new(value, value - below, value + above).unwrap()
        })
    }

    fn points() -> impl Strategy<Value = Vec<[Measured; 2]>> {
        prop::collection::vec([measured(), measured()], 1..24)
    }

    /// The front by sorting and sweeping: along growing cost, what is better than all that was cheaper.
    fn swept(points: &[[Measured; 2]]) -> Vec<bool> {
        let values = |i: usize| (points[i][0].value, points[i][1].value);
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|i, j| values(*i).partial_cmp(&values(*j)).unwrap());
        let mut front = vec![false; points.len()];
        let mut last: Option<(f64, f64)> = None;
        for i in order {
            let equal = last == Some(values(i));
            if equal || last.is_none_or(|(_, best)| values(i).1 < best) {
                (front[i], last) = (true, Some(values(i)));
            }
        }
        front
    }

    /// All places where a point may be, ends and values.
    fn places(point: &[Measured; 2]) -> Vec<[f64; 2]> {
        let ends = |m: &Measured| [m.low, m.value, m.high];
        let [a, b] = point.each_ref().map(ends);
        a.iter().flat_map(|a| b.iter().map(move |b| [*a, *b])).collect()
    }

    /// What standings mean, said without intervals' algebra: over all pairs of places.
    fn check(points: &[[Measured; 2]], found: &[Standing]) -> Result<(), String> {
        let beats = |a: [f64; 2], b: [f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
        let always = |a: &[Measured; 2], b: &[Measured; 2]| {
            places(a).iter().all(|a| places(b).iter().all(|b| beats(*a, *b) || a == b))
                && places(a).iter().any(|a| places(b).iter().any(|b| beats(*a, *b)))
                && (0..2).any(|q| a[q].high < b[q].low)
        };
        for (i, front) in swept(points).into_iter().enumerate() {
            let surely = (0..points.len()).find(|j| always(&points[*j], &points[i]));
            let right = match found[i] {
                Standing::Front => front,
                Standing::Undecided => !front && surely.is_none(),
                Standing::Dominated { by } => always(&points[by], &points[i]),
            };
            if !right {
                return Err(format!("point {i} of {points:?} is said to be {:?}", found[i]));
            }
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn standings_are_those_of_brute_force(points in points()) {
            check(&points, &standings(&points)).unwrap();
        }

        #[test]
        fn there_is_a_front(points in points()) {
            prop_assert!(standings(&points).contains(&Standing::Front));
        }

        #[test]
        fn less_certainty_decides_less(points in points(), more in 0.0..3.0f64) {
            let wider = |m: &Measured| Measured::new(m.value, m.low - more, m.high + more).unwrap();
            let vaguer: Vec<_> = points.iter().map(|p| p.each_ref().map(wider)).collect();
            for (before, after) in standings(&points).iter().zip(standings(&vaguer)) {
                let kept = match after {
                    Standing::Dominated { .. } => matches!(before, Standing::Dominated { .. }),
                    Standing::Undecided => *before != Standing::Front,
                    Standing::Front => *before == Standing::Front,
                };
                prop_assert!(kept);
            }
        }

        #[test]
        fn neither_order_nor_units_matter(points in points()) {
            let kind = |s: &Standing| std::mem::discriminant(s);
            let forward: Vec<_> = standings(&points).iter().map(kind).collect();
            let scaled = |m: &Measured| Measured::new(m.value.exp(), m.low.exp(), m.high.exp()).unwrap();
            let mut other: Vec<_> = points.iter().map(|p| p.each_ref().map(scaled)).collect();
            other.reverse();
            let mut backward: Vec<_> = standings(&other).iter().map(kind).collect();
            backward.reverse();
            prop_assert_eq!(forward, backward);
        }

        #[test]
        fn a_geometric_mean_of_ratios_is_the_ratio_of_means(
            values in prop::collection::vec((0.1..10.0f64, 0.1..10.0f64), 1..9),
        ) {
            let mean = |values: Vec<f64>| {
                geometric_mean(&values.into_iter().map(|v| Measured::exact(v).unwrap()).collect::<Vec<_>>()).unwrap().value
            };
            let (a, b) = (mean(values.iter().map(|v| v.0).collect()), mean(values.iter().map(|v| v.1).collect()));
            let ratio = mean(values.iter().map(|(a, b)| a / b).collect());
            prop_assert!((ratio - a / b).abs() < 1e-12 * ratio);
        }
    }

    fn exact(points: &[(f64, f64)]) -> Vec<[Measured; 2]> {
        points.iter().map(|(a, b)| [Measured::exact(*a).unwrap(), Measured::exact(*b).unwrap()]).collect()
    }

    #[test]
    fn a_front_by_hand() {
        use Standing::{Dominated, Front};
        let points = exact(&[(1.0, 9.0), (2.0, 4.0), (3.0, 5.0), (4.0, 1.0), (4.0, 1.0), (2.0, 4.5)]);
        let dominated = Dominated { by: 1 };
        assert_eq!(standings(&points), [Front, Front, dominated, Front, Front, dominated]);
        // The same with the third known to one part in two only.
        let mut vague = points;
        vague[2][1] = Measured::new(5.0, 3.9, 6.0).unwrap();
        assert_eq!(standings(&vague)[2], Standing::Undecided);
        assert_eq!(standings(&[]), []);
    }

    #[test]
    fn the_brute_force_rejects_wrong_standings() {
        let mut points = exact(&[(1.0, 9.0), (2.0, 4.0), (3.0, 5.0), (4.0, 1.0)]);
        points[2][1] = Measured::new(5.0, 3.9, 6.0).unwrap();
        points.push(exact(&[(5.0, 6.0)])[0]);
        let right = standings(&points);
        check(&points, &right).unwrap();
        for i in 0..points.len() {
            for wrong in [Standing::Front, Standing::Undecided, Standing::Dominated { by: 0 }] {
                if wrong != right[i] {
                    let mut standings = right.clone();
                    standings[i] = wrong;
                    assert!(check(&points, &standings).is_err(), "{i} {wrong:?}");
                }
            }
        }
        // Larger taken for better.
        let flipped: Vec<_> = points.iter().map(|p| p.map(|m| Measured::exact(-m.value).unwrap())).collect();
        assert!(check(&points, &standings(&flipped)).is_err());
        // Uncertainty left out.
        let sure: Vec<_> = points.iter().map(|p| p.map(|m| Measured::exact(m.value).unwrap())).collect();
        assert!(check(&points, &standings(&sure)).is_err());
    }

    #[test]
    fn only_ordered_finite_values_are_measured() {
        for (value, low, high) in
            [(f64::NAN, 0.0, 1.0), (1.0, f64::NAN, 2.0), (1.0, 1.5, 2.0), (3.0, 1.0, 2.0), (1.0, 0.0, f64::INFINITY)]
        {
            assert_eq!(Measured::new(value, low, high), None);
        }
    }

    #[test]
    fn geometric_means_carry_relative_errors() {
        let measured = |value, low, high| Measured::new(value, low, high).unwrap();
        let one = measured(4.0, 2.0, 8.0);
        let of_one = geometric_mean(&[one]).unwrap();
        assert!((of_one.low - 2.0).abs() < 1e-12 && (of_one.high - 8.0).abs() < 1e-12);
        // Four values, each known to a factor of 4: their mean to a factor of 4^(√4/4) = 2.
        let four = geometric_mean(&[measured(3.0, 0.75, 12.0); 4]).unwrap();
        assert!((four.value - 3.0).abs() < 1e-12 && (four.low - 1.5).abs() < 1e-12 && (four.high - 6.0).abs() < 1e-12);
        let small = geometric_mean(&[one, measured(1.0, 0.0, 1.5)]).unwrap();
        assert!((small.value - 2.0).abs() < 1e-12 && small.low == 0.0);
        assert_eq!(geometric_mean(&[]), None);
        assert_eq!(geometric_mean(&[measured(0.0, 0.0, 1.0)]), None);
    }
}
