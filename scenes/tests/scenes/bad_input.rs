//! Whatever is wrong with a scene gives one line that names file, field and what was expected.

use halflight_scenes::{Scene, read_points_csv};

use crate::folder::{Folder, SCENE, cube_ply, with};

/// The line for a scene; `named` is the file that it must begin with.
fn complaint(folder: &Folder, text: &str, named: &str) -> String {
    let error = folder.load(text).expect_err("must be refused").to_string();
    assert!(!error.contains('\n'), "{error}");
    let place = folder.path(named).display().to_string();
    assert!(error.starts_with(&place), "{error} does not begin with {place}");
    error
}

fn check(replacements: &[(&str, &str)], field: &str, expected: &str) {
    let error = complaint(&Folder::new(), &with(replacements), "scene.toml");
    assert!(error.contains(field) && error.contains(expected), "for {field}, {expected}: {error}");
}

#[test]
fn paths_that_lead_out_of_the_folder() {
    let outside = Folder::new();
    let absolute = outside.path("cube.ply").display().to_string();
    for path in ["../cube.ply", "./../cube.ply", "models/../../cube.ply", "", &absolute] {
        check(&[("cube.ply", path)], "objects[1].mesh.file", "a path inside the scene's folder, without `..`");
    }
    let folder = Folder::new();
    std::fs::remove_file(folder.path("cube.ply")).unwrap();
    std::os::unix::fs::symlink(outside.path("cube.ply"), folder.path("cube.ply")).unwrap();
    let error = complaint(&folder, SCENE, "scene.toml");
    assert!(error.contains("objects[1].mesh.file: expected a path inside"), "{error}");
    assert!(Folder::new().load(&with(&[("cube.ply", "./cube.ply")])).is_ok());
}

#[test]
fn more_receivers_than_memory_would_hold() {
    let grid = |side| format!("grid = {{ center = [0, 0, 0], size = [1, 1], resolution = [{side}, {side}] }}");
    check(&[("camera = {}", &grid(16384))], "receivers: ", "at most 33554432 over all frames");
    let frames = |count| format!("[frames]\ncount = {count}\n[[objects]]\nname = \"ground\"");
    let ground = "[[objects]]\nname = \"ground\"";
    check(&[("camera = {}", &grid(64)), (ground, &frames(8193))], "receivers: ", "over all frames");
    Folder::new().load(&with(&[("camera = {}", &grid(64)), (ground, &frames(8192))])).expect("just within");
}

