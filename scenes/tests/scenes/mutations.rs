//! Files cut and changed at random: an error or a scene, never a panic, and what loads is finite.

use std::sync::LazyLock;

use halflight_scenes::{Rgb, Shape};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::folder::{Folder, SCENE, cube_ply, with};
use crate::lights::{write_exr, write_hdr};
use crate::models;

/// Bytes replaced at relative positions, and the fraction of the file that is kept.
type Damage = (Vec<(f64, u8)>, f64);

fn damage() -> impl Strategy<Value = Damage> {
    let kept = prop_oneof![3 => Just(1.0), 1 => 0.0..1.0];
    // Digits and signs keep text formats parsing further than arbitrary bytes do.
    let byte = prop_oneof![any::<u8>(), prop::sample::select(b"0123456789-.e \n/".to_vec())];
    (vec((0.0..1.0, byte), 0..6), kept)
}

fn apply(bytes: &[u8], (changes, kept): &Damage) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (position, byte) in changes {
        let index = (position * bytes.len() as f64) as usize;
        bytes[index] = *byte;
    }
    bytes.truncate((bytes.len() as f64 * kept) as usize);
    bytes
}

fn load(folder: &Folder, scene: &str) {
    match folder.load(scene) {
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        Ok(scene) if scene.frame_count == 1 => {
            let receivers = scene.frame(0).receivers;
            let finite = |values: &[glam::Vec3]| values.iter().all(|value| value.is_finite());
            assert!(finite(&receivers.position) && finite(&receivers.normal) && finite(&receivers.geometric_normal));
        }
        Ok(_) => {}
    }
}

fn check(file: &str, bytes: &[u8], scene: &str, damage: &Damage) {
    let folder = Folder::new();
    folder.write(file, apply(bytes, damage));
    load(&folder, scene);
}

/// What loads is finite in its pose too.
fn load_posed(folder: &Folder, scene: &str) {
    match folder.load(scene) {
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        Ok(scene) => {
            for posed in &scene.frame(scene.frame_count - 1).objects {
                let shape = posed.in_place();
                let Shape::Mesh(mesh) = &*shape else { panic!("a mesh") };
                assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
            }
        }
    }
}

const ARM: &str = "HIERARCHY\nROOT Upper arm\n{\nOFFSET 0 0 1\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
                   Yrotation\nJOINT Lower\n{\nOFFSET 1 0 0\nCHANNELS 1 Zrotation\nEnd Site\n{\nOFFSET 2 0 0\n}\n}\n}\nMOTION\n\
                   Frames: 2\nFrame Time: 0.5\n0 0 0 0 0 0 0\n1 2 3 90 90 0 90\n";

static MODEL: LazyLock<Vec<u8>> = LazyLock::new(models::model);

static PICTURES: LazyLock<[(&str, Vec<u8>); 2]> = LazyLock::new(|| {
    let exr = picture(|folder| write_exr(folder, "map", |x, y| Rgb::new(x as f32, y as f32, 1.0)));
    [("map.exr", exr), ("map.hdr", picture(|folder| write_hdr(folder, "map")))]
});

fn picture(write: impl Fn(&Folder)) -> Vec<u8> {
    let folder = Folder::new();
    write(&folder);
    std::fs::read(folder.path("map")).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn scenes(damage in damage()) {
        let text = apply(SCENE.as_bytes(), &damage);
        let folder = Folder::new();
        load(&folder, &String::from_utf8_lossy(&text));
    }

    #[test]
    fn ascii_ply(damage in damage()) {
        check("cube.ply", cube_ply().as_bytes(), SCENE, &damage);
    }

    #[test]
    fn binary_ply(damage in damage()) {
        let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
            property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n".to_vec();
        [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes.push(3);
        (0..3i32).for_each(|i| bytes.extend(i.to_le_bytes()));
        check("cube.ply", &bytes, SCENE, &damage);
    }

    #[test]
    fn off(damage in damage()) {
        let text = "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n4 0 1 2 3\n";
        check("cube.off", text.as_bytes(), &with(&[("cube.ply", "cube.off")]), &damage);
    }

    #[test]
    fn obj(damage in damage()) {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 1\nvn 0 0 1\nf 1 2 3\nf 1//1 2//1 -1//1\nf 1/1 2/1 3/1 4/1\n";
        check("cube.obj", text.as_bytes(), &with(&[("cube.ply", "cube.obj")]), &damage);
    }

    #[test]
    fn points(damage in damage()) {
        let text = "x,y,z,nx,ny,nz\n0,1,2,0,0,1\n3,4,5,1,0,0\n";
        let scene = with(&[("[receivers]\ncamera = {}", "[receivers]\npoints = { file = \"p.csv\" }")]);
        check("p.csv", text.as_bytes(), &scene, &damage);
    }

    #[test]
    fn models(damage in damage()) {
        let folder = Folder::new();
        folder.write("model.glb", apply(&MODEL, &damage));
        load_posed(&folder, &models::scene("clip = \"wave\""));
    }

    #[test]
    fn captures(damage in damage()) {
        let folder = Folder::new();
        folder.write("arm.bvh", apply(ARM.as_bytes(), &damage));
        let character = "albedo = [0.5, 0.5, 0.5]\ncharacter = { file = \"arm.bvh\", resolution = 16 }";
        load_posed(&folder, &models::scene("").replace("gltf = { file = \"model.glb\",  }", character));
    }

    #[test]
    fn pictures(damage in damage()) {
        for (file, bytes) in PICTURES.iter() {
            let light = format!("environment = {{ file = {file:?} }}");
            check(file, bytes, &with(&[("sky = { uniform = [1.0, 1.0, 1.0] }", &light)]), &damage);
        }
    }
}
