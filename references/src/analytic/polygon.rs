//! Polygonal lights.

use std::f64::consts::PI;

use glam::DVec3;

/// Irradiance over `π` from a plane polygon of radiance 1 on a receiver with a unit normal; corners relative to the receiver.
///
/// Lambert's formula `1/2π Σ θᵢ n·γᵢ` over the edges, `θᵢ` the angle that an edge covers and `γᵢ` the unit normal of its plane
/// through the receiver, of what is above the receiver's horizon (Baum, Rushmeier and Winget 1989). The polygon may be concave.
/// Positive where the corners run anticlockwise as seen from the receiver, negative where it sees the back; a light of two sides
/// takes the magnitude. The error is about 1e-16 for each corner, and not relative to the result.
pub fn polygon_over_receiver(corners: &[DVec3], normal: DVec3) -> f64 {
    let above = above_horizon(corners, normal);
    let edges = above.iter().zip(above.iter().cycle().skip(1));
    // Anticlockwise as seen from the receiver, edges turn about −n.
    -edges.map(|(from, to)| normal.dot(turn(*from, *to))).sum::<f64>() / (2.0 * PI)
}

/// `θγ`: the angle between two directions, along the axis of the turn.
fn turn(from: DVec3, to: DVec3) -> DVec3 {
    let cross = from.cross(to);
    let length = cross.length();
    if length > 0.0 { cross * (length.atan2(from.dot(to)) / length) } else { DVec3::ZERO }
}

/// The polygon's part with `n·x ≥ 0` (Sutherland and Hodgman 1974).
fn above_horizon(corners: &[DVec3], normal: DVec3) -> Vec<DVec3> {
    let mut above = Vec::with_capacity(corners.len() + 1);
    for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (start, end) = (normal.dot(*from), normal.dot(*to));
        if start >= 0.0 {
            above.push(*from);
        }
        if (start >= 0.0) != (end >= 0.0) {
            above.push(from + (to - from) * (start / (start - end)));
        }
    }
    above
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{disc_over_point, rectangle_over_point};

    /// `1/π ∫ max(0, n·ω) cos' /r² dA` over triangles `(p₀, pᵢ, pᵢ₊₁)`, those that turn the other way counted off: what is right for a
    /// concave polygon. Midpoints of a square that is folded to the triangle.
    fn by_quadrature(corners: &[DVec3], normal: DVec3) -> f64 {
        let n = 500;
        let mut sum = 0.0;
        for pair in corners[1..].windows(2) {
            let (a, ab, ac) = (corners[0], pair[0] - corners[0], pair[1] - corners[0]);
            let area = ab.cross(ac);
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                for j in 0..n {
                    let v = (f64::from(j) + 0.5) / f64::from(n);
                    let point = a + ab * (u * (1.0 - v)) + ac * (u * v);
                    let squared = point.length_squared();
                    let facing = -area.dot(point) * normal.dot(point).max(0.0);
                    sum += u * facing / (squared * squared * f64::from(n * n));
                }
            }
        }
        sum / PI
    }

    #[test]
    fn polygons_agree_with_quadrature_above_and_across_the_horizon() {
        let v = DVec3::new;
        let square = vec![v(-1.0, -1.0, 1.0), v(-1.0, 1.0, 1.0), v(1.0, 1.0, 1.0), v(1.0, -1.0, 1.0)];
        let tilted = vec![v(1.0, 0.0, -0.5), v(1.2, 0.3, 1.0), v(1.1, -0.5, 1.4)];
        let pentagon =
            vec![v(0.8, 1.0, 0.1), v(0.2, 1.0, -0.6), v(-0.9, 1.0, -0.3), v(-0.7, 1.0, 0.8), v(0.1, 1.0, 1.2)];
        // Its waist is cut by the horizon into two parts.
        let arrow = vec![v(2.0, 0.0, 1.0), v(2.0, 1.0, -0.5), v(2.0, 0.0, 0.4), v(2.0, -1.0, -0.5)];
        let hook = vec![v(2.0, 0.0, -1.0), v(2.0, -1.0, 0.5), v(2.0, 0.0, -0.4), v(2.0, 1.0, 0.5)];
        let tilt = |x: f64, y: f64| v(x, y, 1.0).normalize();
        for (name, corners) in
            [("square", square), ("tilted", tilted), ("pentagon", pentagon), ("arrow", arrow), ("hook", hook)]
        {
            for normal in [DVec3::Z, tilt(0.5, 0.1), tilt(-0.7, 0.4), tilt(0.2, -2.0)] {
                let (closed, expected) = (polygon_over_receiver(&corners, normal), by_quadrature(&corners, normal));
                assert!((closed - expected).abs() < 1e-5, "{name} under {normal}: {closed} for {expected}");
                let reversed: Vec<DVec3> = corners.iter().rev().copied().collect();
                assert!((polygon_over_receiver(&reversed, normal) + closed).abs() < 1e-14, "{name}");
            }
        }
    }

    #[test]
    fn a_square_below_that_faces_up_is_positive() {
        // Seen from above, as the receiver sees it, this runs anticlockwise.
        let square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, -1.0));
        let expected = 4.0 * rectangle_over_point([1.0, 1.0], 1.0);
        assert!((polygon_over_receiver(&square, -DVec3::Z) - expected).abs() < 1e-14);
        assert_eq!(polygon_over_receiver(&square, DVec3::Z), 0.0, "all below the horizon");
        // Through the receiver, it runs clockwise: the back.
        assert!((polygon_over_receiver(&square.map(|corner| -corner), DVec3::Z) + expected).abs() < 1e-14);
    }

    #[test]
    fn many_corners_make_a_disc() {
        let corner = |i: u32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 4000.0).sin_cos();
            DVec3::new(0.7 * cos, 0.7 * sin, 1.3)
        };
        let disc: Vec<DVec3> = (0..4000).rev().map(corner).collect();
        assert!((polygon_over_receiver(&disc, DVec3::Z) - disc_over_point(0.7, 1.3)).abs() < 1e-6);
    }

    #[test]
    fn a_huge_plate_covers_the_hemisphere_and_no_polygon_covers_nothing() {
        let plate =
            [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(1e6 * x, 1e6 * y, 1.0));
        assert!((polygon_over_receiver(&plate, DVec3::Z) - 1.0).abs() < 1e-9);
        assert_eq!(polygon_over_receiver(&[], DVec3::Z), 0.0);
        assert_eq!(polygon_over_receiver(&[DVec3::Z, DVec3::X], DVec3::Z), 0.0);
        assert!(polygon_over_receiver(&[DVec3::ZERO, DVec3::Z, DVec3::X], DVec3::Z).is_finite());
    }
}
