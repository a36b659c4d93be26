//! Spheres that follow a mesh which changes its shape: centres in mean value coordinates (Ju et al. 2005), radii as they are.

use glam::{DVec3, Vec3};
use halflight_contract::{Derived, Error, Flow, Job, Meter, Result};
use halflight_scenes::{Carried, Deformation, Mesh, Palette, Scene, Shape};
use rayon::prelude::*;

use crate::SpheresOf;

/// For each sphere of a set what carries its centre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Binding {
    spheres: Vec<Carrier>,
}

#[derive(Clone, Debug, PartialEq)]
enum Carrier {
    /// Vertices and weights, which sum to 1, and what is left of the centre at rest: rounding.
    Vertices { weights: Vec<(u32, f64)>, rest: Vec3 },
    /// The same sum by bones.
    Bones(Carried),
}

/// Angles and sines below this count as none.
const NONE: f64 = 1e-9;

impl Binding {
    /// Binds centres to a mesh at rest, and to its skeleton where the deformation has one.
    pub fn new(mesh: &Mesh, deformation: Option<&Deformation>, centers: &[Vec3]) -> Self {
        let carrier = |center: &Vec3| {
            let weights = weights(mesh, *center);
            match deformation.and_then(|deformation| deformation.gather(&weights)) {
                Some(carried) => Carrier::Bones(carried),
                None => Carrier::Vertices { rest: *center - sum(&weights, &mesh.positions), weights },
            }
        };
        Binding { spheres: centers.par_iter().map(carrier).collect() }
    }

    /// The centres when the mesh's vertices are at `positions` and its skeleton's bones as `palette` says.
    pub fn centers(&self, positions: &[Vec3], palette: Option<&Palette>) -> impl Iterator<Item = Vec3> {
        self.spheres.iter().map(move |carrier| match (carrier, palette) {
            (Carrier::Vertices { weights, rest }, _) => sum(weights, positions) + *rest,
            (Carrier::Bones(carried), Some(palette)) => carried.at(palette),
            (Carrier::Bones(_), None) => unreachable!("what is bound to bones has bones"),
        })
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let held = |carrier: &Carrier| match carrier {
            Carrier::Vertices { weights, .. } => size_of_val(weights.as_slice()),
            Carrier::Bones(carried) => carried.bytes(),
        };
        self.spheres.iter().map(|carrier| held(carrier) + size_of::<Carrier>()).sum()
    }
}

/// Vertices and weights, which sum to 1, whose sum is a centre.
fn weights(mesh: &Mesh, center: Vec3) -> Vec<(u32, f64)> {
    let mut weights = vec![0.0; mesh.positions.len()];
    if !mean_value_weights(mesh, center.as_dvec3(), &mut weights) {
        weights.fill(0.0);
        let distance = |vertex: &u32| mesh.positions[*vertex as usize].distance(center);
        let nearest = (0..mesh.positions.len() as u32).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        weights[nearest.unwrap_or(0) as usize] = 1.0;
    }
    let total: f64 = weights.iter().sum();
    let all = (0..).zip(weights).filter(|(_, weight)| *weight != 0.0);
    all.map(|(vertex, weight)| (vertex, weight / total)).collect()
}

fn sum(weights: &[(u32, f64)], positions: &[Vec3]) -> Vec3 {
    let term = |(vertex, weight): &(u32, f64)| positions[*vertex as usize].as_dvec3() * *weight;
    weights.iter().map(term).sum::<DVec3>().as_vec3()
}

/// Mean value coordinates of a point, not normalised (Ju et al. 2005, fig. 4); `false` if they do not tell where the point is,
/// as outside of open surfaces.
fn mean_value_weights(mesh: &Mesh, x: DVec3, weights: &mut [f64]) -> bool {
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| mesh.positions[i as usize].as_dvec3() - x);
        let distances = corners.map(DVec3::length);
        if let Some(at) = distances.iter().position(|distance| *distance < NONE) {
            weights.fill(0.0);
            weights[triangle[at] as usize] = 1.0;
            return true;
        }
        let units = [0, 1, 2].map(|i| corners[i] / distances[i]);
        let opposite = |i: usize| units[(i + 1) % 3].distance(units[(i + 2) % 3]);
        let angles = [0, 1, 2].map(|i| 2.0 * (0.5 * opposite(i)).min(1.0).asin());
        let half = 0.5 * angles.iter().sum::<f64>();
        if std::f64::consts::PI - half < NONE {
            // The point lies on the triangle, which alone carries it.
            weights.fill(0.0);
            for i in 0..3 {
                weights[triangle[i] as usize] = angles[i].sin() * distances[(i + 1) % 3] * distances[(i + 2) % 3];
            }
            return weights.iter().sum::<f64>() > 0.0;
        }
        for (vertex, weight) in triangle.iter().zip(of_triangle(&units, &distances, &angles, half).unwrap_or_default())
        {
            weights[*vertex as usize] += weight;
        }
    }
    let (total, largest) = weights.iter().fold((0.0, 0.0), |(sum, most): (f64, f64), w| (sum + w, most.max(w.abs())));
    // Negative outside, where what is nearer faces away.
    total.abs() > 1e-6 * largest && total.is_finite()
}