#[test]
fn values_out_of_range() {
    const BALL: &str = "sphere = { center = [1.5, 0.0, 1.0], radius = 1.0 }";
    let cases = [
        ("radius = 1.0", "radius = -1.0", "objects[2].sphere.radius: ", "expected a positive"),
        ("radius = 1.0", "radius = 0", "objects[2].sphere.radius: ", "expected a positive"),
        ("center = [1.5,", "center = [nan,", "objects[2].sphere.center: ", "finite"),
        ("size = [20.0, 20.0]", "size = [20.0, inf]", "objects[0].plane.size: ", "positive finite"),
        ("translate = [-1.5, 0.0, 1.0]", "translate = [-1.5, 0.0, nan]", "objects[1].translate: ", "finite"),
        ("translate = [-1.5, 0.0, 1.0]", "scale = 0.0", "objects[1].scale: ", "positive"),
        ("translate = [-1.5, 0.0, 1.0]", "scale = nan", "objects[1].scale: ", "positive"),
        ("translate = [-1.5, 0.0, 1.0]", "scale = -1.0", "objects[1].scale: ", "positive"),
        ("translate = [-1.5, 0.0, 1.0]", "scale = 1e9\ntranslate = [1e9, 0.0, 0.0]", "objects[1]: ", "at most 1e9"),
        ("translate = [-1.5, 0.0, 1.0]", "scale = 1e-3\ntranslate = [1e8, 1e8, 1e8]", "objects[1]: ", "loses its area"),
        ("translate = [-1.5, 0.0, 1.0]", "scale = 1e-44", "objects[1].scale: ", "of at least 1e-9"),
        (
            "translate = [-1.5, 0.0, 1.0]",
            "rotate = { axis = [0.0, 0.0, 0.0], degrees = 1.0 }",
            "objects[1].rotate.axis: ",
            "not zero",
        ),
        ("albedo = [0.9, 0.2, 0.2]", "albedo = [1.1, 0.2, 0.2]", "objects[1].albedo: ", "[0, 1]"),
        ("albedo = [0.9, 0.2, 0.2]", "albedo = [nan, 0.2, 0.2]", "objects[1].albedo: ", "[0, 1]"),
        ("name = \"ball\"", "name = \"cube\"", "objects[2].name: ", "no other object"),
        ("name = \"ball\"", "name = \"\"", "objects[2].name: ", "expected a name"),
        (
            BALL,
            "",
            "objects[2]: ",
            "exactly one of mesh, sphere, random_spheres, plane, heights, ball, block, cylinder, blob, character, gltf, found []",
        ),
        (
            BALL,
            "sphere = { center = [1.5, 0.0, 1.0], radius = 1.0 }\nplane = { size = [1.0, 1.0] }",
            "objects[2]: ",
            "exactly one of",
        ),
        (
            BALL,
            "random_spheres = { seed = 1, count = 0, low = [0.0, 0.0, 0.0], high = [1.0, 1.0, 1.0], radius = [0.1, 0.2] }",
            "objects[2].random_spheres.count: ",
            "1..=",
        ),
        (
            BALL,
            "random_spheres = { seed = 1, count = 1, low = [0.0, 2.0, 0.0], high = [1.0, 1.0, 1.0], radius = [0.1, 0.2] }",
            "objects[2].random_spheres.high: ",
            "not below",
        ),
        (
            BALL,
            "random_spheres = { seed = 1, count = 1, low = [0.0, 0.0, 0.0], high = [1.0, 1.0, 1.0], radius = [0.3, 0.2] }",
            "objects[2].random_spheres.radius: ",
            "not smaller",
        ),
        ("uniform = [1.0,", "uniform = [-1.0,", "lights[0].sky.uniform: ", "from 0 to 1e9"),
        ("uniform = [1.0,", "overcast = [inf,", "lights[0].sky.overcast: ", "from 0 to 1e9"),
        ("direction = [1.0, 0.0, 1.0]", "direction = [0.0, 0.0, 0.0]", "lights[1].key.direction: ", "not zero"),
        ("angular_radius = 5.0", "angular_radius = 0.0", "lights[1].key.angular_radius: ", "above 0 and at most 90"),
        ("angular_radius = 5.0", "angular_radius = 90.1", "lights[1].key.angular_radius: ", "above 0 and at most 90"),
        ("radiance = [10.0,", "radiance = [nan,", "lights[1].key.radiance: ", "from 0 to 1e9"),
        ("fov = 40.0", "fov = 180.0", "camera.fov: ", "between 0 and 180"),
        ("width = 24", "width = 0", "camera.width: ", "1..="),
        ("height = 16", "height = 1000000", "camera.height: ", "1..="),
        ("eye = [0.0, -8.0, 3.0]", "eye = [0.0, 0.0, 0.5]", "camera.target: ", "not zero"),
        ("eye = [0.0, -8.0, 3.0]", "eye = [0.0, 0.0, 9.5]", "camera.up: ", "not parallel"),
        (
            "target = [0.0, 0.0, 0.5]",
            "target = [0.0, -8.0, 9.5]\nup = [0.0, 1.0, 0.0]",
            "camera: ",
            "at least one object",
        ),
        ("purpose = \"A cube and a sphere over a ground\"", "purpose = \" \"", "purpose: ", "one line"),
        ("purpose = \"A cube and a sphere over a ground\"", "purpose = \"a\\nb\"", "purpose: ", "one line"),
        ("casts = false", "motion = [{ time = 1.0 }, { time = 1.0 }]", "objects[0].motion[1].time: ", "after"),
        ("purpose", "frames = { count = 0 }\npurpose", "frames.count: ", "1..="),
        ("purpose", "frames = { count = 1, fps = 0.0 }\npurpose", "frames.fps: ", "positive"),
    ];
    for (from, to, field, expected) in cases {
        check(&[(from, to)], field, expected);
    }
}

