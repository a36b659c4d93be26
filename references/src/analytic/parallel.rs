//! Plane figures that face a parallel receiver.

use std::f64::consts::PI;

/// Irradiance over `π` from a disc of radiance 1 on a parallel receiver straight below its centre: `r²/(r² + h²)` (Howell, A
/// Catalog of Radiation Heat Transfer Configuration Factors, the coaxial disc).
pub fn disc_over_point(radius: f64, height: f64) -> f64 {
    radius * radius / (radius * radius + height * height)
}

/// Irradiance over `π` from a rectangle of radiance 1 on a parallel receiver straight below one of its corners, `height > 0` away:
/// `1/2π·(X/√(1+X²)·atan(Y/√(1+X²)) + Y/√(1+Y²)·atan(X/√(1+Y²)))` with `X, Y` the sides over the height (Howell, the rectangle
/// whose corner lies on the element's normal). Below other points it is the sum over four.
pub fn rectangle_over_point(sides: [f64; 2], height: f64) -> f64 {
    let term = |x: f64, y: f64| x / x.hypot(1.0) * (y / x.hypot(1.0)).atan();
    let [x, y] = sides.map(|side| side / height);
    (term(x, y) + term(y, x)) / (2.0 * PI)
}

/// The share of what one square radiates that reaches another, equal, parallel and straight across, for `X > 0` the side over the
/// distance: `2/(πX²)·(ln((1+X²)/√(1+2X²)) + 2X√(1+X²)·atan(X/√(1+X²)) − 2X·atan X)` (Howell, identical, parallel, directly
/// opposed rectangles). For small `X` digits cancel: below 0.01 fewer than eight remain.
pub fn parallel_squares(side_over_distance: f64) -> f64 {
    let x = side_over_distance;
    let slant = x.hypot(1.0);
    let logarithm = (x * x).ln_1p() - 0.5 * (2.0 * x * x).ln_1p();
    2.0 / (PI * x * x) * (logarithm + 2.0 * x * (slant * (x / slant).atan() - x.atan()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::quadrature::{gauss, legendre};

    #[test]
    fn the_disc_agrees_with_quadrature() {
        for (radius, height) in [(1.0, 1.0), (0.3, 2.0), (5.0, 1.0)] {
            let expected = gauss(40, 0.0, radius, |r| 2.0 * r * height * height / (r * r + height * height).powi(2));
            assert!((disc_over_point(radius, height) - expected).abs() < 1e-10, "{radius} {height}");
        }
    }

    #[test]
    fn the_rectangle_agrees_with_quadrature() {
        for (sides, height) in [([1.0, 1.0], 1.0), ([2.0, 0.5], 1.5), ([0.1, 4.0], 1.0), ([6.0, 5.0], 2.0)] {
            let expected = gauss(60, 0.0, sides[0], |x| {
                gauss(60, 0.0, sides[1], |y| height * height / (PI * (x * x + y * y + height * height).powi(2)))
            });
            let closed = rectangle_over_point(sides, height);
            assert!((closed - expected).abs() < 1e-10, "{sides:?} {height}: {closed} for {expected}");
        }
    }

    #[test]
    fn parallel_squares_agree_with_quadrature_over_both() {
        let nodes = legendre(20);
        for x in [0.1, 0.5, 1.0, 2.0] {
            let mut sum = 0.0;
            // Half the side is the unit of all four coordinates.
            let across = (2.0 / x) * (2.0 / x);
            for (a, wa) in &nodes {
                for (b, wb) in &nodes {
                    for (c, wc) in &nodes {
                        for (d, wd) in &nodes {
                            let squared = (a - c) * (a - c) + (b - d) * (b - d) + across;
                            sum += wa * wb * wc * wd * across / (PI * squared * squared);
                        }
                    }
                }
            }
            let (closed, expected) = (parallel_squares(x), 0.25 * sum);
            assert!((closed / expected - 1.0).abs() < 1e-7, "{x}: {closed} for {expected}");
        }
        // Squares that all but touch see nothing else.
        assert!((parallel_squares(1e6) - 1.0).abs() < 1e-5);
        assert!((parallel_squares(0.01) / (1e-4 / PI) - 1.0).abs() < 1e-4);
    }
}
