//! Triangles seen from a point.

use glam::{DVec3, Vec3};

/// Uniform directions within the spherical triangle that a triangle covers (Arvo 1995, Stratified Sampling of Spherical
/// Triangles), with the half-vector construction of Peters 2021, BRDF Importance Sampling for Polygonal Lights.
///
/// In `f64` throughout: its smallest triangles are then finer than the steps of an `f32` direction, and need no case of their
/// own.
#[derive(Clone, Debug)]
pub(crate) struct TriangleSampler {
    /// Unit directions `v₀, v₁, v₂` of the corners; the first two are the nearest pair.
    corners: [DVec3; 3],
    /// `|det(v₀, v₁, v₂)|`.
    volume: f64,
    /// `v₀·v₂ + v₁·v₂`.
    third: f64,
    /// `1 + v₀·v₁`.
    pair: f64,
    half_angle: f64,
    plane: Plane,
}

/// The triangle's plane, and how far from the receiver the triangle's points may be.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: DVec3,
    height: f64,
    farthest: f64,
}

/// Heights over the plane below this share of the distance are rounding.
const FLAT: f64 = 1e-14;

impl TriangleSampler {
    /// The triangle as seen from a point; `None` if it is degenerate or seen edge on, and where its solid angle is below what
    /// `f32` can hold.
    pub(crate) fn new(corners: [Vec3; 3], from: Vec3) -> Option<Self> {
        let mut corners = corners.map(|corner| corner.as_dvec3() - from.as_dvec3());
        let plane = Plane::of(&corners)?;
        let volume = plane.volume(&corners);
        corners = nearest_pair_first(corners.map(DVec3::normalize));
        let [a, b, c] = corners;
        let (third, pair) = (a.dot(c) + b.dot(c), 0.5 * (a + b).length_squared());
        // Van Oosterom and Strackee 1983: tan(Ω/2) = det/(1 + a·b + b·c + c·a).
        let half_angle = volume.atan2(pair + third);
        let seen = ((2.0 * half_angle) as f32).is_normal();
        seen.then_some(TriangleSampler { corners, volume, third, pair, half_angle, plane })
    }

    /// In `(0, 2π)`; its inverse is the density a steradian.
    pub(crate) fn solid_angle(&self) -> f32 {
        (2.0 * self.half_angle) as f32
    }

    /// The unit direction of a point of the unit square. By rounding it may miss an edge by about 1e-7.
    pub(crate) fn direction(&self, point: [f32; 2]) -> Vec3 {
        self.precise_direction(point).as_vec3()
    }

    /// Distance to the triangle's plane along one of the sampler's directions, between the plane's and the farthest corner's.
    pub(crate) fn distance(&self, direction: Vec3) -> f32 {
        let Plane { normal, height, farthest } = self.plane;
        (height / normal.dot(direction.as_dvec3()).abs()).clamp(height, farthest) as f32
    }

    fn precise_direction(&self, [u, v]: [f32; 2]) -> DVec3 {
        let [a, b, c] = self.corners;
        // The point c′ on the arc from a to c that leaves a share u of the solid angle in (a, b, c′), by reflecting a.
        let (sin, cos) = (f64::from(u) * self.half_angle).sin_cos();
        let half = a * (self.volume * cos - self.third * sin) + c * (self.pair * sin);
        let c = half * (2.0 * a.dot(half) / half.length_squared()) - a;
        // A point on the arc from b to c′, its cosine from b uniform from 1 to b·c′, with 1 ∓ b·c′ free of cancellation.
        let (apart, against) = (0.5 * (c - b).length_squared(), 0.5 * (c + b).length_squared().max(1e-30));
        let down = f64::from(v) * apart;
        let along = (f64::from(v) * (2.0 - down) / against).sqrt();
        (b * (1.0 - down - along * (1.0 - apart)) + c * along).normalize()
    }
}

impl Plane {
    /// `None` if the triangle has no area or lies in one plane with the origin, or is not finite.
    fn of([a, b, c]: &[DVec3; 3]) -> Option<Self> {
        let normal = (b - a).cross(c - a).try_normalize()?;
        let nearest = [*a, *b, *c].into_iter().min_by(|p, q| p.length_squared().total_cmp(&q.length_squared()))?;
        let farthest = a.length().max(b.length()).max(c.length());
        let height = normal.dot(nearest).abs();
        let seen = height > FLAT * nearest.length() && farthest.is_finite();
        seen.then_some(Plane { normal, height, farthest })
    }

    /// `|det|` of the unit directions of the corners.
    fn volume(&self, [a, b, c]: &[DVec3; 3]) -> f64 {
        let double_area = (b - a).cross(c - a).length();
        self.height / a.length() * (double_area / b.length() / c.length())
    }
}

/// Turned about so that the first two are nearest to each other: `1 + v₀·v₁` is then never small.
fn nearest_pair_first([a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    let (ab, bc, ca) = (a.dot(b), b.dot(c), c.dot(a));
    if ab >= bc && ab >= ca {
        [a, b, c]
    } else if bc >= ca {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests;
