//! Receivers under the sky: an overcast one, and a uniform one that terrain hides in part.

use std::f64::consts::PI;

/// Irradiance over `π` under the CIE overcast sky of unit zenith radiance, `L = (1 + 2 z)/3` above the horizontal plane, for a
/// normal at `angle` in `[0, π]` from the zenith: by `∫_{z>0} max(0, n·ω) = π(1 + cos γ)/2` and
/// `∫ max(0, z) max(0, n·ω) = 2/3·(sin γ + (π − γ) cos γ)`. 7/9 on the horizontal.
pub fn overcast(angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    (0.5 * PI * (1.0 + cos) + 4.0 / 3.0 * (sin + (PI - angle) * cos)) / (3.0 * PI)
}

/// Irradiance over `π` on the floor of an endless trench under a uniform sky of radiance 1, with walls that rise to elevations in
/// `[0, π/2]` on its two sides: `(cos α₁ + cos α₂)/2`, the integral of the squared cosine of [`trench_horizon`] over azimuth.
pub fn trench(walls: [f64; 2]) -> f64 {
    0.5 * (walls[0].cos() + walls[1].cos())
}

/// Elevation of the horizon in a trench along `x`, at an azimuth from `+x`: `tan ω = tan α·|sin φ|`, with the first wall towards
/// `+y`.
pub fn trench_horizon(walls: [f64; 2], azimuth: f64) -> f64 {
    let (sin, wall) = (azimuth.sin(), walls[usize::from(azimuth.sin() < 0.0)]);
    (wall.sin() * sin.abs()).atan2(wall.cos())
}

/// Irradiance over `π` on an endless slope, inclined by `slope` in `[0, π]`, under a uniform sky of radiance 1 that ends at
/// elevation 0: `(1 + cos β)/2`.
pub fn ramp(slope: f64) -> f64 {
    0.5 * (1.0 + slope.cos())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, TAU};

    use super::*;
    use crate::analytic::quadrature::gauss;

    /// `1/π ∫ L(z) max(0, n·ω) dω` over the upper hemisphere, for a normal at an angle from the zenith.
    fn on_a_slope(radiance: impl Fn(f64) -> f64, angle: f64) -> f64 {
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n {
            let (rim, z) = (FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(n)).sin_cos();
            for j in 0..2 * n {
                let phi = PI * (f64::from(j) + 0.5) / f64::from(n);
                let height = angle.cos() * z + angle.sin() * rim * phi.cos();
                sum += radiance(z) * height.max(0.0) * rim * PI * FRAC_PI_2 / f64::from(n * n);
            }
        }
        sum / PI
    }

    #[test]
    fn slopes_agree_with_quadrature() {
        for step in 0..=18 {
            let angle = f64::from(10 * step).to_radians();
            for (name, closed, expected) in [
                ("overcast", overcast(angle), on_a_slope(|z| (1.0 + 2.0 * z) / 3.0, angle)),
                ("ramp", ramp(angle), on_a_slope(|_| 1.0, angle)),
            ] {
                assert!((closed - expected).abs() < 4e-6, "{name} {angle}: {closed} for {expected}");
            }
        }
        assert!((overcast(0.0) - 7.0 / 9.0).abs() < 1e-15);
    }

    #[test]
    fn trenches_agree_with_quadrature() {
        for walls in [[0.0, 0.0], [0.3, 0.3], [0.8, 0.2], [1.4, 0.0], [0.1, 1.2]] {
            // Either wall's half turn by itself, so that nothing jumps within.
            let half_turn = |from: f64| {
                gauss(48, from, from + PI, |azimuth| {
                    gauss(12, trench_horizon(walls, azimuth), FRAC_PI_2, |elevation| elevation.sin() * elevation.cos())
                })
            };
            let expected = (half_turn(0.0) + half_turn(PI)) / PI;
            assert!((trench(walls) - expected).abs() < 1e-8, "{walls:?}: {} for {expected}", trench(walls));
        }
    }

    /// The walls themselves: planes through lines at their tops' elevations.
    #[test]
    fn trench_horizons_meet_the_walls_tops() {
        let walls = [0.9f64, 0.4];
        for step in 0..72 {
            let azimuth = TAU * (f64::from(step) + 0.5) / 72.0;
            let omega = trench_horizon(walls, azimuth);
            let wall = if step < 36 { walls[0] } else { walls[1] };
            let (across, up) = (azimuth.sin().abs() * omega.cos(), omega.sin());
            assert!((up * wall.cos() - across * wall.sin()).abs() < 1e-15, "{azimuth}");
        }
        assert_eq!(trench_horizon([FRAC_PI_2; 2], FRAC_PI_2), FRAC_PI_2);
    }
}
