//! A circular blocker, which is how a sphere appears: its visibility and log visibility as zonal vectors, and tables of
//! both (Ren 2006, §6).

use std::f64::consts::PI;
use std::sync::OnceLock;

use crate::eigen::SymmetricEigen;
use crate::gamma::gamma;
use crate::log::{EIGENVALUE_CLIP, log_quotient};
use crate::order::{MAX_ORDER, SQRT_4_PI, assert_order, assert_zonal, coefficients, index};
use crate::table::Table;
use halflight_sh_kernels::Real;

/// Intervals of the search for kinks between `1 - cos θ = 0` and 1.
const KINK_STEPS: usize = 256;

/// Intervals of the visibility table in `1 - cos θ`, the variable in which the visibility is a polynomial.
const VISIBILITY_INTERVALS: usize = 256;

/// Intervals of the log table between two kinks: just before an eigenvalue is clipped, its logarithm is steep.
const LOG_INTERVALS: usize = 512;

/// The `n` zonal coefficients of the function that is 0 within the angular radius θ of z and 1 elsewhere, exact:
/// `∫_{-1}^{cos θ} P_l = (P_{l+1} - P_{l-1})(cos θ)/(2l+1)`. θ lies in [0, π].
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or `out` does not hold `n` values.
pub fn circle_visibility(order: usize, cos_angle: f64, out: &mut [f64]) {
    assert_zonal(order, out);
    let c = cos_angle.clamp(-1.0, 1.0);
    let (mut below, mut p) = (1.0, c); // P_{l-1}, P_l, from l = 1 on
    out[0] = 0.5 * SQRT_4_PI * (1.0 + c);
    for (l, value) in out.iter_mut().enumerate().skip(1) {
        let width = (2 * l + 1) as f64;
        let above = (width * c * p - l as f64 * below) / (l + 1) as f64;
        *value = (PI / width).sqrt() * (above - below);
        (below, p) = (p, above);
    }
}

/// The `n` zonal coefficients of the eigen-logarithm (Ren 2006, eqs. 30–32) of [`circle_visibility`]: what
/// [`log_eigen`](crate::log_eigen) gives, from the small blocks of one azimuthal frequency each.
///
/// # Panics
/// If the order is outside 1 to [`MAX_ORDER`] or `out` does not hold `n` values.
pub fn circle_log(order: usize, cos_angle: f64, out: &mut [f64]) {
    circle_visibility(order, cos_angle, out);
    let spectrum = Spectrum::of_zonal(order, out);
    out[0] -= SQRT_4_PI;
    spectrum.zonal.apply(out, |value| log_quotient(value.max(spectrum.floor)));
}

/// The eigenvalues of a zonal vector's product matrix that its logarithm depends on. The matrix does not mix azimuthal
/// frequencies: the zonal block acts on zonal vectors, the others matter through the largest eigenvalue alone.
struct Spectrum {
    zonal: SymmetricEigen,
    /// Eigenvalues are raised to this.
    floor: f64,
    /// The frequency whose block has the largest eigenvalue.
    dominant: usize,
}

impl Spectrum {
    fn of_zonal(order: usize, zonal: &[f64]) -> Self {
        let size = coefficients(order);
        let mut vector = vec![0.0; size];
        zonal.iter().enumerate().for_each(|(l, &value)| vector[index(l, 0)] = value);
        let mut matrix = vec![0.0; size * size];
        gamma(order).product_matrix(&vector, &mut matrix);

        let block = |m: usize| {
            let rows: Vec<usize> = (m..order).map(|l| index(l, m as isize)).collect();
            let entries = rows.iter().flat_map(|row| rows.iter().map(move |column| row * size + column));
            let block: Vec<f64> = entries.map(|entry| matrix[entry]).collect();
            let mut eigen = SymmetricEigen::new();
            eigen.decompose(rows.len(), &block);
            eigen
        };
        let zonal = block(0);
        let others = (1..order).map(|m| (m, block(m).largest()));
        let (dominant, largest) =
            others.fold((0, zonal.largest()), |best, next| if next.1 > best.1 { next } else { best });
        Self { zonal, floor: EIGENVALUE_CLIP * largest, dominant }
    }