#[test]
fn fields_unknown_missing_or_of_the_wrong_type() {
    let cases = [
        ("casts = false", "shadows = false", "line 18: ", "unknown field `shadows`, expected one of"),
        ("purpose", "color = 1\npurpose", "line 2: ", "unknown field `color`"),
        ("fov = 40.0", "fov = 40.0\nlens = 2", "line 8: ", "unknown field `lens`"),
        ("radius = 1.0", "radius = 1.0, hue = 2", "", "unknown field `hue`"),
        ("angular_radius = 5.0", "angular_radius = 5.0, hue = 2", "line 35: ", "unknown field `hue`"),
        ("uniform", "checkered", "", "unknown field `checkered`"),
        ("key =", "torch =", "", "unknown field `torch`"),
        ("purpose = \"A cube and a sphere over a ground\"", "", "", "missing field `purpose`"),
        ("albedo = [0.9, 0.2, 0.2]", "", "objects[1].albedo", "three numbers in [0, 1]"),
        ("[receivers]\ncamera = {}", "", "", "missing field `receivers`"),
        ("camera = {}", "", "receivers: expected exactly one of camera, vertices, grid, points, heights, found []", ""),
        (
            "camera = {}",
            "camera = {}\nvertices = { object = \"cube\" }",
            "receivers: ",
            "expected exactly one of camera, vertices, grid, points, heights, found [\"camera\", \"vertices\"]",
        ),
        ("uniform = [1.0, 1.0, 1.0]", "", "lights[0].sky: ", "expected exactly one of uniform, overcast, found []"),
        ("key =", "sky = {}\nkey =", "lights[1]: ", "expected exactly one of environment, sky, key"),
        ("width = 24", "width = -24", "", "expected"),
        ("width = 24", "width = \"wide\"", "line 8: ", "expected"),
        ("eye = [0.0, -8.0, 3.0]", "eye = [0.0, -8.0]", "line 5: ", ""),
        ("fov = 40.0", "fov 40.0", "line 7: ", ""),
    ];
    for (from, to, place, expected) in cases {
        check(&[(from, to)], place, expected);
    }
    let folder = Folder::new();
    for end in [10, 200, SCENE.len() - 30] {
        complaint(&folder, &SCENE[..end], "scene.toml");
    }
    folder.write("scene.toml", b"purpose = \"\xff\"");
    let error = Scene::load(&folder.path("scene.toml")).unwrap_err().to_string();
    assert!(error.contains("byte 11: expected UTF-8"), "{error}");
}

#[test]
fn empty_scenes() {
    let head =
        "purpose = \"nothing\"\n[receivers.grid]\ncenter = [0.0, 0.0, 0.0]\nsize = [1.0, 1.0]\nresolution = [2, 2]\n";
    let object = "[[objects]]\nname = \"a\"\nplane = { size = [1.0, 1.0] }\nalbedo = [1.0, 1.0, 1.0]\n";
    let light = "[[lights]]\nsky = { uniform = [1.0, 1.0, 1.0] }\n";
    let folder = Folder::new();
    assert!(folder.load(&format!("{head}{object}{light}")).is_ok());
    let error = complaint(&folder, &format!("{head}{light}"), "scene.toml");
    assert!(error.contains("objects: expected at least one object"), "{error}");
    let error = complaint(&folder, &format!("{head}{object}"), "scene.toml");
    assert!(error.contains("lights: expected at least one light, or an object with emission"), "{error}");
    let lamp = object.replace("albedo", "emission = [2.0, 1.0, 0.0]\nalbedo");
    assert_eq!(folder.load(&format!("{head}{lamp}")).map(|scene| scene.facts().emitters).ok(), Some(1));
    let error = complaint(&folder, &format!("{head}{}", lamp.replace("2.0", "-2.0")), "scene.toml");
    assert!(error.contains("objects[0].emission"), "{error}");
    let error = complaint(&folder, "", "scene.toml");
    assert!(error.contains("missing field"), "{error}");
}

#[test]
fn receivers_that_cannot_be() {
    let camera = "[receivers]\ncamera = {}";
    let named = |layout: &str| format!("[receivers]\n{layout}");
    check(&[(camera, &named("vertices = { object = \"bunny\" }"))], "receivers.vertices.object: ", "\"cube\"");
    check(&[(camera, &named("vertices = { object = \"ball\" }"))], "receivers.vertices.object: ", "with a mesh");
    let grid = |change: (&str, &str)| {
        let grid =
            "grid = { center = [0.0, 0.0, 0.0], size = [1.0, 1.0], resolution = [2, 2], normal = [0.0, 0.0, 1.0] }";
        named(&grid.replace(change.0, change.1))
    };
    check(&[(camera, &grid(("resolution = [2, 2]", "resolution = [2, 0]")))], "receivers.grid.resolution: ", "1..=");
    check(&[(camera, &grid(("size = [1.0, 1.0]", "size = [1.0, -1.0]")))], "receivers.grid.size: ", "positive");
    check(&[(camera, &grid(("0.0, 1.0] }", "0.0, 0.0] }")))], "receivers.grid.normal: ", "not zero");
    check(&[(camera, &grid(("center = [0.0", "center = [nan")))], "receivers.grid.center: ", "finite");
    let at = SCENE.find("[camera]").unwrap()..SCENE.find("[receivers]").unwrap();
    let error = complaint(&Folder::new(), &SCENE.replace(&SCENE[at], ""), "scene.toml");
    assert!(error.contains("receivers.camera: expected a [camera] in the scene"), "{error}");
}

