//! Spheres seen from a point.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::cone::Cone;

/// Uniform directions within the circle that a sphere covers.
#[derive(Clone, Debug)]
pub(crate) struct SphereSampler {
    cone: Cone,
    to_center: DVec3,
    squared_radius: f64,
    /// Squared distance to where the rim touches.
    squared_tangent: f64,
}

impl SphereSampler {
    /// The sphere as seen from a point; `None` from within or on it, and where its solid angle is below what `f32` can hold.
    pub(crate) fn new(center: Vec3, radius: f32, from: Vec3) -> Option<Self> {
        // Squares of f32 are exact in f64, so that little is lost just above the surface.
        let to_center = center.as_dvec3() - from.as_dvec3();
        let (squared_distance, squared_radius) = (to_center.length_squared(), f64::from(radius) * f64::from(radius));
        let squared_tangent = squared_distance - squared_radius;
        // 1 − cos α = sin² α/(1 + cos α)
        let cosine = (squared_tangent / squared_distance).sqrt();
        let squared_chord = 2.0 * squared_radius / squared_distance / (1.0 + cosine);
        let seen = squared_tangent > 0.0 && ((PI * squared_chord) as f32).is_normal();
        seen.then(|| SphereSampler {
            cone: Cone::new(to_center.normalize().as_vec3(), squared_chord),
            to_center,
            squared_radius,
            squared_tangent,
        })
    }

    /// In `(0, 2π)`; its inverse is the density a steradian.
    pub(crate) fn solid_angle(&self) -> f32 {
        self.cone.solid_angle()
    }

    /// The unit direction of a point of the unit square. By rounding it may miss the rim by about 1e-7.
    pub(crate) fn direction(&self, point: [f32; 2]) -> Vec3 {
        self.cone.direction(point)
    }

    /// Distance to the near surface along one of the sampler's directions; where rounding makes it miss, to the rim.
    pub(crate) fn distance(&self, direction: Vec3) -> f32 {
        let direction = direction.as_dvec3();
        let squared_miss = self.to_center.cross(direction).length_squared();
        let half_chord = (self.squared_radius - squared_miss).max(0.0).sqrt();
        // The product of both intersections' distances is the squared tangent; the far one loses no digits.
        (self.squared_tangent / (self.to_center.dot(direction) + half_chord)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::chi_squared::{Family, draws, ring_and_sector, ring_shares};

    /// Centre, radius and receiver: ordinary, grazing the surface, small, far from the origin.
    const SEEN: [(Vec3, f32, Vec3); 6] = [
        (Vec3::new(0.3, -0.4, 2.0), 1.0, Vec3::ZERO),
        (Vec3::new(0.0, 0.0, -1.000_001), 1.0, Vec3::ZERO),
        (Vec3::new(50.0, 20.0, 90.0), 1.0, Vec3::new(-1.0, 2.0, 3.0)),
        (Vec3::new(3e-4, 1e-4, 2e-4), 1e-4, Vec3::ZERO),
        (Vec3::new(1000.0, -2000.0, 500.0), 2.0, Vec3::new(1000.5, -1998.0, 501.0)),
        (Vec3::new(1e6, 1e6, -1e6), 1e4, Vec3::ZERO),
    ];

    fn sampler((center, radius, from): (Vec3, f32, Vec3)) -> SphereSampler {
        SphereSampler::new(center, radius, from).expect("outside")
    }

    /// `1 − cos α` and the axis, from the geometry alone.
    fn circle((center, radius, from): (Vec3, f32, Vec3)) -> (f64, DVec3) {
        let axis = center.as_dvec3() - from.as_dvec3();
        (2.0 * (0.5 * (f64::from(radius) / axis.length()).asin()).sin().powi(2), axis.normalize())
    }

    #[test]
    fn density_is_that_of_the_solid_angle() {
        let (mut honest, mut planted) = (Family::default(), Family::default());
        for case in SEEN {
            let (sampler, (height, axis)) = (sampler(case), circle(case));
            let bin = |direction: Vec3| ring_and_sector(direction, axis, height);
            let name = format!("{case:?}");
            assert!((f64::from(sampler.solid_angle()) / (2.0 * PI * height) - 1.0).abs() < 1e-5, "{name}");
            honest.add(&name, &ring_shares(), draws(3).map(|point| bin(sampler.direction(point))));
            // Uniform on the disc through the rim, as seen from afar: wrong near by.
            let flat = |[u, v]: [f32; 2]| {
                let (sine_squared, h) = (f64::from(u) * height * (2.0 - height), 1.0 - height);
                let slant = sine_squared / (sine_squared + h * h);
                sampler.direction([((1.0 - (1.0 - slant).sqrt()) / height) as f32, v])
            };
            if height > 0.05 {
                planted.add(&name, &ring_shares(), draws(4).map(|point| bin(flat(point))));
            }
        }
        honest.assert_holds();
        planted.assert_fails_everywhere();
    }

    #[test]
    fn distances_are_those_of_the_surface() {
        for case in SEEN {
            let (sampler, (_, axis)) = (sampler(case), circle(case));
            let (to_center, radius) = (case.0.as_dvec3() - case.2.as_dvec3(), f64::from(case.1));
            let nearest = to_center.length() - radius;
            let farthest = (to_center.length_squared() - radius * radius).sqrt();
            for point in draws(5).take(1000) {
                let direction = sampler.direction(point);
                let distance = f64::from(sampler.distance(direction));
                assert!(
                    distance >= nearest * (1.0 - 1e-4) && distance <= farthest * (1.0 + 1e-6),
                    "{case:?}: {distance}"
                );
                // What a rounding of the direction can move the hit by, unless it grazes.
                let hit = distance * direction.as_dvec3() - to_center;
                let slack = 1e-6 * to_center.length() + 1e-12 * radius;
                assert!((hit.length() - radius).abs() < slack, "{case:?}: off by {}", hit.length() - radius);
            }
            let straight = f64::from(sampler.distance(axis.as_vec3()));
            assert!((straight / nearest - 1.0).abs() < 1e-4, "{case:?}: {straight} for {nearest}");
        }
    }

    #[test]
    fn all_sizes_that_f32_can_hold_are_finite_and_others_are_none() {
        for exponent in -16..=16 {
            for gap in [1e-7f32, 1e-3, 1.0, 1e3, 1e6, 1e9] {
                let radius = 10f32.powi(exponent);
                let center = Vec3::new(0.0, radius * (1.0 + gap), 0.0);
                let Some(sampler) = SphereSampler::new(center, radius, Vec3::ZERO) else {
                    panic!("radius {radius} at {center}")
                };
                for point in [[0.0, 0.0], [1.0, 1.0], [0.5, 0.3]] {
                    let direction = sampler.direction(point);
                    let distance = sampler.distance(direction);
                    assert!(direction.is_normalized() && sampler.solid_angle().recip().is_finite());
                    assert!(distance.is_finite() && distance > 0.0, "radius {radius} at {center}: {distance}");
                }
            }
        }
        for (center, radius) in [
            (Vec3::X, 1.0),
            (0.5 * Vec3::X, 1.0),
            (Vec3::X, 0.0),
            (Vec3::ZERO, 0.0),
            (Vec3::X, f32::NAN),
            (Vec3::X, f32::INFINITY),
            (f32::NAN * Vec3::X, 1.0),
            (f32::INFINITY * Vec3::X, 1.0),
            (1e30 * Vec3::X, 1e-30),
        ] {
            assert!(SphereSampler::new(center, radius, Vec3::ZERO).is_none(), "{center} {radius}");
        }
    }
}
