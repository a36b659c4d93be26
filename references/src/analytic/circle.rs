//! Spheres and circles of directions over a receiver.

use std::f64::consts::{FRAC_PI_2, PI};

/// Fraction of a uniform sky's irradiance that a sphere takes from a receiver outside it.
///
/// `distance` is that of the sphere's centre in sphere radii (`H > 1`), `angle` that between the receiver's normal and the
/// direction of the centre, in `[0, π]`; the part of the sphere below the receiver's horizon takes nothing. This is the
/// differential form factor to a sphere: `cos θ/H²` where the sphere is all above the horizon, otherwise
/// `1/2 − 1/π·asin(√(H²−1)/(H sin θ)) + 1/(π H²)·(cos θ·acos(−√(H²−1)·cot θ) − √(H²−1)·√(1 − H² cos²θ))`
/// (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-43; Naraghi and Chung 1982).
pub fn sphere_over_receiver(distance: f64, angle: f64) -> f64 {
    let (h, (sin, cos)) = (distance, angle.sin_cos());
    let angular_radius = (1.0 / h).asin();
    if angle + angular_radius <= FRAC_PI_2 {
        return cos / (h * h);
    }
    if angle - angular_radius >= FRAC_PI_2 {
        return 0.0;
    }
    let tangent = (h * h - 1.0).sqrt();
    // The clamps only catch rounding where the sphere touches the horizon.
    let lune = (tangent / (h * sin)).min(1.0).asin();
    let arc = (-tangent * cos / sin).clamp(-1.0, 1.0).acos();
    let chord = (1.0 - h * h * cos * cos).max(0.0).sqrt();
    0.5 - lune / PI + (cos * arc - tangent * chord) / (PI * h * h)
}

/// Fraction of a uniform sky's irradiance that comes from a circle of directions of angular radius `α` in `(0, π/2]` with its
/// centre at an angle `θ` in `[0, π]` from the normal; the part below the horizon brings nothing. `sin²α·cos θ` where it is
/// all above.
pub fn circle(angular_radius: f64, angle: f64) -> f64 {
    sphere_over_receiver(1.0 / angular_radius.sin(), angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::quadrature::smooth_ends;

    /// `1/π ∫ max(0, n·ω) dω` over the cone of angular radius `a` around an axis at `angle` from `n`. At angle `t` from the axis
    /// the integral over azimuth of `max(0, A + B cos φ)` is elementary; the one over `t` is cut where it has kinks.
    fn by_quadrature(distance: f64, angle: f64) -> f64 {
        let a = (1.0 / distance).asin();
        let ring = |t: f64| {
            let (big_a, b) = (t.cos() * angle.cos(), t.sin() * angle.sin());
            let phi = if big_a >= b {
                PI
            } else if big_a <= -b {
                0.0
            } else {
                (-big_a / b).acos()
            };
            2.0 * (big_a * phi + b * phi.sin()) * t.sin()
        };
        let kink = (FRAC_PI_2 - angle).abs().min(a);
        (smooth_ends(0.0, kink, ring) + smooth_ends(kink, a, ring)) / PI
    }

    #[test]
    fn the_sphere_agrees_with_quadrature_everywhere() {
        let mut clipped = 0;
        for distance in [1.0001, 1.01, 1.1, 1.5, 2.0, 3.0, 5.6, 20.0] {
            for step in 0..=180 {
                let angle = f64::from(step).to_radians();
                let (closed, expected) = (sphere_over_receiver(distance, angle), by_quadrature(distance, angle));
                assert!((closed - expected).abs() < 2e-7, "H {distance} angle {step}°: {closed} against {expected}");
                clipped += usize::from((angle - FRAC_PI_2).abs() < (1.0 / distance).asin());
            }
        }
        assert!(clipped > 300, "{clipped} clipped cases");
    }

    #[test]
    fn circles_above_the_horizon_and_half_spaces() {
        assert!((circle(0.3, 0.7) - 0.3f64.sin().powi(2) * 0.7f64.cos()).abs() < 1e-15);
        for step in 0..=180 {
            let angle = f64::from(step).to_radians();
            assert!((circle(FRAC_PI_2, angle) - 0.5 * (1.0 + angle.cos())).abs() < 1e-12, "{step}°");
        }
    }
}
