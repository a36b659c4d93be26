//! By how much posed meshes leave their spheres.

use std::sync::Arc;

use glam::Vec3;
use halflight_contract::{Backend, Cache, Job, NoMeter, Params};
use halflight_proxies::{Excess, Proxy, SphereSet, proxies};
use halflight_scenes::{Mesh, Scene, Shape, Sphere};

const COUNT: usize = 32;

/// Excess of every deforming object over a scene's frames `steps` apart.
fn over(scene: &Scene, steps: usize) -> Vec<(usize, &str, Excess)> {
    let (params, cache) = (Params::default(), Cache::in_memory());
    let proxies = proxies(&Job::new(scene, &params, 1, Backend::Cpu, &cache), COUNT, &mut NoMeter).expect("sets");
    let mut found = Vec::new();
    for frame in (0..scene.frame_count).step_by(steps).map(|index| scene.frame(index)) {
        for posed in &frame.objects {
            let object = &scene.objects[posed.object];
            if let Some(proxy) = proxies[posed.object].as_ref().filter(|_| object.deformation.is_some()) {
                found.push((frame.index, object.name.as_str(), proxy.excess(object, posed, frame.time)));
            }
        }
    }
    found
}

/// The deformers of the scene are at rest in its first frame.
#[test]
fn at_rest_nothing_leaves_and_later_finitely_little_does() {
    let scene = halflight_scenes::find("deformers").expect("a shipped scene");
    let found = over(&scene, 15);
    assert!(found.iter().filter(|(frame, ..)| *frame == 0).all(|(.., excess)| *excess == Excess::default()));
    for (frame, name, excess) in &found {
        assert!((0.0..=1.0).contains(&excess.outside), "{name} in {frame}: {excess:?}");
        assert!((0.0..0.5).contains(&excess.relative) && excess.farthest.is_finite(), "{name} in {frame}: {excess:?}");
        assert_eq!(excess.outside > 0.0, excess.farthest > 0.0);
    }
    let flyer = found.iter().filter(|(frame, name, _)| *frame > 0 && *name == "flyer");
    assert!(flyer.map(|(.., excess)| excess.outside).fold(0.0, f32::max) > 0.0, "{found:?}");
}

/// Of a rod of three vertices, spheres hold the middle and the end that does not move away.
#[test]
fn what_sticks_out_is_told_in_vertices_metres_and_sizes() {
    let mut scene = halflight_scenes::find("deformers").expect("a shipped scene");
    let mut posed = scene.frame(0).objects[1].clone();
    let object = &mut scene.objects[posed.object];
    object.deformation = None;
    let rod = |end: f32| {
        Arc::new(Shape::Mesh(Mesh { positions: vec![Vec3::ZERO, Vec3::X, end * Vec3::X, Vec3::X], ..Mesh::default() }))
    };
    (object.shape, posed.shape) = (rod(2.0), rod(2.75));
    let spheres = vec![Sphere { center: 0.5 * Vec3::X, radius: 0.5 }, Sphere { center: 1.5 * Vec3::X, radius: 0.5 }];
    let proxy = Proxy { set: Arc::new(SphereSet { spheres, outside_volume: 0.0 }), binding: None };
    assert_eq!(proxy.excess(object, &posed, 0.0), Excess { outside: 0.25, farthest: 0.75, relative: 0.375 });
    posed.shape = rod(2.0);
    assert_eq!(proxy.excess(object, &posed, 0.0), Excess::default());
    posed.shape = Arc::new(Shape::Spheres(Vec::new()));
    assert_eq!(proxy.excess(object, &posed, 0.0), Excess::default());
}
