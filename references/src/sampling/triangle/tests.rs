use super::*;
use crate::sampling::chi_squared::{Family, draws};

/// Steps an edge is divided into: bins are the triangles between them.
const STEPS: usize = 12;

/// Triangles seen from the origin.
fn seen() -> Vec<(&'static str, [Vec3; 3])> {
    let v = Vec3::new;
    vec![
        ("ordinary", [v(1.0, 0.2, 1.0), v(-0.5, 1.0, 1.2), v(-0.2, -1.0, 0.8)]),
        ("an octant", [Vec3::X, Vec3::Y, Vec3::Z]),
        ("a receiver just below its middle", [v(10.0, 0.0, 1e-3), v(-5.0, 8.0, 1e-3), v(-5.0, -8.0, 1e-3)]),
        ("a receiver just below an edge", [v(10.0, 1e-3, 1e-3), v(-10.0, 1e-3, 1e-3), v(0.0, 10.0, 1e-3)]),
        ("a receiver just below a corner", [v(1e-3, 0.0, 1e-3), v(10.0, 5.0, 1e-3), v(10.0, -5.0, 1e-3)]),
        ("grazing", [v(1.0, 0.0, 0.01), v(2.0, 0.5, 0.01), v(2.0, -0.6, 0.01)]),
        ("small", [v(1.0, 1.0, 1.0), v(1.01, 1.0, 1.0), v(1.0, 1.012, 1.0)]),
        ("tiny", [v(1.0, 1.0, 1.0), v(1.000_01, 1.0, 1.0), v(1.0, 1.000_012, 1.0)]),
        ("a needle", [v(0.0, 0.0, 1.0), v(1.0, 1e-4, 1.0), v(1.0, -1e-4, 1.0)]),
        ("clockwise", [v(-0.2, -1.0, 0.8), v(-0.5, 1.0, 1.2), v(1.0, 0.2, 1.0)]),
    ]
}

fn sampler(corners: [Vec3; 3]) -> TriangleSampler {
    TriangleSampler::new(corners, Vec3::ZERO).expect("seen")
}

/// By L'Huilier's theorem, from the sides.
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let side = |p: DVec3, q: DVec3| p.cross(q).length().atan2(p.dot(q));
    let (x, y, z) = (side(b, c), side(c, a), side(a, b));
    let s = 0.5 * (x + y + z);
    let product = (0.5 * s).tan() * (0.5 * (s - x)).tan() * (0.5 * (s - y)).tan() * (0.5 * (s - z)).tan();
    4.0 * product.max(0.0).sqrt().atan()
}

/// Every division of the triangle by lines of constant barycentrics, with its share of the solid angle.
fn shares(corners: [Vec3; 3]) -> Vec<f64> {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let at = |i: usize, j: usize| a + ((b - a) * i as f64 + (c - a) * j as f64) / STEPS as f64;
    let mut shares = vec![0.0; 2 * STEPS * STEPS];
    for i in 0..STEPS {
        for j in 0..STEPS - i {
            shares[2 * (i * STEPS + j)] = solid_angle([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < STEPS {
                shares[2 * (i * STEPS + j) + 1] = solid_angle([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    let total: f64 = shares.iter().sum();
    shares.iter().map(|share| share / total).collect()
}

/// The division that a direction meets; `None` outside by more than rounding.
fn bin(corners: [Vec3; 3], direction: DVec3) -> Option<usize> {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (ab, ac) = (b - a, c - a);
    // Cramer's rule on a + s·ab + t·ac = distance·direction.
    let scale = ab.cross(ac).dot(direction);
    let (s, t) = (-a.cross(ac).dot(direction) / scale, -ab.cross(a).dot(direction) / scale);
    if s < -1e-3 || t < -1e-3 || s + t > 1.001 {
        return None;
    }
    let (s, t) = (s.max(0.0) * STEPS as f64, t.max(0.0) * STEPS as f64);
    let i = (s as usize).min(STEPS - 1);
    let j = (t as usize).min(STEPS - 1 - i);
    let upper = s.fract() + t.fract() > 1.0 && i + j + 1 < STEPS;
    Some(2 * (i * STEPS + j) + usize::from(upper))
}

#[test]
fn density_is_that_of_the_solid_angle() {
    let mut family = Family::default();
    for (name, corners) in seen() {
        let sampler = sampler(corners);
        let expected = solid_angle(corners.map(Vec3::as_dvec3));
        let found = f64::from(sampler.solid_angle());
        assert!((found / expected - 1.0).abs() < 1e-5, "{name}: {found} for {expected}");
        family.add(name, &shares(corners), draws(6).map(|point| bin(corners, sampler.precise_direction(point))));
    }
    family.assert_holds();
}

/// Uniform in area instead of solid angle.
#[test]
fn naive_barycentrics_are_found_out() {
    let mut family = Family::default();
    for (name, corners) in seen().into_iter().filter(|(name, _)| !["tiny", "small"].contains(name)) {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let naive = |[u, v]: [f32; 2]| {
            let (root, v) = (f64::from(u).sqrt(), f64::from(v));
            (a * (1.0 - root) + b * (root * (1.0 - v)) + c * (root * v)).normalize()
        };
        family.add(name, &shares(corners), draws(7).map(|point| bin(corners, naive(point))));
    }
    family.assert_fails_everywhere();
}

#[test]
fn distances_are_those_of_the_plane() {
    for (name, corners) in seen() {
        let sampler = sampler(corners);
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a).normalize();
        for point in draws(8).take(1000) {
            let direction = sampler.direction(point);
            let (distance, cosine) = (f64::from(sampler.distance(direction)), normal.dot(direction.as_dvec3()).abs());
            let height = normal.dot(a).abs();
            // As much as a rounding of the direction can do.
            assert!((distance * cosine / height - 1.0).abs() < 1e-6 / cosine, "{name}: {distance} at {cosine}");
            assert!(distance <= a.length().max(b.length()).max(c.length()) * (1.0 + 1e-6), "{name}");
        }
    }
}

#[test]
fn all_sizes_that_f32_can_hold_are_finite() {
    let [a, b, c] = seen()[0].1;
    for exponent in -12..=12 {
        for apart in [1e-7f32, 1e-4, 1.0, 1e4, 1e7] {
            let size = 10f32.powi(exponent);
            let corners = [a, b, c].map(|corner| size * (corner + Vec3::new(0.1, 0.2, 0.3 + apart)));
            let sampler = sampler(corners);
            for point in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.3]] {
                let direction = sampler.direction(point);
                let distance = sampler.distance(direction);
                assert!(direction.is_normalized() && sampler.solid_angle().recip().is_finite());
                assert!(distance.is_finite() && distance > 0.0, "size {size}, {apart} away: {distance}");
            }
        }
    }
}

#[test]
fn nothing_is_seen_of_what_has_no_area_or_is_edge_on() {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    for corners in [
        [x + z, x + z, x + z],
        [x + z, x + z, y + z],
        [x + z, 2.0 * x + z, 3.0 * x + z],
        [x, y, x + y],
        [x, y, -x - y],
        [Vec3::ZERO, x, y],
        [Vec3::ZERO, x + z, y],
        [f32::NAN * x, y, z],
        [f32::INFINITY * x, y, z],
        [1e25 * x, 1e25 * x + y, 1e25 * x + z],
    ] {
        assert!(TriangleSampler::new(corners, Vec3::ZERO).is_none(), "{corners:?}");
    }
}
