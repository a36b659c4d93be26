//! Places on surfaces at which elements stand: the vertices of meshes, points of a spiral on spheres.

use std::f32::consts::PI;

use glam::Vec3;
use halflight_scenes::{Mesh, Pose, Shape, Sphere};

/// Azimuth from one point of the spiral to the next: the golden angle in radians.
const GOLDEN_ANGLE: f32 = 2.399_963_2;

/// An oriented piece of surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    pub(crate) position: Vec3,
    /// Unit, outward.
    pub(crate) normal: Vec3,
    /// Square metres.
    pub(crate) area: f32,
}

/// The sites of a shape carried along by a pose: their number and order stay the same while the shape deforms. `most` is shared by
/// the spheres of an object; meshes have one a vertex.
pub(crate) fn sites(shape: &Shape, pose: Pose, most: usize) -> Vec<Site> {
    let mut sites = match shape {
        Shape::Mesh(mesh) => on_mesh(mesh),
        Shape::Heights(field) => on_mesh(field.mesh()),
        Shape::Spheres(spheres) => {
            let count = (most / spheres.len().max(1)).clamp(16, 128);
            spheres.iter().flat_map(|sphere| on_sphere(*sphere, count)).collect()
        }
    };
    for site in &mut sites {
        site.position = pose.point(site.position);
        site.normal = pose.direction(site.normal);
    }
    sites
}

/// A third of every triangle's area at each of its corners.
fn on_mesh(mesh: &Mesh) -> Vec<Site> {
    let vertices = mesh.positions.iter().zip(&mesh.normals);
    let mut sites: Vec<Site> = vertices.map(|(&position, &normal)| Site { position, normal, area: 0.0 }).collect();
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(triangle);
        let third = (b - a).cross(c - a).length() / 6.0;
        corners.iter().for_each(|corner| sites[*corner as usize].area += third);
    }
    sites
}

/// Points of equal area.
pub(crate) fn on_sphere(sphere: Sphere, count: usize) -> impl Iterator<Item = Site> {
    let area = 4.0 * PI * sphere.radius * sphere.radius / count as f32;
    (0..count).map(move |i| {
        let height = 1.0 - (2 * i + 1) as f32 / count as f32;
        let (sin, cos) = (GOLDEN_ANGLE * i as f32).sin_cos();
        let around = (1.0 - height * height).sqrt();
        let normal = Vec3::new(around * cos, around * sin, height);
        Site { position: sphere.center + sphere.radius * normal, normal, area }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_add_up_to_the_surface() {
        let corners = [Vec3::ZERO, 2.0 * Vec3::X, 3.0 * Vec3::Y, Vec3::new(2.0, 3.0, 0.0)];
        let plate = Mesh {
            positions: corners.to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: Vec::new(),
            triangles: vec![[0, 1, 2], [1, 3, 2]],
        };
        let areas = |shape: &Shape, most| -> Vec<f32> {
            sites(shape, Pose::IDENTITY, most).iter().map(|site| site.area).collect()
        };
        assert_eq!(areas(&Shape::Mesh(plate), 16), [1.0, 2.0, 2.0, 1.0]);
        let spheres = [0.5, 2.0].map(|radius| Sphere { center: Vec3::X, radius });
        let found = areas(&Shape::Spheres(spheres.to_vec()), 100);
        assert_eq!(found.len(), 100);
        let sum: f32 = found.iter().sum();
        assert!((sum / (4.0 * PI * 4.25) - 1.0).abs() < 1e-5, "{sum}");
    }

    #[test]
    fn sites_of_a_sphere_lie_on_it_and_look_outward() {
        let sphere = Sphere { center: Vec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let turned = Pose { rotation: glam::Quat::from_rotation_x(1.0), translation: Vec3::new(-1.0, 0.0, 4.0) };
        for site in sites(&Shape::Spheres(vec![sphere]), turned, 200) {
            let outward = (site.position - turned.point(sphere.center)) / sphere.radius;
            assert!(outward.distance(site.normal) < 1e-5 && (site.normal.length() - 1.0).abs() < 1e-5);
        }
    }
}
