//! Where a scene asks for light, and the receivers that come of it at a frame.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use halflight_trace::{Hit, Ray, World};
use rayon::prelude::*;

use crate::content::Collector;
use crate::receivers::Receiver;
use crate::{Camera, HeightField, Layout, Mesh, Object, Place, Pose, Receivers, Rgb, Shape};

/// Receivers at the centres of the cells of a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Centre of the rectangle.
    pub center: Vec3,
    /// Width and height in metres.
    pub size: Vec2,
    /// Cells across and down.
    pub resolution: [usize; 2],
    /// Unit normal. With +z, columns run along +x and rows from +y to −y; other normals turn this the shortest way.
    pub normal: Vec3,
    /// The object whose albedo and motion the grid takes.
    pub object: Option<usize>,
}

/// How a scene places its receivers.
#[derive(Clone, Debug, PartialEq)]
pub enum Placement {
    /// What each pixel of the scene's camera sees, ground that casts no shadow included.
    Camera,
    /// The vertices of a mesh.
    Vertices {
        /// Its index.
        object: usize,
    },
    /// A rectangle.
    Grid(Grid),
    /// Positions and unit normals, albedo 1.
    Points(Arc<Vec<(Vec3, Vec3)>>),
    /// The vertices of a height field, as a picture with +y at the top.
    Heights {
        /// Its index.
        object: usize,
    },
}

impl Placement {
    pub(crate) fn collect(&self, into: Collector) -> Collector {
        match self {
            Placement::Camera => into.word(0),
            Placement::Vertices { object } => into.word(1).word(*object),
            Placement::Grid(grid) => {
                let placed = into.word(2).vec3(grid.center).vec2(grid.size).vec3(grid.normal);
                let sized = placed.word(grid.resolution[0]).word(grid.resolution[1]);
                sized.word(grid.object.map_or(0, |object| object + 1))
            }
            Placement::Points(points) => into.word(3).list(points, |all, (p, n)| all.vec3(*p).vec3(*n)),
            Placement::Heights { object } => into.word(4).word(*object),
        }
    }
}

impl Grid {
    pub(crate) fn receivers(&self, albedo: Rgb, pose: Pose) -> Receivers {
        let [width, height] = self.resolution;
        let turn = Quat::from_rotation_arc(Vec3::Z, self.normal);
        let normal = pose.direction(self.normal).normalize();
        let cell = |index: usize| {
            let uv = Vec2::new((index % width) as f32 + 0.5, (index / width) as f32 + 0.5)
                / Vec2::new(width as f32, height as f32);
            let local = (uv - 0.5) * Vec2::new(1.0, -1.0) * self.size;
            let position = pose.point(self.center + turn * local.extend(0.0));
            let object = self.object.map(|object| object as u32);
            let place = Place { object, primitive: index as u32, uv, ..Place::NOWHERE };
            Some(Receiver { position, geometric_normal: normal, normal, albedo, place })
        };
        let cells: Vec<_> = (0..width * height).map(cell).collect();
        Receivers::gather(Layout::Image { width, height }, &cells)
    }
}

pub(crate) fn points(points: &[(Vec3, Vec3)]) -> Receivers {
    let receiver = |(index, (position, normal)): (usize, &(Vec3, Vec3))| {
        let place = Place { primitive: index as u32, ..Place::NOWHERE };
        Some(Receiver { position: *position, geometric_normal: *normal, normal: *normal, albedo: Rgb::ONE, place })
    };
    Receivers::gather(Layout::List, &points.iter().enumerate().map(receiver).collect::<Vec<_>>())
}

/// The vertices of a mesh under a pose; those that belong to no triangle are not valid.
pub(crate) fn vertices(object: usize, mesh: &Mesh, look: &Object) -> Receivers {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|vertex| used[*vertex as usize] = true);
    let receiver = |(index, used): (usize, bool)| {
        let normal = mesh.normals[index];
        let uv = mesh.uvs.get(index).copied().unwrap_or(Vec2::ZERO);
        let place = Place { object: Some(object as u32), primitive: index as u32, uv, ..Place::NOWHERE };
        let albedo = look.albedo_at(uv);
        used.then_some(Receiver { position: mesh.positions[index], geometric_normal: normal, normal, albedo, place })
    };
    Receivers::gather(Layout::List, &used.into_iter().enumerate().map(receiver).collect::<Vec<_>>())
}