/// What a triangle adds to the weights of its corners; none if the point lies in its plane, beside it.
fn of_triangle(units: &[DVec3; 3], distances: &[f64; 3], angles: &[f64; 3], half: f64) -> Option<[f64; 3]> {
    let sines = angles.map(f64::sin);
    let side = units[0].cross(units[1]).dot(units[2]).signum();
    let cosine =
        |i: usize| 2.0 * half.sin() * (half - angles[i]).sin() / (sines[(i + 1) % 3] * sines[(i + 2) % 3]) - 1.0;
    let cosines = [cosine(0), cosine(1), cosine(2)];
    let dihedrals = cosines.map(|c| side * (1.0 - c * c).max(0.0).sqrt());
    if dihedrals.iter().any(|sine| sine.abs() < NONE || !sine.is_finite()) {
        return None;
    }
    Some([0, 1, 2].map(|i| {
        let (next, last) = ((i + 1) % 3, (i + 2) % 3);
        let numerator = angles[i] - cosines[next] * angles[last] - cosines[last] * angles[next];
        numerator / (distances[i] * sines[next] * dihedrals[last])
    }))
}

/// What binds the [`SpheresOf`] an object to its mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BindingOf(pub SpheresOf);

impl Derived for BindingOf {
    type Value = Binding;
    const NAME: &'static str = "sphere binding";
    const REVISION: &'static str = env!("HALFLIGHT_PROXIES_REVISION");

    fn key(&self, scene: &Scene) -> String {
        let object = scene.objects.get(self.0.object);
        let deformation = object.and_then(|object| object.deformation.as_ref());
        format!("{}-{}", self.0.key(scene), deformation.map_or(String::new(), |d| d.content().to_string()))
    }

    fn make(&self, job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Binding> {
        let set = job.derive(&self.0, meter)?;
        let object = &job.scene.objects[self.0.object];
        let Shape::Mesh(mesh) = &*object.shape else {
            return Err(Error::Input(format!("sphere binding of {}: expected a mesh", object.name)));
        };
        if meter.progress("sphere binding", 0, set.spheres.len() as u64) == Flow::Cancel {
            return Err(Error::Cancelled);
        }
        let deformation = object.deformation.as_deref();
        Ok(Binding::new(mesh, deformation, &set.spheres.iter().map(|sphere| sphere.center).collect::<Vec<_>>()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron() -> Mesh {
        let positions = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z].map(|p| p * 1.5).to_vec();
        let top = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
        let triangles = top.iter().flat_map(|[a, b, c]| [[*a, *b, *c], [*b, *a, 5]]).collect();
        Mesh {
            normals: positions.iter().map(|p: &Vec3| p.normalize()).collect(),
            positions,
            uvs: Vec::new(),
            triangles,
        }
    }

    const CENTERS: [Vec3; 5] = [
        Vec3::ZERO,
        Vec3::new(0.2, 0.3, -0.1),
        Vec3::new(0.5, 0.5, 0.5),  // on a face
        Vec3::new(1.5, 0.0, 0.0),  // a vertex
        Vec3::new(0.7, -0.9, 1.1), // outside
    ];

    #[test]
    fn centers_are_at_rest_with_the_mesh_and_follow_affine_maps() {
        let mesh = octahedron();
        let binding = Binding::new(&mesh, None, &CENTERS);
        let affine = |p: Vec3| {
            Vec3::new(1.3 * p.x + 0.2 * p.z, 0.7 * p.y - 0.4 * p.x, p.z + 0.3 * p.y) + Vec3::new(3.0, -1.0, 2.0)
        };
        let moved: Vec<Vec3> = mesh.positions.iter().map(|p| affine(*p)).collect();
        for (at_rest, center) in binding.centers(&mesh.positions, None).zip(CENTERS) {
            assert!(at_rest.distance(center) < 1e-6, "{at_rest} for {center}");
        }
        for (carried, center) in binding.centers(&moved, None).zip(CENTERS) {
            assert!(carried.distance(affine(center)) < 1e-5, "{carried} for {center}");
        }
    }

    #[test]
    fn a_corner_pulls_its_side_most() {
        let mesh = octahedron();
        let binding = Binding::new(&mesh, None, &[Vec3::X * 0.6, -Vec3::X * 0.6]);
        let mut moved = mesh.positions.clone();
        moved[0] += Vec3::X;
        let carried: Vec<f32> = binding.centers(&moved, None).zip([0.6, -0.6]).map(|(p, x)| p.x - x).collect();
        assert!(carried[0] > 3.0 * carried[1] && carried[1] > 0.0, "{carried:?}");
    }

    #[test]
    fn what_open_surfaces_do_not_hold_follows_the_nearest_vertex() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Mesh { normals: vec![Vec3::Z; 3], positions, uvs: Vec::new(), triangles: vec![[0, 1, 2]] };
        let binding = Binding::new(&mesh, None, &[Vec3::new(2.0, 0.0, 0.0)]);
        let moved = [Vec3::ZERO, Vec3::X + Vec3::Z, Vec3::Y];
        assert_eq!(binding.centers(&moved, None).next(), Some(Vec3::new(2.0, 0.0, 1.0)));
    }
}
