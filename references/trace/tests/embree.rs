//! Our hits on the shipped meshes against Embree's.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::Vec3;
use halflight_scenes::{Mesh, Shape, find};
use halflight_trace::{Geometry, Ray, World};

#[path = "trace/oracle.rs"]
#[expect(dead_code, reason = "shared with the other tests")]
mod oracle;
use oracle::Random;

const RAYS: usize = 1_000_000;
/// The first of them, which are aimed at nothing.
const UNAIMED: usize = RAYS / 2;

/// The Python that `HALFLIGHT_PYTHON` names, or `python3` if that has Embree.
fn python() -> Option<String> {
    if let Ok(named) = std::env::var("HALFLIGHT_PYTHON") {
        return Some(named);
    }
    let imports = Command::new("python3").args(["-c", "import embreex, numpy"]).output();
    imports.is_ok_and(|said| said.status.success()).then(|| "python3".to_owned())
}

/// A mesh of a shipped scene, and some triangles without area that nobody may hit.
fn mesh(scene: &str, object: &str) -> Mesh {
    let scene = find(scene).unwrap();
    let object = scene.objects.iter().find(|o| o.name == object).unwrap();
    let Shape::Mesh(mesh) = &*object.shape else { panic!("{} is a mesh", object.name) };
    let mut mesh = mesh.clone();
    let [a, b, c] = mesh.triangles[0];
    let middle = (mesh.positions[a as usize] + mesh.positions[b as usize]) / 2.0;
    mesh.positions.push(middle);
    let on_edge = mesh.positions.len() as u32 - 1;
    mesh.triangles.extend([[a, a, b], [c, c, c], [a, on_edge, a]]);
    mesh
}

/// Random, some along axes; then aimed exactly at vertices, at edges and along the surface.
fn rays(random: &mut Random, mesh: &Mesh) -> Vec<Ray> {
    let low = mesh.positions.iter().fold(Vec3::INFINITY, |low, p| low.min(*p));
    let high = mesh.positions.iter().fold(Vec3::NEG_INFINITY, |high, p| high.max(*p));
    let (center, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
    let mut ray = |i: usize| {
        let corners = mesh.triangles[(random.unit() * mesh.triangles.len() as f32) as usize];
        let [a, b, _] = corners.map(|i| mesh.positions[i as usize]);
        let origin = center + random.point() * 2.0 * radius;
        let axis = Vec3::AXES[i % 3] * if random.unit() < 0.5 { 1.0 } else { -1.0 };
        let (origin, direction) = match (i < UNAIMED, i % 4) {
            (true, 0) => (center + random.point() * radius - axis * 3.0 * radius, axis),
            (true, _) => (origin, center + random.point() * radius - origin),
            (false, 0) => (origin, a - origin),
            (false, 1) => (origin, a.lerp(b, random.unit()) - origin),
            (false, 2) => (a - axis * 3.0 * radius, axis),
            (false, _) => {
                let across = mesh.normals[corners[0] as usize].cross(random.direction()).normalize_or(axis);
                (a - across * 3.0 * radius, across)
            }
        };
        Ray { origin, direction: direction.normalize(), t_min: 0.0, t_max: f32::INFINITY }
    };
    (0..RAYS).map(&mut ray).collect()
}

fn write<const N: usize>(path: PathBuf, values: impl Iterator<Item = [u8; N]>) {
    fs::write(path, values.flatten().collect::<Vec<u8>>()).unwrap();
}

/// The mesh, its rays and what we find, as the script reads them.
fn exported(folder: &Path, mesh: &Mesh) {
    fs::create_dir(folder).unwrap();
    let rays = rays(&mut Random(mesh.triangles.len() as u64), mesh);
    let world = World::build(&[Geometry::Triangles { positions: &mesh.positions, triangles: &mesh.triangles }]);
    let (mut hits, mut blocked) = (vec![None; rays.len()], vec![false; rays.len()]);
    world.closest(&rays, &mut hits);
    world.occluded(&rays, &mut blocked);
    let floats = |p: &Vec3| p.to_array().map(f32::to_le_bytes);
    write(folder.join("vertices.f32"), mesh.positions.iter().flat_map(floats));
    write(folder.join("triangles.u32"), mesh.triangles.iter().flatten().map(|i| i.to_le_bytes()));
    write(folder.join("rays.f32"), rays.iter().flat_map(|ray| [ray.origin, ray.direction]).flat_map(|p| floats(&p)));
    write(folder.join("t.f32"), hits.iter().map(|hit| hit.map_or(f32::INFINITY, |hit| hit.t).to_le_bytes()));
    let primitive = |hit: &Option<halflight_trace::Hit>| hit.map_or(u32::MAX, |hit| hit.primitive).to_le_bytes();
    write(folder.join("primitive.u32"), hits.iter().map(primitive));
    write(folder.join("blocked.u8"), blocked.iter().map(|blocked| [u8::from(*blocked)]));
}

#[test]
fn embree_finds_the_same_hits_and_not_those_of_a_wrong_mesh() {
    let Some(python) = python() else {
        // Straight to the terminal: what print macros say is hidden when a test passes.
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED, not tested: embree_finds_the_same_hits_and_not_those_of_a_wrong_mesh needs python3 with embreex and numpy"
        );
        return;
    };
    let scratch = tempfile::tempdir().unwrap();
    let meshes = [
        ("teapot-sunset", "teapot"),
        ("bunny-studio", "bunny"),
        ("dino-elephant-courtyard", "dino"),
        ("dino-elephant-courtyard", "elephant"),
    ];
    let folders = meshes.map(|(_, object)| scratch.path().join(object));
    meshes.iter().zip(&folders).for_each(|((scene, object), folder)| exported(folder, &mesh(scene, object)));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/embree/compare.py");
    let compare = |arguments: &[&str], folders: &[PathBuf]| {
        let mut script = Command::new(&python);
        script.arg(&path).args(["--unaimed", &UNAIMED.to_string()]).args(arguments).args(folders);
        let said = script.output().unwrap();
        let told = [said.stdout, said.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        (said.status.code(), told)
    };
    let (status, told) = compare(&[], &folders);
    assert_eq!((status, told.matches("agree;").count()), (Some(0), folders.len()), "{told}");
    let (status, told) = compare(&["--wrong"], &folders[1..2]);
    assert_eq!((status, told.matches("DIFFER;").count()), (Some(1), 1), "{told}");
}