    /// How the clip acts: how many zonal eigenvalues it raises, and, if any, which block sets its height. The logarithm
    /// is a smooth function of the angle while this stays the same.
    fn clip_state(&self) -> (usize, usize) {
        let clipped = self.zonal.values().iter().filter(|&&value| value < self.floor).count();
        (clipped, if clipped == 0 { 0 } else { self.dominant })
    }
}

/// Where between θ = 0 and 90° the logarithm has kinks, as ascending `1 - cos θ`: the clip reaches an eigenvalue there.
pub(crate) fn log_kinks(order: usize) -> &'static [f64] {
    static KINKS: [OnceLock<Vec<f64>>; MAX_ORDER] = [const { OnceLock::new() }; MAX_ORDER];
    let state = |height: f64| {
        let mut zonal = vec![0.0; order];
        circle_visibility(order, 1.0 - height, &mut zonal);
        Spectrum::of_zonal(order, &zonal).clip_state()
    };
    KINKS[order - 1].get_or_init(|| {
        let height = |k: usize| k as f64 / KINK_STEPS as f64;
        let states: Vec<_> = (0..=KINK_STEPS).map(|k| state(height(k))).collect();
        let changes = (0..KINK_STEPS).filter(|&k| states[k] != states[k + 1]);
        changes
            .map(|k| {
                let (mut low, mut high) = (height(k), height(k + 1));
                for _ in 0..45 {
                    let middle = 0.5 * (low + high);
                    if state(middle) == states[k] { low = middle } else { high = middle }
                }
                low
            })
            .collect()
    })
}

/// A table of a circle's zonal vector against its angular radius from 0 to 90°.
///
/// It is tabulated in `1 - cos θ`, in which both functions are smooth (the visibility is a polynomial), and split where
/// the logarithm's clip makes kinks. Coefficients err by at most 1e-6 (visibility) and 4e-6 (log; 1e-6 but for the
/// rounding of `f32`).
#[derive(Debug)]
pub struct CircleTable {
    table: Table,
}

impl CircleTable {
    /// The table of [`circle_visibility`]; made on first use.
    ///
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`].
    pub fn visibility(order: usize) -> &'static Self {
        static TABLES: [OnceLock<CircleTable>; MAX_ORDER] = [const { OnceLock::new() }; MAX_ORDER];
        assert_order(order);
        TABLES[order - 1].get_or_init(|| Self::sample(order, &[], VISIBILITY_INTERVALS, circle_visibility))
    }

    /// The table of [`circle_log`]; made on first use.
    ///
    /// # Panics
    /// If the order is outside 1 to [`MAX_ORDER`].
    pub fn log(order: usize) -> &'static Self {
        static TABLES: [OnceLock<CircleTable>; MAX_ORDER] = [const { OnceLock::new() }; MAX_ORDER];
        assert_order(order);
        TABLES[order - 1].get_or_init(|| Self::sample(order, log_kinks(order), LOG_INTERVALS, circle_log))
    }

    fn sample(order: usize, kinks: &[f64], intervals: usize, f: fn(usize, f64, &mut [f64])) -> Self {
        let breaks = [&[0.0], kinks, &[1.0]].concat();
        Self { table: Table::sample(order, &breaks, intervals, |height, out| f(order, 1.0 - height, out)) }
    }

    /// Writes the `n` zonal coefficients, ready for [`rotate_zonal`](crate::rotate_zonal), of a circle given by the sine of
    /// its angular radius: for a sphere, radius over distance. The sine is clamped to [0, 1], NaN to 0.
    ///
    /// # Panics
    /// If `out` does not hold `n` values.
    pub fn lookup<T: Real>(&self, sin_angle: T, out: &mut [T]) {
        let sin = sin_angle.max(T::ZERO).min(T::ONE);
        let cos = ((T::ONE - sin) * (T::ONE + sin)).sqrt();
        self.table.lookup(sin * sin / (T::ONE + cos), out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first circles with a clipped eigenvalue, in steps of a quarter of a degree.
    #[test]
    fn first_kinks_are_where_the_clip_begins() {
        assert!(log_kinks(1).is_empty() && log_kinks(2).is_empty());
        for (order, first_clipped) in [(3, 64.75), (4, 49.0), (5, 39.25), (6, 32.75)] {
            let found = (1.0 - log_kinks(order)[0]).acos().to_degrees();
            assert!(found < first_clipped && found > first_clipped - 0.25, "order {order}: {found}°");
        }
    }
}
