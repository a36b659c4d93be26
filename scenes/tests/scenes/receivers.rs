//! Receivers of every layout, at rest and in motion.

use glam::{Vec2, Vec3};
use halflight_scenes::{Layout, Receivers, Rgb, Scene, Shape, Which, read_points_csv};
use halflight_trace::Ray;

use crate::folder::Folder;

const CAMERA: &str = "[receivers]\ncamera = {}";

fn lengths_agree(receivers: &Receivers, facts: usize) {
    let Receivers { position, geometric_normal, normal, albedo, valid, place, .. } = receivers;
    let lengths = [geometric_normal.len(), normal.len(), albedo.len(), valid.len(), place.len(), receivers.len()];
    assert_eq!(lengths, [position.len(); 6]);
    assert_eq!(facts, position.len());
    for index in 0..position.len() {
        if valid[index] {
            assert!(position[index].is_finite());
            assert!((normal[index].length() - 1.0).abs() < 1e-5);
            assert!((geometric_normal[index].length() - 1.0).abs() < 1e-5);
            assert!(normal[index].dot(geometric_normal[index]) > -1e-5);
        } else {
            assert_eq!((position[index], normal[index], albedo[index]), (Vec3::ZERO, Vec3::ZERO, Rgb::ZERO));
        }
    }
}

fn seen_objects(scene: &Scene, frame: usize) -> Vec<Option<u32>> {
    scene.frame(frame).receivers.place.iter().map(|place| place.object).collect()
}

#[test]
fn the_camera_sees_every_object_where_it_is() {
    let scene = Folder::new().load_with(&[]).unwrap();
    let frame = scene.frame(0);
    let receivers = &frame.receivers;
    assert_eq!(receivers.layout, Layout::Image { width: 24, height: 16 });
    lengths_agree(receivers, scene.facts().receivers);
    let camera = scene.camera.unwrap();
    let mut count = [0; 3];
    for index in 0..receivers.len() {
        let Some(object) = receivers.place[index].object else {
            assert!(!receivers.valid[index]);
            continue;
        };
        count[object as usize] += 1;
        let (position, normal) = (receivers.position[index], receivers.geometric_normal[index]);
        let direction = camera.direction((index % 24) as f32 + 0.5, (index / 24) as f32 + 0.5);
        assert!((position - camera.eye).normalize().distance(direction) < 1e-5);
        assert!(normal.dot(direction) < 0.0, "normals face the camera");
        assert_eq!(receivers.albedo[index], scene.objects[object as usize].albedo);
        match object {
            0 => assert!(position.z.abs() < 1e-5 && normal == Vec3::Z && receivers.normal[index] == Vec3::Z),
            1 => assert!(((position - Vec3::new(-1.5, 0.0, 1.0)).abs().max_element() - 1.0).abs() < 1e-5),
            _ => {
                let outward = position - Vec3::new(1.5, 0.0, 1.0);
                assert!((outward.length() - 1.0).abs() < 1e-6 && normal.distance(outward) < 1e-5);
                assert_eq!(receivers.normal[index], normal);
            }
        }
    }
    assert!(count.iter().all(|count| *count > 10), "{count:?}");
    // The cube stands at −x, left in the picture; the sky above is no receiver.
    let column = |object| receivers.place.iter().position(|place| place.object == Some(object)).unwrap() % 24;
    assert!(column(1) < 12 && column(2) > 12 && !receivers.valid[0]);
}

#[test]
fn from_below_the_ground_faces_down() {
    let scene = Folder::new().load_with(&[("eye = [0.0, -8.0, 3.0]", "eye = [0.0, -8.0, -3.0]")]).unwrap();
    let receivers = scene.frame(0).receivers;
    let ground = receivers.place.iter().position(|place| place.object == Some(0)).unwrap();
    assert_eq!((receivers.geometric_normal[ground], receivers.normal[ground]), (-Vec3::Z, -Vec3::Z));
}