#[test]
fn point_lists() {
    let folder = Folder::new();
    let cases = [
        ("", "end of file: expected at least one line"),
        ("x,y,z,nx,ny,nz\n", "end of file: expected at least one line"),
        ("0,0,0,0,0,1\nx,y,z,nx,ny,nz\n", "line 2: expected six numbers"),
        ("0,0,0,0,0,1\n\n0,0,0,0,1\n", "line 3: expected six numbers"),
        ("0,0,0,0,0,1,2\n", "line 1: expected six numbers"),
        ("0,0,0,0,0,0\n", "line 1: expected a normal that is not zero"),
        ("0,0,0,nan,0,0\n", "line 1: expected finite numbers"),
        ("0,inf,0,0,0,1\n", "line 1: expected finite numbers"),
    ];
    for (text, expected) in cases {
        folder.write("p.csv", text);
        let error = read_points_csv(&folder.path("p.csv")).unwrap_err().to_string();
        assert!(error.contains(&format!("p.csv: {expected}")), "{error}");
        let scene = with(&[("[receivers]\ncamera = {}", "[receivers]\npoints = { file = \"p.csv\" }")]);
        assert!(complaint(&folder, &scene, "p.csv").contains(expected));
    }
    assert!(
        read_points_csv(&folder.path("q.csv")).unwrap_err().to_string().contains("q.csv: expected a readable file")
    );
}

#[test]
fn hashes() {
    let folder = Folder::new();
    let hash = halflight_scenes::Content::of(cube_ply().as_bytes()).to_string();
    let scene = |hash: &str| with(&[("\"cube.ply\"", &format!("\"cube.ply\", sha256 = \"{hash}\""))]);
    assert!(folder.load(&scene(&hash)).is_ok());
    assert!(folder.load(&scene(&hash.to_uppercase())).is_ok());
    let error = complaint(&folder, &scene("00ff"), "scene.toml");
    assert!(error.contains("objects[1].mesh.sha256: expected the hash of") && error.contains(&hash), "{error}");
    folder.write("cube.ply", cube_ply() + "\n");
    assert!(complaint(&folder, &scene(&hash), "scene.toml").contains("sha256"));
}

#[test]
fn missing_files() {
    let folder = Folder::new();
    let missing = Scene::load(&folder.path("missing.toml")).unwrap_err().to_string();
    assert!(missing.contains("missing.toml: expected a readable file"), "{missing}");
    let error = complaint(&folder, &with(&[("cube.ply", "gone.ply")]), "gone.ply");
    assert!(error.contains("expected a readable file"), "{error}");
    let error = complaint(
        &folder,
        &with(&[("sky = { uniform = [1.0, 1.0, 1.0] }", "environment = { file = \"gone.exr\" }")]),
        "gone.exr",
    );
    assert!(error.contains("expected a readable file"), "{error}");
    folder.write("cube.stl", "solid");
    let error = complaint(&folder, &with(&[("cube.ply", "cube.stl")]), "cube.stl");
    assert!(error.contains("extension: expected a mesh as .obj, .off or .ply, found \"stl\""), "{error}");
}