/// The vertices of a posed height field, the row of the largest y first.
pub(crate) fn heights(object: usize, field: &HeightField, albedo: Rgb) -> Receivers {
    let (width, height) = (field.columns(), field.rows());
    let vertex = |pixel: usize| {
        let (column, row) = (pixel % width, height - 1 - pixel / width);
        let normal = field.normal(column, row);
        let uv = Vec2::new(column as f32, row as f32);
        let primitive = (row * width + column) as u32;
        let place = Place { object: Some(object as u32), primitive, uv, ..Place::NOWHERE };
        Some(Receiver { position: field.position(column, row), geometric_normal: normal, normal, albedo, place })
    };
    let vertices: Vec<_> = (0..width * height).map(vertex).collect();
    Receivers::gather(Layout::Image { width, height }, &vertices)
}

/// What the camera's pixel centres see of the posed shapes.
pub(crate) fn pixels<S: AsRef<Shape> + Sync>(
    camera: &Camera,
    world: &World,
    objects: &[Object],
    posed: &[S],
) -> Receivers {
    let (width, height) = (camera.width, camera.height);
    let ray = |index: usize| {
        let direction = camera.direction((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
        Ray { origin: camera.eye, direction, t_min: 0.0, t_max: f32::INFINITY }
    };
    let rays: Vec<Ray> = (0..width * height).map(ray).collect();
    let mut hits = vec![None; rays.len()];
    world.closest(&rays, &mut hits);
    let seen: Vec<_> = rays
        .par_iter()
        .zip(hits)
        .map(|(ray, hit): (&Ray, Option<Hit>)| {
            let hit = hit?;
            let object = hit.geometry as usize;
            Some(surface(ray, &hit, posed[object].as_ref(), &objects[object]))
        })
        .collect();
    Receivers::gather(Layout::Image { width, height }, &seen)
}

/// The surface at a hit, on the side that the ray comes from.
fn surface(ray: &Ray, hit: &Hit, shape: &Shape, look: &Object) -> Receiver {
    let (position, geometric_normal, normal, uv) = match shape {
        Shape::Mesh(mesh) => on_mesh(ray, hit, mesh),
        Shape::Heights(field) => on_mesh(ray, hit, field.mesh()),
        Shape::Spheres(spheres) => {
            let sphere = spheres[hit.primitive as usize];
            let outward = (ray.origin + ray.direction * hit.t - sphere.center).normalize();
            let normal = if outward.dot(ray.direction) > 0.0 { -outward } else { outward };
            (sphere.center + outward * sphere.radius, normal, normal, Vec2::ZERO)
        }
    };
    let place = Place { object: Some(hit.geometry), primitive: hit.primitive, barycentrics: hit.barycentrics, uv };
    Receiver { position, geometric_normal, normal, albedo: look.albedo_at(uv), place }
}

fn on_mesh(ray: &Ray, hit: &Hit, mesh: &Mesh) -> (Vec3, Vec3, Vec3, Vec2) {
    let indices = mesh.triangles[hit.primitive as usize].map(|i| i as usize);
    let [v, w] = hit.barycentrics;
    let weights = [1.0 - v - w, v, w];
    let blend = |values: &[Vec3]| (0..3).map(|corner| values[indices[corner]] * weights[corner]).sum::<Vec3>();
    let face = mesh.face_normal(hit.primitive as usize);
    let geometric_normal = if face.dot(ray.direction) > 0.0 { -face } else { face };
    let uv = mesh.uv(hit.primitive as usize, hit.barycentrics);
    // The corners' normals together say which side of the face they mean: files disagree with their winding.
    let meant: f32 = indices.iter().map(|i| mesh.normals[*i].dot(geometric_normal)).sum();
    let normal = above(blend(&mesh.normals) * meant.signum(), geometric_normal);
    (blend(&mesh.positions), geometric_normal, normal, uv)
}

/// The unit normal nearest to `normal` that does not point below the surface.
fn above(normal: Vec3, geometric_normal: Vec3) -> Vec3 {
    let height = normal.dot(geometric_normal);
    let raised = if height < 0.0 { normal - geometric_normal * height } else { normal };
    raised.try_normalize().unwrap_or(geometric_normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shading_normals_stay_above_the_surface() {
        let geometric_normal = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(above(Vec3::Z * 0.3, geometric_normal), Vec3::Z);
        assert_eq!(above(Vec3::ZERO, geometric_normal), geometric_normal);
        assert_eq!(above(-Vec3::Z, Vec3::Z), Vec3::Z);
        let raised = above(Vec3::new(-0.9, 0.0, 0.1), geometric_normal);
        assert!(raised.dot(geometric_normal).abs() < 1e-6 && raised.distance(Vec3::new(-0.8, 0.0, 0.6)) < 1e-6);
    }
}
