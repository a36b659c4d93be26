//! Sphere sets as derived data of a scene, and as the blockers of its frames.

#[allow(dead_code, reason = "shared with the other tests")]
mod shapes;

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use halflight_contract::{Backend, Cache, Derived, Error, Flow, Job, Meter, NoMeter, Params};
use halflight_proxies::{Binding, MAX_COUNT, Proxy, SphereSet, SpheresOf, blockers, proxies};
use halflight_scenes::{Bodies, HeightField, Mesh, Object, Placement, Pose, Rgb, Scene, Shape, Sphere};
use shapes::{icosphere, square, torus};

const COUNT: usize = 6;

fn object(name: &str, shape: Shape, casts: bool) -> Object {
    let content = shape.content();
    Object {
        name: name.to_string(),
        shape: Arc::new(shape),
        content,
        albedo: Rgb::ONE,
        texture: None,
        emission: halflight_scenes::Emission::NONE,
        casts,
        motion: Vec::new(),
        pivot: Vec3::ZERO,
        deformation: None,
    }
}

/// A torus that moves, a ground that only receives, and two exact spheres.
fn scene() -> Scene {
    let far = Pose { rotation: Quat::from_rotation_z(0.5), translation: Vec3::new(1.0, 2.0, 3.0) };
    let spheres = vec![Sphere { center: Vec3::X, radius: 0.5 }, Sphere { center: Vec3::Y, radius: 0.25 }];
    let mut torus = object("torus", Shape::Mesh(torus(1.0, 0.3)), true);
    torus.motion = vec![(0.0, Pose::IDENTITY), (1.0, far)];
    let ground = object("ground", Shape::Mesh(square()), false);
    Scene {
        name: "test".to_string(),
        purpose: String::new(),
        content: torus.content,
        objects: vec![torus, ground, object("spheres", Shape::Spheres(spheres), true)],
        lights: Vec::new(),
        camera: None,
        placement: Placement::Points(Arc::new(vec![(Vec3::ZERO, Vec3::Z)])),
        frame_count: 2,
        fps: 1.0,
        notices: Vec::new(),
        bodies: Bodies::default(),
    }
}

fn derive(scene: &Scene, cache: &Cache, meter: &mut dyn Meter) -> Result<Vec<Option<Proxy>>, Error> {
    let params = Params::default();
    proxies(&Job::new(scene, &params, 1, Backend::Cpu, cache), COUNT, meter)
}

/// Counts progress and cancels at a step.
#[derive(Default)]
struct Watch {
    steps: usize,
    limit: Option<usize>,
}

impl Meter for Watch {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        self.steps += 1;
        if self.limit.is_some_and(|limit| self.steps > limit) { Flow::Cancel } else { Flow::Continue }
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

#[test]
fn casting_objects_have_sets_and_exact_spheres_are_their_own() {
    let sets = derive(&scene(), &Cache::in_memory(), &mut NoMeter).expect("nothing cancels");
    assert_eq!(sets.len(), 3);
    assert!(sets[0].as_ref().is_some_and(|proxy| (1..=COUNT).contains(&proxy.set.spheres.len())));
    assert!(sets[1].is_none());
    let exact = &sets[2].as_ref().expect("spheres cast").set;
    assert_eq!((exact.spheres.len(), exact.spheres[0].radius, exact.outside_volume), (2, 0.5, 0.0));
}

#[test]
fn blockers_follow_the_pose() {
    let scene = scene();
    let sets = derive(&scene, &Cache::in_memory(), &mut NoMeter).expect("nothing cancels");
    let (rest, moved) = (blockers(&scene, &scene.frame(0), &sets), blockers(&scene, &scene.frame(1), &sets));
    let torus = sets[0].as_ref().expect("the torus casts").set.spheres.len();
    assert_eq!(rest.object, [vec![0; torus], vec![2; 2]].concat());
    assert_eq!(rest.object, moved.object);
    for (i, (before, after)) in rest.spheres.iter().zip(&moved.spheres).enumerate() {
        let turned = Quat::from_rotation_z(0.5) * before.center + Vec3::new(1.0, 2.0, 3.0);
        let expected = if i < torus { turned } else { before.center };
        assert!(after.center.distance(expected) < 1e-5 && after.radius == before.radius, "{i}");
    }
    let none = blockers(&scene, &scene.frame(0), &[]);
    assert!(none.spheres.is_empty() && none.object.is_empty());
}

#[test]
fn an_object_that_stops_casting_contributes_nothing() {
    let mut scene = scene();
    let sets = derive(&scene, &Cache::in_memory(), &mut NoMeter).expect("nothing cancels");
    scene.objects[0].casts = false;
    assert_eq!(blockers(&scene, &scene.frame(0), &sets).object, [2, 2]);
}

#[test]
fn the_disk_gives_the_same_bits_without_a_new_search() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = derive(&scene(), &Cache::in_folder(folder.path()), &mut NoMeter).expect("nothing cancels");
    let mut watch = Watch::default();
    let read = derive(&scene(), &Cache::in_folder(folder.path()), &mut watch).expect("nothing cancels");
    assert_eq!((made, 0), (read, watch.steps));
}

