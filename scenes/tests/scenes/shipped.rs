//! The shipped scenes load, are what their names say, and find themselves.

use glam::Vec3;
use halflight_scenes::{Scene, Shape, Which, find, shipped};
use halflight_trace::{Hit, Ray};

fn load(name: &str) -> Scene {
    find(name).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn all_load_with_purpose_and_valid_receivers() {
    let names: Vec<String> = shipped().into_iter().map(|(name, ..)| name).collect();
    let expected = [
        "battle",
        "boxers",
        "bunny-studio",
        "cone",
        "deformers",
        "dino-elephant-courtyard",
        "fractal-1024",
        "fractal-1024-key",
        "fractal-256",
        "fractal-256-key",
        "fractal-512",
        "fractal-512-key",
        "fractal-512-sky",
        "furnace",
        "growing",
        "herd",
        "hovering",
        "interior",
        "jacksboro-sunrise",
        "lamp",
        "ripples",
        "room",
        "sphere-plane",
        "spheres-60",
        "stage",
        "teapot-sunset",
        "trench",
        "walker",
        "waves",
    ];
    assert_eq!(names, expected);
    for (name, path, purpose) in shipped() {
        let scene = load(&name);
        assert_eq!((&scene.name, &scene.purpose), (&name, &purpose));
        assert_eq!(scene.content, find(path.to_str().unwrap()).unwrap().content);
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        let receivers = scene.frame(0).receivers;
        let valid = receivers.valid.iter().filter(|valid| **valid).count();
        assert!(valid >= 2000 && valid * 10 > receivers.len() * 6, "{name}: {valid} of {}", receivers.len());
    }
}

#[test]
fn every_asset_has_its_hash() {
    for (name, path, _) in shipped() {
        let text = std::fs::read_to_string(path).unwrap();
        let (files, hashes) = (text.matches("file = ").count(), text.matches("sha256 = ").count());
        assert_eq!(files, hashes, "{name}");
    }
}

#[test]
fn models_stand_on_their_ground_a_metre_tall() {
    for name in ["bunny-studio", "dino-elephant-courtyard", "interior", "teapot-sunset"] {
        for object in load(name).objects.iter().filter(|object| object.casts) {
            let Shape::Mesh(mesh) = &*object.shape else { panic!("{name}") };
            let heights = mesh.positions.iter().map(|p| p.z);
            let (low, high) = heights.fold((f32::MAX, f32::MIN), |(low, high), z| (low.min(z), high.max(z)));
            assert!((-1e-3..=0.0).contains(&low), "{name}: {} begins at {low}", object.name);
            assert!((0.7..=1.3).contains(&high), "{name}: {} ends at {high}", object.name);
        }
    }
}

/// From points inside a closed room, every ray meets a front.
#[test]
fn walls_face_inwards_and_leave_no_gap() {
    for (name, inside, open) in [("furnace", Vec3::new(0.1, 0.2, 0.3), None), ("room", Vec3::Z, Some(-Vec3::Y))] {
        let scene = load(name);
        let world = scene.world(&scene.frame(0), Which::Casters);
        let walls = |hit: &Hit| {
            let Shape::Mesh(mesh) = &*scene.objects[hit.geometry as usize].shape else { return None };
            Some(mesh.face_normal(hit.primitive as usize))
        };
        for i in 0..10_000 {
            // A spiral of evenly spread directions.
            let (z, turn) = (1.0 - (i as f32 + 0.5) / 5000.0, 2.399_963_2 * i as f32);
            let direction = Vec3::new(turn.cos(), turn.sin(), 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z;
            if open.is_some_and(|open: Vec3| open.dot(direction) > 0.0) {
                continue;
            }
            let ray = Ray { origin: inside, direction, t_min: 0.0, t_max: f32::INFINITY };
            let mut hit = [None];
            world.closest(&[ray], &mut hit);
            let hit = hit[0].unwrap_or_else(|| panic!("{name}: a gap towards {direction}"));
            assert!(walls(&hit).is_none_or(|normal| normal.dot(direction) < 0.0), "{name}: a back towards {direction}");
        }
    }
}

#[test]
fn receivers_of_the_oracle_lie_outside_its_sphere_and_see_it_clipped() {
    let scene = load("sphere-plane");
    let Shape::Spheres(spheres) = &*scene.objects[0].shape else { panic!() };
    let (sphere, receivers) = (spheres[0], scene.frame(0).receivers);
    assert!(receivers.len() >= 2000);
    for (position, normal) in receivers.position.iter().zip(&receivers.normal) {
        let towards = sphere.center - *position;
        assert!(towards.length() > sphere.radius * 1.02);
        assert!(towards.dot(*normal) > 0.0 && towards.dot(*normal) < sphere.radius, "its horizon cuts the sphere");
        assert!(sphere.radius / towards.length() > 0.3);
    }
}

#[test]
fn spheres_overlap_and_lie_above_the_ground() {
    let scene = load("spheres-60");
    let Shape::Spheres(spheres) = &*scene.objects[1].shape else { panic!() };
    assert_eq!(spheres.len(), 60);
    assert!(spheres.iter().all(|sphere| sphere.center.z > sphere.radius));
    let touching = |i: usize| {
        spheres
            .iter()
            .enumerate()
            .any(|(j, other)| i != j && spheres[i].center.distance(other.center) < spheres[i].radius + other.radius)
    };
    assert!((0..60).filter(|i| touching(*i)).count() > 30);
}

#[test]
fn characters_walk_on_their_ground_and_keep_their_size() {
    for (name, figures) in [("walker", 1), ("boxers", 2), ("battle", 4)] {
        let scene = load(name);
        for frame in [0, scene.frame_count / 2, scene.frame_count - 1].map(|index| scene.frame(index)) {
            for posed in frame.objects.iter().filter(|posed| scene.objects[posed.object].deformation.is_some()) {
                let shape = posed.in_place();
                let Shape::Mesh(mesh) = &*shape else { panic!("{name}") };
                let (low, high) =
                    mesh.positions.iter().fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p.z), high.max(p.z)));
                assert!((-0.1..=0.1).contains(&low), "{name} at {} s: from {low}", frame.time);
                assert!((1.2..=2.0).contains(&high), "{name} at {} s: to {high}", frame.time);
            }
        }
        assert_eq!(scene.facts().deforming, figures);
    }
}

#[test]
fn unknown_names_are_told_the_known_ones() {
    let error = find("bunny-studios").unwrap_err().to_string();
    assert!(error.contains("bunny-studios") && error.contains("boxers, bunny-studio, cone"), "{error}");
    let error = find("missing/scene.toml").unwrap_err().to_string();
    assert!(error.starts_with("missing/scene.toml: expected a readable file"), "{error}");
}