#[test]
fn normals_that_disagree_with_the_winding_still_face_the_camera() {
    // The ground as a square whose winding is clockwise from above, with and without normals that say "up".
    let folder = Folder::new();
    let obj = |corner: &str| {
        let corners = ["1", "4", "3", "2"].map(|i| format!("{i}{corner}")).join(" ");
        format!("v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nvn 0 0 1\nf {corners}\n")
    };
    for corner in ["", "//1"] {
        folder.write("ground.obj", obj(corner));
        let scene =
            folder.load_with(&[("plane = { size = [20.0, 20.0] }", r#"mesh = { file = "ground.obj" }"#)]).unwrap();
        let receivers = scene.frame(0).receivers;
        let ground = receivers.place.iter().position(|place| place.object == Some(0)).unwrap();
        assert_eq!((receivers.geometric_normal[ground], receivers.normal[ground]), (Vec3::Z, Vec3::Z), "{corner:?}");
    }
}

#[test]
fn from_inside_a_mesh_shading_normals_point_inwards() {
    let inside = [
        ("eye = [0.0, -8.0, 3.0]", "eye = [-1.5, 0.0, 1.0]"),
        ("target = [0.0, 0.0, 0.5]", "target = [0.0, 0.1, 1.2]"),
    ];
    let receivers = Folder::new().load_with(&inside).unwrap().frame(0).receivers;
    assert!(receivers.valid.iter().all(|valid| *valid));
    for (position, normal) in receivers.position.iter().zip(&receivers.normal) {
        // The corners' normals are their directions from the centre, and so is what lies between.
        let outward = (*position - Vec3::new(-1.5, 0.0, 1.0)).normalize();
        assert!(normal.distance(-outward) < 1e-5, "{normal} at {outward}");
    }
}

#[test]
fn mesh_vertices_are_receivers() {
    let folder = Folder::new();
    let scene = folder.load_with(&[(CAMERA, "[receivers]\nvertices = { object = \"cube\" }")]).unwrap();
    let receivers = scene.frame(0).receivers;
    assert_eq!((receivers.len(), receivers.layout), (8, Layout::List));
    lengths_agree(&receivers, scene.facts().receivers);
    for index in 0..8 {
        let outward = receivers.position[index] - Vec3::new(-1.5, 0.0, 1.0);
        assert!(receivers.normal[index].distance(outward.normalize()) < 1e-6);
        assert_eq!((receivers.place[index].object, receivers.place[index].primitive), (Some(1), index as u32));
        assert_eq!(receivers.albedo[index], Rgb::new(0.9, 0.2, 0.2));
    }
    folder.write("stray.off", "OFF\n4 1 0\n0 0 0\n5 5 5\n1 0 0\n0 1 0\n3 0 2 3\n");
    let stray = [(CAMERA, "[receivers]\nvertices = { object = \"cube\" }"), ("cube.ply", "stray.off")];
    let receivers = folder.load_with(&stray).unwrap().frame(0).receivers;
    assert_eq!(receivers.valid, [true, false, true, true]);
    lengths_agree(&receivers, 4);
}

#[test]
fn grids_are_cell_centres_seen_from_above() {
    let grid = "[receivers.grid]\ncenter = [1.0, 2.0, 0.5]\nsize = [4.0, 2.0]\nresolution = [4, 2]";
    let scene = Folder::new().load_with(&[(CAMERA, grid)]).unwrap();
    let receivers = scene.frame(0).receivers;
    assert_eq!(receivers.layout, Layout::Image { width: 4, height: 2 });
    lengths_agree(&receivers, scene.facts().receivers);
    let corners = [receivers.position[0], receivers.position[3], receivers.position[4]];
    assert_eq!(corners, [Vec3::new(-0.5, 2.5, 0.5), Vec3::new(2.5, 2.5, 0.5), Vec3::new(-0.5, 1.5, 0.5)]);
    assert!(receivers.normal.iter().all(|normal| *normal == Vec3::Z));
    assert!(receivers.albedo.iter().all(|albedo| *albedo == Rgb::ONE));
    assert_eq!(receivers.place[0].uv, Vec2::new(0.125, 0.25));
}

#[test]
fn grids_turn_with_their_normal_and_take_an_albedo() {
    let grid = "[receivers.grid]\ncenter = [0.0, 0.0, 1.0]\nsize = [2.0, 2.0]\nresolution = [2, 2]\n\
                normal = [0.0, -3.0, 0.0]\nobject = \"ground\"";
    let receivers = Folder::new().load_with(&[(CAMERA, grid)]).unwrap().frame(0).receivers;
    assert!(receivers.normal.iter().all(|normal| normal.distance(-Vec3::Y) < 1e-6));
    assert!(receivers.position[0].distance(Vec3::new(-0.5, 0.0, 1.5)) < 1e-6, "a wall stands upright");
    assert_eq!((receivers.albedo[0], receivers.place[0].object), (Rgb::splat(0.5), Some(0)));
}

#[test]
fn points_come_from_lines() {
    let folder = Folder::new();
    folder.write("p.csv", "x,y,z,nx,ny,nz\n1,2,3,0,0,2\n\n -1.5 , 0, 1e-3, 3, 0, 4\r\n");
    let points = read_points_csv(&folder.path("p.csv")).unwrap();
    assert_eq!(points[0], (Vec3::new(1.0, 2.0, 3.0), Vec3::Z));
    assert!(points[1].1.distance(Vec3::new(0.6, 0.0, 0.8)) < 1e-6);
    let scene = folder.load_with(&[(CAMERA, "[receivers]\npoints = { file = \"p.csv\" }")]).unwrap();
    let receivers = scene.frame(0).receivers;
    assert_eq!((receivers.len(), receivers.layout, receivers.albedo[1]), (2, Layout::List, Rgb::ONE));
    lengths_agree(&receivers, scene.facts().receivers);
}

const MOVING: &str = "motion = [{ time = 0.0 }, { time = 1.0, translate = [0.0, 0.0, 2.0] }]\n\
                      sphere = { center = [1.5, 0.0, 1.0], radius = 1.0 }";

fn moving(receivers: &str) -> Scene {
    let frames = format!("[frames]\ncount = 3\nfps = 2.0\n\n{receivers}");
    let sphere = "sphere = { center = [1.5, 0.0, 1.0], radius = 1.0 }";
    Folder::new().load_with(&[(CAMERA, &frames), (sphere, MOVING)]).unwrap()
}

#[test]
fn a_moving_sphere_is_traced_where_it_is() {
    let scene = moving(CAMERA);
    assert!(scene.facts().moving && scene.facts().frames == 3);
    for (index, height) in [1.0, 2.0, 3.0].into_iter().enumerate() {
        let frame = scene.frame(index);
        assert_eq!((frame.index, frame.time), (index, index as f32 / 2.0));
        let ray = Ray { origin: Vec3::new(1.5, 0.0, 9.0), direction: -Vec3::Z, t_min: 0.0, t_max: f32::INFINITY };
        let mut hit = [None];
        scene.world(&frame, Which::All).closest(&[ray], &mut hit);
        let hit = hit[0].unwrap();
        assert_eq!((hit.geometry, hit.t), (2, 9.0 - (height + 1.0)), "geometry indices are object indices");
        let receivers = &frame.receivers;
        for index in (0..receivers.len()).filter(|i| receivers.place[*i].object == Some(2)) {
            let outward = receivers.position[index] - Vec3::new(1.5, 0.0, height);
            assert!((outward.length() - 1.0).abs() < 1e-6);
        }
    }
    assert_ne!(seen_objects(&scene, 0), seen_objects(&scene, 2));
    assert_eq!(
        format!("{:?}", scene.bodies),
        "Bodies(2 and 0 that deform)",
        "what rests, and the sphere, for all frames"
    );
    let revisions = |frame: usize| scene.frame(frame).objects.iter().map(|object| object.revision).collect::<Vec<_>>();
    assert_eq!(revisions(0)[..2], revisions(2)[..2], "what rests keeps its revision");
    assert_ne!(revisions(0)[2], revisions(2)[2]);
    assert_ne!(scene.frame(0).receivers.revision, scene.frame(1).receivers.revision);
    assert_eq!(scene.frame(1).receivers.revision, scene.frame(1).receivers.revision);
}

#[test]
fn a_grid_on_an_object_moves_with_it() {
    let grid = "[receivers.grid]\ncenter = [1.5, 0.0, 2.0]\nsize = [1.0, 1.0]\nresolution = [1, 1]\nobject = \"ball\"";
    let scene = moving(grid);
    assert_eq!(scene.frame(2).receivers.position[0], Vec3::new(1.5, 0.0, 4.0));
}

#[test]
fn what_does_not_cast_is_not_among_the_casters() {
    let scene = Folder::new().load_with(&[]).unwrap();
    let frame = scene.frame(0);
    let down = |x| Ray { origin: Vec3::new(x, 0.0, 9.0), direction: -Vec3::Z, t_min: 0.0, t_max: f32::INFINITY };
    let rays = [down(-1.5), down(1.5), down(8.0)];
    let mut hits = [None; 3];
    scene.world(&frame, Which::Casters).closest(&rays, &mut hits);
    assert_eq!(hits.map(|hit| hit.map(|hit| hit.geometry)), [Some(1), Some(2), None]);
    scene.world(&frame, Which::All).closest(&rays, &mut hits);
    assert_eq!(hits.map(|hit| hit.map(|hit| hit.geometry)), [Some(1), Some(2), Some(0)]);
}

#[test]
fn random_spheres_stay_in_their_ranges_and_repeat() {
    let spheres = "random_spheres = { seed = 3, count = 500, low = [-1.0, -2.0, 0.5], high = [1.0, 2.0, 0.5], radius = [0.1, 0.4] }";
    let load = |text: &str| {
        let sphere = "sphere = { center = [1.5, 0.0, 1.0], radius = 1.0 }";
        let scene = Folder::new().load_with(&[(sphere, text)]).unwrap();
        let Shape::Spheres(spheres) = &*scene.objects[2].shape else { panic!() };
        spheres.clone()
    };
    let all = load(spheres);
    assert_eq!(all, load(spheres));
    assert_ne!(all, load(&spheres.replace("seed = 3", "seed = 4")));
    assert_eq!(all.len(), 500);
    assert!(all.iter().all(|s| s.center.x.abs() <= 1.0 && s.center.y.abs() <= 2.0 && s.center.z == 0.5));
    assert!(all.iter().all(|s| (0.1..=0.4).contains(&s.radius)));
    let mean = all.iter().map(|s| s.center.y).sum::<f32>() / 500.0;
    // Standard error 4/√(12·500) = 0.052.
    assert!(mean.abs() < 0.2, "{mean}");
}
