//! Scenes and an oracle that know nothing of hierarchies.

use glam::{DVec3, Vec3};
use halflight_trace::{Ray, Sphere};

/// Deterministic numbers in `[0, 1)` (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32
    }

    pub(crate) fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point();
            if p.length() > 0.1 && p.length() < 1.0 {
                return p.normalize();
            }
        }
    }
}

/// `count` small random triangles, no vertex shared, in a cube of half width 1.
pub(crate) fn soup(random: &mut Random, count: u32, size: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = random.point();
        positions.extend([0; 3].map(|_| center + random.point() * size));
    }
    (positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// A closed sphere-like mesh of latitude and longitude bands with irregular radii.
pub(crate) fn closed_mesh(bands: u32, random: &mut Random) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sectors = 2 * bands;
    let mut positions = vec![Vec3::Z, -Vec3::Z];
    for band in 1..bands {
        for sector in 0..sectors {
            let (polar, azimuth) = (
                std::f32::consts::PI * band as f32 / bands as f32,
                std::f32::consts::TAU * sector as f32 / sectors as f32,
            );
            let direction = Vec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
            positions.push(direction * (0.8 + 0.3 * random.unit()));
        }
    }
    let at = |band: u32, sector: u32| match band {
        0 => 0,
        band if band == bands => 1,
        band => 2 + (band - 1) * sectors + sector % sectors,
    };
    let quads = (0..bands).flat_map(|band| (0..sectors).map(move |sector| (band, sector)));
    let triangles = quads.flat_map(|(band, sector)| {
        let corners = [at(band, sector), at(band + 1, sector), at(band + 1, sector + 1), at(band, sector + 1)];
        [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
    });
    let proper = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    (positions, proper)
}

/// Signed distances in `f64`: where the ray meets the triangle (Möller and Trumbore 1997), and how far inside the
/// hit is: the least barycentric weight, negative outside.
pub(crate) fn triangle_hit(ray: &Ray, corners: [Vec3; 3]) -> Option<(f64, f64)> {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let p: DVec3 = d.cross(e2);
    let determinant = e1.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = o - a;
    let q = s.cross(e1);
    let (v, w) = (s.dot(p) / determinant, d.dot(q) / determinant);
    Some((e2.dot(q) / determinant, v.min(w).min(1.0 - v - w)))
}

/// Both roots in `f64`, with the relative depth at which the ray passes inside the sphere.
pub(crate) fn sphere_hits(ray: &Ray, sphere: &Sphere) -> ([f64; 2], f64) {
    let (o, d) = (ray.origin.as_dvec3() - sphere.center.as_dvec3(), ray.direction.as_dvec3());
    let radius = f64::from(sphere.radius);
    let (a, half_b, c) = (d.dot(d), o.dot(d), o.dot(o) - radius * radius);
    let discriminant = half_b * half_b - a * c;
    let root = discriminant.max(0.0).sqrt();
    ([(-half_b - root) / a, (-half_b + root) / a], discriminant / (radius * radius))
}
