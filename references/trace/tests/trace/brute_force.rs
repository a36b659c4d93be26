//! Every answer of the hierarchies against a loop over all primitives in `f64`.

use crate::oracle::{Random, soup, sphere_hits, triangle_hit};
use glam::Vec3;
use halflight_trace::{Geometry, Hit, Ray, Sphere, World};

struct Case {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    spheres: Vec<Sphere>,
    rays: Vec<Ray>,
}

impl Case {
    fn random(seed: u64, scale: f32) -> Self {
        let mut random = Random(seed);
        let (mut positions, triangles) = soup(&mut random, 300, 0.2);
        positions.iter_mut().for_each(|p| *p *= scale);
        let spheres =
            (0..40).map(|_| Sphere { center: random.point() * scale, radius: scale * (0.01 + 0.15 * random.unit()) });
        let spheres = spheres.collect();
        let rays = (0..3000).map(|_| {
            let t_min = if random.unit() < 0.5 { 0.0 } else { 0.5 * random.unit() * scale };
            let t_max = if random.unit() < 0.5 { f32::INFINITY } else { t_min + random.unit() * scale };
            Ray { origin: random.point() * 1.5 * scale, direction: random.direction(), t_min, t_max }
        });
        Case { rays: rays.collect(), positions, triangles, spheres }
    }

    fn world(&self) -> World {
        World::build(&[
            Geometry::Triangles { positions: &self.positions, triangles: &self.triangles },
            Geometry::Spheres(&self.spheres),
        ])
    }

    /// All hits in the segment as (distance, geometry, primitive), nearest first; `None` where one of them is so
    /// near an edge, a silhouette or an end that rounding may decide.
    fn truth(&self, ray: &Ray) -> Option<Vec<(f64, u32, u32)>> {
        const MARGIN: f64 = 1e-4;
        let (low, high) = (f64::from(ray.t_min), f64::from(ray.t_max));
        let near = |a: f64, b: f64| (a - b).abs() < MARGIN * (a.abs() + b.abs());
        let mut hits = Vec::new();
        for (index, corners) in (0..).zip(&self.triangles) {
            let Some((t, inside)) = triangle_hit(ray, corners.map(|i| self.positions[i as usize])) else { continue };
            if inside.abs() < MARGIN || near(t, low) || near(t, high) {
                return None;
            }
            if inside > 0.0 && t > low && t < high {
                hits.push((t, 0, index));
            }
        }
        for (index, sphere) in (0..).zip(&self.spheres) {
            let (roots, depth) = sphere_hits(ray, sphere);
            if depth.abs() < MARGIN || roots.iter().any(|t| near(*t, low) || near(*t, high)) {
                return None;
            }
            let inside = roots.into_iter().filter(|t| depth > 0.0 && *t > low && *t < high);
            hits.extend(inside.map(|t| (t, 1, index)));
        }
        hits.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(hits)
    }

    fn check(&self) {
        let world = self.world();
        let mut hits = vec![None; self.rays.len()];
        world.closest(&self.rays, &mut hits);
        let mut blocked = vec![false; self.rays.len()];
        world.occluded(&self.rays, &mut blocked);
        let mut decided = 0;
        for ((ray, hit), blocked) in self.rays.iter().zip(&hits).zip(&blocked) {
            let Some(truth) = self.truth(ray) else { continue };
            decided += 1;
            assert_eq!(*blocked, !truth.is_empty(), "{ray:?}");
            match (truth.first(), hit) {
                (None, None) => {}
                (Some(&(t, geometry, primitive)), Some(hit)) => {
                    assert_eq!((hit.geometry, hit.primitive), (geometry, primitive), "{ray:?}");
                    assert!(
                        (f64::from(hit.t) - t).abs() <= 1e-5 * t.max(ray.origin.length().into()),
                        "{ray:?} {hit:?} {t}"
                    );
                    self.check_barycentrics(ray, hit);
                }
                other => panic!("{ray:?}: {other:?}"),
            }
        }
        assert!(decided > self.rays.len() * 9 / 10, "only {decided} of {} rays are decided", self.rays.len());
    }

    fn check_barycentrics(&self, ray: &Ray, hit: &Hit) {
        if hit.geometry == 0 {
            let [a, b, c] = self.triangles[hit.primitive as usize].map(|i| self.positions[i as usize]);
            let [v, w] = hit.barycentrics;
            let on_triangle = a * (1.0 - v - w) + b * v + c * w;
            let on_ray = ray.origin + ray.direction * hit.t;
            assert!(on_triangle.distance(on_ray) < 1e-5 * (on_ray.length() + hit.t), "{ray:?} {hit:?}");
        }
    }
}

#[test]
fn agrees_with_a_loop_over_everything() {
    Case::random(1, 1.0).check();
}

#[test]
fn agrees_at_every_scale() {
    for scale in [1e-12, 1e-4, 1e4, 1e9] {
        Case::random(2, scale).check();
    }
}

#[test]
fn one_and_many_threads_give_the_same_bits() {
    let case = Case::random(3, 1.0);
    let world = case.world();
    let answers = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut hits = vec![None; case.rays.len()];
        let mut blocked = vec![false; case.rays.len()];
        pool.install(|| {
            world.closest(&case.rays, &mut hits);
            world.occluded(&case.rays, &mut blocked);
        });
        (hits, blocked)
    };
    assert_eq!(answers(1), answers(2));
}

#[test]
fn a_bundle_equals_its_rays() {
    let case = Case::random(4, 1.0);
    let origin = Vec3::new(0.1, -0.2, 0.05);
    let rays: Vec<Ray> = case.rays.iter().map(|ray| Ray { origin, t_min: 0.1, t_max: f32::INFINITY, ..*ray }).collect();
    let directions: Vec<Vec3> = rays.iter().map(|ray| ray.direction).collect();
    let (mut alone, mut bundled) = (vec![false; rays.len()], vec![false; rays.len()]);
    case.world().occluded(&rays, &mut alone);
    case.world().occluded_from(origin, 0.1, &directions, &mut bundled);
    assert!(alone.contains(&true) && alone.contains(&false));
    assert_eq!(alone, bundled);
}