#[test]
fn keys_tell_content_and_count_apart() {
    let mut scene = scene();
    let key = |scene: &Scene, object, count| SpheresOf { object, count }.key(scene);
    let before = key(&scene, 0, 6);
    assert_ne!(before, key(&scene, 0, 7));
    assert_ne!(before, key(&scene, 1, 6));
    scene.name = "another".to_string();
    scene.objects[0].name = "renamed".to_string();
    assert_eq!(before, key(&scene, 0, 6));
}

#[test]
fn damaged_bytes_are_refused() {
    let codec = SpheresOf { object: 0, count: 1 }.codec().expect("sets are kept");
    let spheres =
        vec![Sphere { center: Vec3::new(1.0, -2.0, 3.5), radius: 0.75 }, Sphere { center: Vec3::X, radius: 2.0 }];
    let set = SphereSet { spheres, outside_volume: 0.4 };
    let bytes = (codec.encode)(&set);
    assert_eq!((codec.decode)(&bytes), Some(set));
    assert_eq!((codec.decode)(&(codec.encode)(&SphereSet::default())), Some(SphereSet::default()));
    for end in 0..bytes.len() {
        let whole = end >= 12 && (end - 12) % 16 == 0;
        assert_eq!((codec.decode)(&bytes[..end]).is_some(), whole, "cut at {end}");
    }
    let with = |at: usize, float: f32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&float.to_le_bytes());
        (codec.decode)(&bytes)
    };
    for float in [f32::NAN, f32::INFINITY, -1.0] {
        assert_eq!((with(8, float), with(24, float)), (None, None), "{float}");
    }
    assert_eq!((with(0, 1.0), with(12, f32::NAN)), (None, None));
    assert!(with(24, 0.0).is_some(), "exact spheres may be points");
}

#[test]
fn cancelling_is_an_error_and_keeps_nothing() {
    let cache = Cache::in_memory();
    let cancelled = derive(&scene(), &cache, &mut Watch { limit: Some(5), ..Watch::default() });
    assert!(matches!(cancelled, Err(Error::Cancelled)));
    assert!(derive(&scene(), &cache, &mut NoMeter).is_ok());
}

#[test]
fn impossible_recipes_say_what_they_expected() {
    let (scene, params, cache) = (scene(), Params::default(), Cache::in_memory());
    let job = Job::new(&scene, &params, 1, Backend::Cpu, &cache);
    for (object, count, expected) in
        [(3, 6, "has 3 objects"), (0, 0, "sphere set of torus: expected 1 to 1024"), (0, MAX_COUNT + 1, "found 1025")]
    {
        let error = job.derive(&SpheresOf { object, count }, &mut NoMeter).expect_err("not possible").to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_height_field_has_none() {
    let mut scene = scene();
    let field = HeightField::new([2, 2], Vec2::ZERO, Vec2::ONE, vec![0.0; 4]);
    scene.objects[0].shape = Arc::new(Shape::Heights(field));
    scene.objects[0].content = scene.objects[0].shape.content();
    assert!(derive(&scene, &Cache::in_memory(), &mut NoMeter).is_ok_and(|sets| sets[0].is_none() && sets[2].is_some()));

    let params = Params::defaults(&[]);
    let cache = Cache::in_memory();
    let job = Job::new(&scene, &params, 1, Backend::Cpu, &cache);
    let set = job.derive(&SpheresOf { object: 0, count: 1 }, &mut NoMeter);
    let error = set.expect_err("an open surface").to_string();
    assert!(error.contains("sphere set of torus: expected a mesh or spheres, found a height field"), "{error}");
}

#[test]
fn a_mesh_without_triangles_has_a_set() {
    let mut scene = scene();
    scene.objects[0].shape = Arc::new(Shape::Mesh(Mesh { positions: icosphere(0).positions, ..Mesh::default() }));
    scene.objects[0].content = scene.objects[0].shape.content();
    assert!(derive(&scene, &Cache::in_memory(), &mut NoMeter).is_ok_and(|sets| sets[0].is_some()));
}

#[test]
fn spheres_bound_to_bones_are_where_the_vertices_would_carry_them() {
    let scene = halflight_scenes::find("walker").expect("a shipped scene");
    let (object, rest) = (&scene.objects[1], &scene.frame(0));
    let Shape::Mesh(mesh) = &*object.shape else { panic!("a mesh") };
    let centers: Vec<Vec3> = mesh.positions.iter().step_by(1999).map(|p| *p - Vec3::new(0.0, 0.0, 0.02)).collect();
    let deformation = object.deformation.as_deref().expect("it walks");
    let (by_bones, by_vertices) = (Binding::new(mesh, Some(deformation), &centers), Binding::new(mesh, None, &centers));
    assert!(by_bones.bytes() < by_vertices.bytes() / 20, "{} of {}", by_bones.bytes(), by_vertices.bytes());
    let mut farthest = 0f32;
    for frame in [0, 17, 59].map(|index| scene.frame(index)) {
        let Shape::Mesh(posed) = &*frame.objects[1].shape else { panic!("a mesh") };
        let palette = deformation.palette(frame.time);
        let pairs = by_bones.centers(&[], palette.as_ref()).zip(by_vertices.centers(&posed.positions, None));
        farthest = pairs.map(|(a, b)| a.distance(b)).fold(farthest, f32::max);
    }
    assert!(farthest < 1e-4, "{farthest}");
    assert!(scene.frame(59).objects[1].content != rest.objects[1].content);
}