#[test]
fn meshes() {
    let folder = Folder::new();
    let ply = cube_ply();
    let cut = &ply[..ply.len() - 9];
    let change = |from: &str, to: &str| {
        assert!(ply.contains(from));
        ply.replacen(from, to, 1)
    };
    let cases = [
        ("a.ply", cut.to_owned(), "end of file: expected face 5 of 6: the file is truncated"),
        ("a.ply", ply[..60].to_owned(), "end of file: expected end_header"),
        ("a.ply", String::new(), "end of file: expected end_header"),
        ("a.ply", change("ply\n", "plx\n"), "line 1: expected ply"),
        ("a.ply", change("ascii", "utf8"), "line 2: expected format ascii"),
        ("a.ply", change("format ascii 1.0\n", ""), "header: expected format ascii"),
        ("a.ply", change("property float x\n", ""), "header: expected properties x, y and z"),
        ("a.ply", change("vertex_indices", "corners"), "header: expected a list property vertex_indices"),
        ("a.ply", change("property float x", "property single x"), "line 5: expected a number type"),
        ("a.ply", change("element vertex 8", "element vertex -8"), "line 4: expected a count"),
        ("a.ply", change("element face 6", "element face 5"), "end of file: expected no data beyond"),
        (
            "a.ply",
            change("element face 6", "element empty 5\nelement face 6"),
            "header: expected at least one property",
        ),
        ("a.ply", change("element vertex 8\nproperty", "property"), "line 4: expected an element before"),
        ("a.ply", change("-1 -1 -1", "nan -1 -1"), "vertex 0: expected three finite numbers"),
        ("a.ply", change("-1 -1 -1", "inf -1 -1"), "vertex 0: expected three finite numbers"),
        ("a.ply", change("-1 -1 -1", "x -1 -1"), "vertex 0 of 8: expected a number"),
        ("a.ply", change("4 0 2 3 1", "4 0 2 8 1"), "face 0 of 6: expected vertex indices below 8, found 8"),
        ("a.ply", change("4 0 2 3 1", "4 0 2 -1 1"), "face 0 of 6: expected vertex indices below 8, found -1"),
        ("a.ply", change("4 0 2 3 1", "2 0 2"), "face 0 of 6: expected at least three corners, found 2"),
        ("a.ply", change("4 0 2 3 1", "-4 0 2 3 1"), "face 0 of 6: expected a list length"),
        ("a.ply", change("4 0 2 3 1", "3 0 2 0"), "triangle 0: expected an area above 0"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n".into(), "end of file: expected vertex 2 of 3: the file is truncated"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n".into(), "end of file: expected face 0 of 1"),
        ("a.off", "OBJ\n3 1 0\n".into(), "line 1: expected OFF"),
        ("a.off", "OFF\n3 x 0\n".into(), "line 2: expected counts"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n".into(), "line 4: expected three numbers"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n".into(), "line 6: expected a count of at least 3"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n".into(), "triangle 0: expected vertex indices below 3"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n".into(), "line 7: expected the end"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n".into(), "triangle 0: expected an area above 0"),
        ("a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n".into(), "faces: expected at least one triangle"),
        ("a.off", "OFF\n3 1 0\n.1 .2 .3\n.2 .4 .6\n.3 .6 .9\n3 0 1 2\n".into(), "triangle 0: expected an area"),
        (
            "a.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n".into(),
            "line 4: expected indices within the 3 vertices above",
        ),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n".into(), "line 4: expected indices within"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n".into(), "line 4: expected indices within"),
        (
            "a.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n".into(),
            "line 4: expected indices within the 0 normals",
        ),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n".into(), "line 4: expected at least three corners"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n".into(), "line 4: expected corners as whole numbers"),
        ("a.obj", "v 0 0 0\nv 1 0\n".into(), "line 2: expected three numbers"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 inf\nf 1 2 3\n".into(), "vertex 2: expected three finite numbers"),
        (
            "a.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 inf\nf 1//1 2//1 3//1\n".into(),
            "normal 0: expected a finite direction",
        ),
        ("a.obj", "v 0 0 0\ncurv 0 1 2\n".into(), "line 2: expected v, vt, vn or f"),
        ("a.obj", String::new(), "faces: expected at least one triangle"),
    ];
    for (file, content, expected) in cases {
        folder.write(file, &content);
        let error = complaint(&folder, &with(&[("cube.ply", file)]), file);
        assert!(error.contains(&format!("{file}: {expected}")), "{error}\nfor {expected}");
    }
}

#[test]
fn pictures() {
    let folder = Folder::new();
    crate::lights::write_exr(&folder, "map.exr", |_, _| halflight_scenes::Rgb::ONE);
    crate::lights::write_hdr(&folder, "map.hdr");
    for (file, kind) in [("map.exr", "OpenEXR"), ("map.hdr", "Radiance HDR")] {
        let scene = with(&[("sky = { uniform = [1.0, 1.0, 1.0] }", &format!("environment = {{ file = {file:?} }}"))]);
        assert!(folder.load(&scene).is_ok());
        let bytes = std::fs::read(folder.path(file)).unwrap();
        for kept in [0, 3, bytes.len() / 2, bytes.len() - 1] {
            folder.write(file, &bytes[..kept]);
            assert!(complaint(&folder, &scene, file).contains(&format!("{file}: {kind}: ")), "{kept}");
        }
    }
}
