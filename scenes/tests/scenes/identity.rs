//! Content and revisions follow what decides the picture, and nothing else.

use glam::Vec3;
use halflight_scenes::{Content, Layout};

use crate::folder::{Folder, SCENE, cube_ply};

fn content(replacements: &[(&str, &str)]) -> Content {
    Folder::new().load_with(replacements).unwrap().content
}

#[test]
fn content_ignores_comments_names_and_places() {
    let base = content(&[]);
    assert_eq!(base, content(&[]), "another folder");
    let folder = Folder::new();
    assert_eq!(base, folder.load(&format!("# a comment\n{SCENE}\n\n# another\n")).unwrap().content);
    assert_eq!(base, content(&[("A cube and a sphere", "Other words")]));
    assert_eq!(base, content(&[("name = \"ball\"", "name = \"globe\"")]));
    assert_eq!(base, content(&[("casts = false", "casts = false\nscale = 1.0")]), "a default spelt out");
    folder.write("renamed.ply", cube_ply());
    assert_eq!(base, folder.load_with(&[("cube.ply", "renamed.ply")]).unwrap().content);
}

#[test]
fn content_follows_everything_that_decides_the_picture() {
    let changes = [
        ("eye = [0.0, -8.0, 3.0]", "eye = [0.0, -8.0, 3.1]"),
        ("fov = 40.0", "fov = 41.0"),
        ("width = 24", "width = 25"),
        ("[receivers]\ncamera = {}", "[receivers]\nvertices = { object = \"cube\" }"),
        (
            "[receivers]\ncamera = {}",
            "[receivers.grid]\ncenter = [0.0, 0.0, 0.0]\nsize = [1.0, 1.0]\nresolution = [2, 2]",
        ),
        ("albedo = [0.9, 0.2, 0.2]", "albedo = [0.9, 0.2, 0.3]"),
        ("casts = false", "casts = true"),
        ("casts = false", "casts = false\nemission = [0.1, 0.0, 0.0]"),
        ("translate = [-1.5, 0.0, 1.0]", "translate = [-1.5, 0.0, 1.01]"),
        ("radius = 1.0", "radius = 0.9"),
        ("radius = 1.0 }", "radius = 1.0 }\nmotion = [{ time = 0.0, translate = [0.0, 0.0, 1.0] }]"),
        ("uniform", "overcast"),
        ("angular_radius = 5.0", "angular_radius = 6.0"),
        ("10.0, 9.0, 8.0] }", "10.0, 9.0, 8.0] }\nturn = { degrees_a_second = 1.0 }"),
        ("purpose", "frames = { count = 2 }\npurpose"),
        ("purpose", "frames = { count = 1, fps = 30.0 }\npurpose"),
    ];
    let mut seen = vec![content(&[])];
    for change in changes {
        let changed = content(&[change]);
        assert!(!seen.contains(&changed), "{change:?} changes nothing");
        seen.push(changed);
    }
    let folder = Folder::new();
    folder.write("cube.ply", cube_ply().replacen("1 1 1", "1 1 1.5", 1));
    assert!(!seen.contains(&folder.load_with(&[]).unwrap().content), "the mesh decides too");
}

#[test]
fn explicit_receivers_make_another_scene_of_the_same_things() {
    let scene = Folder::new().load_with(&[]).unwrap();
    let points = [(Vec3::new(0.0, 0.0, 0.0), Vec3::Z), (Vec3::new(0.0, 3.0, 0.0), Vec3::X)];
    let probed = scene.with_receivers(&points);
    assert_ne!(probed.content, scene.content);
    assert_ne!(probed.content, scene.with_receivers(&points[..1]).content);
    let (frame, original) = (probed.frame(0), scene.frame(0));
    assert_eq!((frame.receivers.layout, frame.receivers.len(), probed.facts().receivers), (Layout::List, 2, 2));
    assert_eq!((frame.receivers.position[1], frame.receivers.normal[1]), points[1]);
    let revisions = |frame: &halflight_scenes::Frame| {
        let objects = frame.objects.iter().map(|object| object.revision);
        objects.chain(frame.lights.iter().map(|light| light.revision)).collect::<Vec<_>>()
    };
    assert_eq!(revisions(&frame), revisions(&original));
    assert_ne!(frame.receivers.revision, original.receivers.revision);
}
